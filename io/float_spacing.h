// Checks whether float32 coordinates are fine enough for a scene at its position.
#pragma once

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Warns if neighbouring float32 numbers at the coordinates of `box`, the scene's bounds in world
/// space, are farther apart than a thousandth of the box's longest side. Shapes and images are
/// coarse then.
void warn_of_spacing(const Box& box, SceneDescription* scene);

}  // namespace raysheaf::io
