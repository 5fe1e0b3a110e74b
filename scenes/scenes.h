// The built-in scenes, each in separate files.
#pragma once

#include "raysheaf/scene_description.h"

namespace raysheaf::builtin {

/// A furnished office, in metres: instances, textures, mirrors and glass. 40 000 to 60 000
/// triangles.
[[nodiscard]] SceneDescription office();

/// A sphere in a box of six mirrors: 792 triangles in 7 meshes.
[[nodiscard]] SceneDescription cornell();

/// A courtyard with two storeys of arcades, in metres, as one mesh of 66 000 to 90 000 triangles.
[[nodiscard]] SceneDescription atrium();

}  // namespace raysheaf::builtin
