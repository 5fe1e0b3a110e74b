// The room around a scene with `studio_lights` (raysheaf/studio.h), which mirrors, metals and glass
// show: grey walls, and a soft box where each of the lights comes from. It lights no matte surface:
// the lights do, without noise.
#pragma once

#include "base/vec.h"
#include "base/view.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// A rectangle of light around a direction, far away.
struct SoftBox {
  Vec3 axis{0, 0, 1}, side{1, 0, 0}, top{0, 1, 0};  ///< unit: to its centre, along its sides
  float wide = 1, high = 1;                         ///< half its sides, at distance 1
  float radiance = 0;
};

inline constexpr int kSoftBoxes = 3;

struct StudioRoom {
  SoftBox boxes[kSoftBoxes];
  Vec3 up{0, 1, 0}, back{0, 0, 1};  ///< of the camera for which the lights were placed
  float white = 0;  ///< radiance of white that faces the key light; 0: there is no room
};

/// The room of `studio_lights`; none for other lights.
[[nodiscard]] StudioRoom studio_room(View<const Light> lights);

/// From 0 at -1 to 1 at 1, and constant beyond.
RAYSHEAF_HD inline float smooth_step(float x) {
  const float t = clamp(0.5f + 0.5f * x, 0, 1);
  return t * t * (3 - 2 * t);
}

/// The interval from -half to half, blurred: its integral over x is 2 half for every blur.
RAYSHEAF_HD inline float blurred_interval(float x, float half, float blur) {
  return smooth_step((x + half) / blur) - smooth_step((x - half) / blur);
}

/// The walls, relative to `StudioRoom::white`, towards a unit direction with these components.
RAYSHEAF_HD inline float wall_brightness(float up, float back) {
  constexpr float kFloor = 0.2f, kLevel = 0.4f, kCeiling = 0.6f, kAhead = 0.8f;
  const float shade = up < 0 ? kLevel + (kFloor - kLevel) * smooth_step(-4 * up - 1)
                             : kLevel + (kCeiling - kLevel) * smooth_step(2 * up - 1);
  // The backdrop in front of the camera: 1 within 40 degrees of the axis, 0 beyond 75 degrees.
  const float ahead = smooth_step((-back - 0.51f) / 0.25f);
  return shade + (kAhead - shade) * ahead;
}

/// The radiance that a surface of this roughness reflects from around a unit direction. 0 is a
/// mirror; rougher surfaces blur the soft boxes and show less of them, because they have the
/// highlights of the lights as well.
RAYSHEAF_HD inline Vec3 studio_radiance(const StudioRoom& room, Vec3 direction, float roughness) {
  constexpr float kSharpest = 0.06f;
  const float blur = kSharpest + 2 * roughness * roughness;
  float sum = wall_brightness(dot(direction, room.up), dot(direction, room.back));
  for (const SoftBox& box : room.boxes) {
    const float depth = dot(direction, box.axis);
    if (!(depth > 0)) continue;
    const float x = dot(direction, box.side) / depth, y = dot(direction, box.top) / depth;
    sum += box.radiance * (1 - roughness) * blurred_interval(x, box.wide, blur) *
           blurred_interval(y, box.high, blur);
  }
  const float radiance = sum * room.white;
  return {radiance, radiance, radiance};
}

}  // namespace raysheaf
