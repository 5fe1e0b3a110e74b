// `raysheaf view`: the one door of this room.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "raysheaf/animation.h"

namespace raysheaf::viewer {

struct ViewOptions {
  std::string scene;       ///< what `load` takes
  std::string script;      ///< a file; empty: hands
  std::string screenshot;  ///< of the window at the end, or once the picture is refined
  std::string settings;    ///< a file; empty: the user's own, and none where a script plays
  std::uint32_t width = 0, height = 0;  ///< of the window; 0: as it was
  std::uint32_t threads = 0;
  std::function<std::unique_ptr<Animation>(const std::string&)> load;
  std::function<void(const std::string&)> print;  ///< to standard output
  std::function<void(const std::string&)> tell;   ///< a line to standard error
};

/// Opens a window and stays until it is closed or the script ends. Throws `Error`: kNoGraphics
/// without a display or OpenGL 3.3, what `load` throws for the first scene, kInvalidData for a
/// script's lines, kInternal for what OpenGL dislikes while a script plays.
void view(const ViewOptions& options);

}  // namespace raysheaf::viewer
