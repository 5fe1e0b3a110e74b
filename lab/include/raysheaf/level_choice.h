// Whether rays enter instances where they stand (docs/levels.md), for measurements and checks.
#pragma once

#include <optional>

#include "raysheaf/scene.h"

namespace raysheaf {

/// From now on rays of the CPU enter the scene's instances, wherever they can, or instances are
/// always placed first; without a value the plan decides again. Answers are the same. A copy of the
/// scene decides for itself.
void choose_levels(const Scene& scene, std::optional<bool> enter);

}  // namespace raysheaf
