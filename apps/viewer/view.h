// `raysheaf view`: the only entry point of this folder.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "raysheaf/animation.h"
#include "raysheaf/cameras.h"

namespace raysheaf::viewer {

struct ViewOptions {
  std::string scene;       ///< the argument of `load`; empty: the window waits for a file
  std::string script;      ///< a file; empty: interactive
  std::string screenshot;  ///< of the window at the end, or when the image is refined
  std::string settings;    ///< a file; empty: the user's own, or none while a script plays
  std::uint32_t width = 0, height = 0;  ///< of the window; 0: that of the last time
  std::uint32_t threads = 0;
  std::optional<ViewSide> view;  ///< of `scene`
  std::optional<UpAxis> up;      ///< none: that of the settings
  bool orthographic = false;     ///< begin so with `scene`
  std::function<std::unique_ptr<Animation>(const std::string&)> load;
  std::function<void(const std::string&)> print;  ///< to standard output
  std::function<void(const std::string&)> tell;   ///< a line to standard error
};

/// Opens a window and returns when it is closed or the script ends. Throws `Error`: kNoGraphics
/// without a display or OpenGL 3.3, the errors of `load` for the first scene, kInvalidData for
/// lines of the script, kInternal for errors of OpenGL while a script plays.
void view(const ViewOptions& options);

}  // namespace raysheaf::viewer
