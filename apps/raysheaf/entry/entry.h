// `raysheaf view` is a separate program, raysheaf-view, in the folder of raysheaf, because only the
// viewer needs a window system. Both programs consist of main.cpp, the function declared here, and
// `run(const ViewCommand&)`.
#pragma once

#include <vector>

namespace raysheaf::app {

/// The command line to parse, as if raysheaf had been called. Call it first: in raysheaf, if the
/// arguments request the viewer and raysheaf-view exists, that program replaces this process.
[[nodiscard]] std::vector<const char*> command_line(int argc, const char* const* argv);

}  // namespace raysheaf::app
