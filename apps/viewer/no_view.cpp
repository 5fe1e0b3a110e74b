// In place of the window, where GLFW or Dear ImGui was not there to build it with.
#include "raysheaf/error.h"
#include "view.h"

namespace raysheaf::viewer {

bool has_view() {
  return false;
}

void view(const ViewOptions& /*options*/) {
  throw Error(ErrorCode::kUnsupported,
              "this build has no viewer: GLFW or Dear ImGui was not there when it was made");
}

}  // namespace raysheaf::viewer
