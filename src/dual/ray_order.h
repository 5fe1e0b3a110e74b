// The order in which `dual` takes the rays of a batch: by the face of the cube that they run
// towards, then along a Morton curve through the five dimensions of rays, origin and slopes.
//
// Rays of one face share the axis along which the ray-triangle test shears them, so a packet of
// them needs no exchange of axes lane by lane.
#pragma once

#include <array>
#include <cstdint>

#include "base/buffer.h"
#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/types.h"

namespace raysheaf {

inline constexpr std::uint32_t kFaces = 6;

/// 2 * axis, plus one where the ray runs against it; the axis is that of `make_ray_setup`.
[[nodiscard]] inline std::uint32_t face_of(Vec3 d) {
  const float x = d.x < 0 ? -d.x : d.x, y = d.y < 0 ? -d.y : d.y, z = d.z < 0 ? -d.z : d.z;
  if (x > y && x > z) return d.x < 0 ? 1 : 0;
  if (!(x > y) && y > z) return d.y < 0 ? 3 : 2;
  return d.z < 0 ? 5 : 4;
}

struct RayOrder {
  Buffer<std::uint32_t> rays;  ///< the caller's numbers, in the new order
  std::array<std::uint32_t, kFaces + 1> face_starts{};
  Buffer<std::uint64_t> keys, spare;  ///< scratch
};

enum class Sorting : std::uint8_t {
  kByFace,  ///< the caller's order within each face
  kCurve,
};

/// O(rays log rays), and O(rays) for kByFace. Ties keep the caller's order. At most 2^31 rays.
void order_rays(const Executor& executor, View<const Ray> rays, Sorting sorting, RayOrder* order);

}  // namespace raysheaf
