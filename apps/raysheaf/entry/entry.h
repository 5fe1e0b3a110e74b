// `raysheaf view` is a program of its own, raysheaf-view, which lies beside raysheaf: it alone
// needs a window system. Both are main.cpp with what is declared here, and `run(const
// ViewCommand&)`.
#pragma once

#include <vector>

namespace raysheaf::app {

/// What is to be parsed, as if raysheaf had been called; to be called first. In raysheaf, where the
/// arguments ask for the viewer, raysheaf-view takes the place of this process, if it is there.
[[nodiscard]] std::vector<const char*> command_line(int argc, const char* const* argv);

}  // namespace raysheaf::app
