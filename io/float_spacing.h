// Whether float32 coordinates resolve a scene where it lies.
#pragma once

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Warns where the spacing of float32 numbers at the coordinates of `box`, the scene's in the
/// world, is more than a thousandth of the box's longest side: shapes and pictures are rough then.
void warn_of_spacing(const Box& box, SceneDescription* scene);

}  // namespace raysheaf::io
