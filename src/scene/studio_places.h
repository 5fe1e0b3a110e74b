// Where `studio_lights` (raysheaf/studio.h) come from, in the camera's axes: right, up, back.
#pragma once

#include "raysheaf/types.h"

namespace raysheaf {

inline constexpr Vec3 kKeyPlace{-0.6f, 0.8f, 0.8f};
inline constexpr Vec3 kFillPlace{0.9f, 0.1f, 0.7f};
inline constexpr Vec3 kRimPlace{0.4f, 0.7f, -0.8f};

}  // namespace raysheaf
