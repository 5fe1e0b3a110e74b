#include "scene/builtin/scenes.h"
namespace raysheaf::builtin {
SceneDescription atrium() {
  return {};
}
}  // namespace raysheaf::builtin
