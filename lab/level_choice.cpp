#include "raysheaf/level_choice.h"

#include "api/scene/scene_impl.h"

namespace raysheaf {

void choose_levels(const Scene& scene, std::optional<bool> enter) {
  SceneAccess::state(scene).levels.choose(enter);
}

}  // namespace raysheaf
