#include "raysheaf/hit_points.h"

#include <algorithm>
#include <atomic>
#include <string>

#include "api/query_check.h"
#include "api/query_filter.h"
#include "api/scene/scene_impl.h"
#include "geom/surface_body.h"
#include "intersect/side_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kHitGrain = 4096;

/// An instance, which many hits share.
struct PlacedMesh {
  InstanceId id = kInvalidId;
  float time = 0;
  InstanceCorners corners;
  const Triangle* triangles = nullptr;

  void find(const SceneAccess::State& state, InstanceId instance, float at_time) {
    const std::uint32_t number = state.placements.at(instance).run;
    id = instance;
    time = at_time;
    corners = {};
    if (number == Placement::kNoRun) return;
    const PlacedInstance& placed = state.runs.placed.instances()[number];
    corners = InstanceCorners(placed, time);
    triangles = placed.triangles;
  }
  [[nodiscard]] Triangle vertices_of(std::uint32_t prim) const {
    return triangles != nullptr ? triangles[prim] : Triangle{3 * prim, 3 * prim + 1, 3 * prim + 2};
  }
};

[[nodiscard]] HitPoint point_of(const PlacedMesh& mesh, const Hit& hit, Vec3 direction) {
  HitPoint point;
  point.vertices = mesh.vertices_of(hit.prim_id);
  const auto [a, b, c] = mesh.corners(hit.prim_id);
  const Vec3 corner[3] = {a, b, c};
  const MixedPoint mixed = mixed_point(corner[0], corner[1], corner[2], hit.u, hit.v);
  point.position = mixed.position;
  point.normal = front_normal(corner, mesh.corners.mirrored());
  point.clearance = clearance(mixed, point.normal);
  point.front =
      comes_from_front(direction, corner[0], corner[1], corner[2]) != mesh.corners.mirrored();
  return point;
}

[[nodiscard]] Vec3 facing_normal_of(const PlacedMesh& mesh, const Hit& hit, Vec3 direction) {
  const auto [a, b, c] = mesh.corners(hit.prim_id);
  const Vec3 normal = front_normal({a, b, c}, false);
  return comes_from_front(direction, a, b, c) ? normal : -normal;
}

/// Sets each of `found` to `of(mesh, hit, i)`, or to `nothing` for a miss. False where a hit names
/// what is not there.
template <class Found, class Of>
bool fill(const SceneAccess::State& state, std::span<const Hit> hits, const Of& of,
          const Found& nothing, std::span<Found> found, std::span<const float> times) {
  std::atomic<bool> good{true};
  state.executor().for_each_block(hits.size(), kHitGrain, [&](std::size_t begin, std::size_t end) {
    PlacedMesh mesh;
    for (std::size_t i = begin; i < end; ++i) {
      const Hit& hit = hits[i];
      if (hit.prim_id == kInvalidId) {
        found[i] = nothing;
        continue;
      }
      const float time = times.empty() ? 0 : times[i];
      if ((hit.inst_id != mesh.id || time != mesh.time) && state.placements.contains(hit.inst_id))
        mesh.find(state, hit.inst_id, time);
      if (hit.inst_id != mesh.id || hit.prim_id >= mesh.corners.count())
        good.store(false, std::memory_order_relaxed);
      else
        found[i] = of(mesh, hit, i);
    }
  });
  return good;
}

[[noreturn]] void throw_first_unknown(const SceneAccess::State& state, std::span<const Hit> hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].prim_id == kInvalidId) continue;
    const auto found = state.placements.find(hits[i].inst_id);
    if (found != state.placements.end() &&
        hits[i].prim_id < found->second.mesh->arrays.triangle_count())
      continue;
    throw Error(ErrorCode::kNotFound,
                "the scene has no triangle " + std::to_string(hits[i].prim_id) + " of instance " +
                    std::to_string(hits[i].inst_id),
                "hits[" + std::to_string(i) + "]");
  }
  throw Error(ErrorCode::kInvalidData, "the hits changed while they were read", "hits");
}

void check_lengths(std::size_t hits, std::size_t others, const char* name) {
  if (hits != others)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(others) + " " + name + " for " + std::to_string(hits) + " hits",
                name);
}

template <class Found, class Of>
void find(const Scene& scene, std::span<const Hit> hits, const Of& of, const Found& nothing,
          std::span<Found> found, const char* name, std::span<const float> times) {
  check_lengths(hits.size(), found.size(), name);
  if (!times.empty()) check_lengths(hits.size(), times.size(), "times");
  check_times(times, "times");
  const SceneAccess::State& state = SceneAccess::state(scene);
  const SceneGate::Reading reading(SceneAccess::state(scene).gate);
  state.require_committed();
  if (!fill(state, hits, of, nothing, found, times)) throw_first_unknown(state, hits);
}

template <class Number>
Vec3 row_of(const NumberRows& rows, std::size_t i) {
  const auto* const row =
      static_cast<const Number*>(rows.data) + static_cast<std::ptrdiff_t>(i) * rows.row_stride;
  const auto at = [&](std::ptrdiff_t k) { return static_cast<float>(row[k * rows.column_stride]); };
  return {at(0), at(1), at(2)};
}
Vec3 direction_of(const NumberRows& rows, std::size_t i) {
  return rows.is_double ? row_of<double>(rows, i) : row_of<float>(rows, i);
}

void check_rows(const NumberRows& directions, std::span<const Hit> hits) {
  if (directions.data == nullptr && !hits.empty())
    throw Error(ErrorCode::kInvalidArgument, "there are none", "directions");
}

}  // namespace

void hit_points(const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits,
                std::span<HitPoint> points, std::span<const float> times) {
  check_lengths(hits.size(), rays.size(), "rays");
  const auto of = [&](const PlacedMesh& mesh, const Hit& hit, std::size_t i) {
    return point_of(mesh, hit, rays[i].direction);
  };
  find(scene, hits, of, HitPoint(), points, "points", times);
}

void hit_points(const Scene& scene, const NumberRows& directions, std::span<const Hit> hits,
                std::span<HitPoint> points, std::span<const float> times) {
  check_rows(directions, hits);
  const auto of = [&](const PlacedMesh& mesh, const Hit& hit, std::size_t i) {
    return point_of(mesh, hit, direction_of(directions, i));
  };
  find(scene, hits, of, HitPoint(), points, "points", times);
}

void facing_normals(const Scene& scene, const NumberRows& directions, std::span<const Hit> hits,
                    std::span<Vec3> normals, std::span<const float> times) {
  check_rows(directions, hits);
  const auto of = [&](const PlacedMesh& mesh, const Hit& hit, std::size_t i) {
    return facing_normal_of(mesh, hit, direction_of(directions, i));
  };
  find(scene, hits, of, HitPoint().normal, normals, "normals", times);
}

std::vector<HitPoint> hit_points(const Scene& scene, std::span<const Ray> rays,
                                 std::span<const Hit> hits, std::span<const float> times) {
  return answered([&] {
    std::vector<HitPoint> points(hits.size());
    hit_points(scene, rays, hits, points, times);
    return points;
  });
}

Vec3 off_surface(const HitPoint& point, Vec3 direction) {
  const float step = dot(direction, point.normal) < 0 ? -point.clearance : point.clearance;
  return point.position + point.normal * step;
}

}  // namespace raysheaf
