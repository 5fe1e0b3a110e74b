#include "render/surface/studio_room.h"

#include <cmath>
#include <numbers>

#include "scene/studio_places.h"

namespace raysheaf {

StudioRoom studio_room(View<const Light> lights) {
  StudioRoom room;
  if (lights.size != kSoftBoxes) return room;
  for (const Light& light : lights)
    if (light.type != Light::Type::kDirectional) return room;
  // The lights come from fixed places before the camera, which therefore follow from the lights:
  // the camera's axis j is the sum of the lights' directions, each times row j of the inverse of
  // the matrix of places.
  const Vec3 key = normalized(kKeyPlace), fill = normalized(kFillPlace),
             rim = normalized(kRimPlace);
  const Vec3 rows[kSoftBoxes] = {cross(fill, rim), cross(rim, key), cross(key, fill)};
  const float volume = dot(key, rows[0]);
  const auto axis = [&](int j, Vec3 otherwise) {
    Vec3 sum{0, 0, 0};
    for (int i = 0; i < kSoftBoxes; ++i)
      sum += lights[i].direction * (-component(rows[i], j) / volume);
    return normalized(sum, otherwise);
  };
  const Vec3 right = axis(0, {1, 0, 0});
  room.up = axis(1, {0, 1, 0});
  room.back = axis(2, {0, 0, 1});
  // Half sides at distance 1. A box gives about the irradiance of its light.
  constexpr Vec2 kSides[kSoftBoxes] = {{0.55f, 0.4f}, {0.22f, 0.8f}, {0.7f, 0.3f}};
  constexpr float kRadiance[kSoftBoxes] = {4, 2, 3.5f};
  for (int i = 0; i < kSoftBoxes; ++i) {
    SoftBox& box = room.boxes[i];
    box.axis = -lights[i].direction;
    box.side = normalized(cross(room.up, box.axis), right);
    box.top = cross(box.axis, box.side);
    box.wide = kSides[i].x;
    box.high = kSides[i].y;
    box.radiance = kRadiance[i];
  }
  room.white = luminance(lights[0].intensity) / std::numbers::pi_v<float>;
  return room;
}

}  // namespace raysheaf
