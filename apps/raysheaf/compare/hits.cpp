#include <algorithm>
#include <cmath>

#include "compare/case.h"

namespace raysheaf::app {
namespace {

bool found(const Hit& hit) {
  return hit.prim_id != kInvalidId;
}

/// Both sides compute t in float, from coordinates that dwarf a near hit's distance.
bool close(const Ray& ray, float a, float b, float slack) {
  const float length = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
  return std::fabs(a - b) <= 1e-4f * std::min(a, b) + slack / length;
}

}  // namespace

HitCheck compare_hits(std::span<const Ray> rays, std::span<const Hit> ours,
                      std::span<const Hit> theirs, float slack) {
  HitCheck check;
  check.compared = rays.size();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!found(ours[i]) && !found(theirs[i])) continue;
    if (found(ours[i]) != found(theirs[i]) || !close(rays[i], ours[i].t, theirs[i].t, slack)) {
      ++check.mismatches;
    } else if (ours[i].prim_id != theirs[i].prim_id || ours[i].geom_id != theirs[i].geom_id) {
      ++check.other_triangles;
    }
  }
  return check;
}

HitCheck compare_flags(std::span<const std::uint8_t> ours, std::span<const std::uint8_t> theirs) {
  HitCheck check;
  check.compared = ours.size();
  for (std::size_t i = 0; i < ours.size(); ++i) check.mismatches += ours[i] != theirs[i] ? 1 : 0;
  return check;
}

}  // namespace raysheaf::app
