#include <algorithm>
#include <cmath>
#include <limits>

#include "lab/commands/compare/case.h"
#include "raysheaf/exact.h"

namespace raysheaf::app {
namespace {

constexpr std::size_t kMostDiffering = 128;
constexpr std::size_t kMostSettled = 20'000'000;  // ray-triangle tests, which take seconds

bool found(const Hit& hit) {
  return hit.prim_id != kInvalidId;
}

/// Both sides compute t in float, from coordinates that are far larger than the distance of a near
/// hit.
bool close(const Ray& ray, float a, float b, float slack) {
  const float length = std::hypot(ray.direction.x, ray.direction.y, ray.direction.z);
  return std::fabs(a - b) <= 1e-4f * std::min(a, b) + slack / length;
}

void add_mismatch(std::size_t i, HitCheck* check) {
  ++check->mismatches;
  if (check->differing.size() < kMostDiffering) check->differing.push_back(i);
}

/// The distance of the closest hit by exact arithmetic; infinity without a hit.
double exact_distance(std::span<const MeshView> meshes, const Ray& ray) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const MeshView& mesh : meshes) {
    for (const auto& corners : mesh.triangles) {
      const ExactAnswer answer = exact_answer(
          ray, mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]);
      if (answer.meets && answer.t >= ray.t_min && answer.t <= ray.t_max)
        nearest = std::min(nearest, answer.t);
    }
  }
  return nearest;
}

/// `right(answers, i, distance)` returns whether a side is right about ray i.
template <class Answers, class Right>
void settle(std::span<const MeshView> meshes, std::span<const Ray> rays, Answers ours,
            Answers theirs, const Right& right, HitCheck* check) {
  std::size_t triangles = 1;
  for (const MeshView& mesh : meshes) triangles += mesh.triangles.size();
  const std::size_t most = std::max<std::size_t>(1, kMostSettled / triangles);
  for (const std::size_t i : check->differing) {
    if (check->settled == most) break;
    const double distance = exact_distance(meshes, rays[i]);
    ++check->settled;
    check->ours_right += right(ours, i, distance) ? 1 : 0;
    check->peer_right += right(theirs, i, distance) ? 1 : 0;
  }
}

}  // namespace

HitCheck compare_hits(std::span<const Ray> rays, std::span<const Hit> ours,
                      std::span<const Hit> theirs, float slack) {
  HitCheck check;
  check.compared = rays.size();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!found(ours[i]) && !found(theirs[i])) continue;
    if (found(ours[i]) != found(theirs[i]) || !close(rays[i], ours[i].t, theirs[i].t, slack)) {
      add_mismatch(i, &check);
    } else if (ours[i].prim_id != theirs[i].prim_id || ours[i].geom_id != theirs[i].geom_id) {
      ++check.other_triangles;
    }
  }
  return check;
}

HitCheck compare_flags(std::span<const std::uint8_t> ours, std::span<const std::uint8_t> theirs) {
  HitCheck check;
  check.compared = ours.size();
  for (std::size_t i = 0; i < ours.size(); ++i)
    if (ours[i] != theirs[i]) add_mismatch(i, &check);
  return check;
}

void settle_hits(std::span<const MeshView> meshes, std::span<const Ray> rays,
                 std::span<const Hit> ours, std::span<const Hit> theirs, float slack,
                 HitCheck* check) {
  const auto right = [&](std::span<const Hit> hits, std::size_t i, double distance) {
    if (found(hits[i]) != std::isfinite(distance)) return false;
    return !found(hits[i]) || close(rays[i], hits[i].t, static_cast<float>(distance), slack);
  };
  settle(meshes, rays, ours, theirs, right, check);
}

void settle_flags(std::span<const MeshView> meshes, std::span<const Ray> rays,
                  std::span<const std::uint8_t> ours, std::span<const std::uint8_t> theirs,
                  HitCheck* check) {
  const auto right = [](std::span<const std::uint8_t> flags, std::size_t i, double distance) {
    return (flags[i] != 0) == std::isfinite(distance);
  };
  settle(meshes, rays, ours, theirs, right, check);
}

}  // namespace raysheaf::app
