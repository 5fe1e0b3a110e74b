// In place of the window, where the build left it out.
#include "raysheaf/error.h"
#include "view.h"

namespace raysheaf::viewer {

bool has_view() {
  return false;
}

void view(const ViewOptions& /*options*/) {
  throw Error(ErrorCode::kUnsupported,
              "this build has no viewer: it was switched off, or GLFW or Dear ImGui was missing, "
              "when it was made");
}

}  // namespace raysheaf::viewer
