// Implements the public queries of points.
#include "raysheaf/points.h"

#include <algorithm>
#include <limits>

#include "api/query_call.h"

namespace raysheaf {
namespace {

QueryOptions query_options(const PointOptions& options) {
  QueryOptions same;
  same.method = options.method;
  same.mask = options.mask;
  same.check = options.check;
  same.stream = options.stream;
  same.results_stream = options.results_stream;
  same.stop = options.stop;
  same.statistics = options.statistics;
  same.ray_worlds = options.point_worlds;
  same.rays_per_world = options.points_per_world;
  return same;
}

/// Points and radii are read by the same machine; one radius for all may be in the host's memory.
void check_radii(const DeviceBackend* backend, const PointParts& parts) {
  if (backend == nullptr || parts.count == 0 || parts.radii.data == nullptr) return;
  const bool points_there = backend->is_device_memory(parts.points.data, "points");
  const bool radii_there = backend->is_device_memory(parts.radii.data, "radii");
  if (points_there == radii_there || (points_there && parts.radii.row_stride == 0)) return;
  throw Error(ErrorCode::kUnsupported,
              points_there ? "they are in the host's memory, but the points in the device's: put "
                             "both there, or give one radius for all, with a row stride of 0"
                           : "they are in the device's memory, but the points in the host's: put "
                             "both into one",
              "radii");
}

/// As `run_query`.
template <class T, class Ask>
void run_point_query(const Scene& scene, const PointParts& parts, const PointOptions& options,
                     const Answers<T>& answers, const Ask& ask) {
  const QueryPoints points(parts, options.check);
  check_radii(ContextAccess::backend(SceneAccess::state(scene).context), parts);
  run_query(scene, points, query_options(options), answers, ask);
}

}  // namespace

void closest_point(const Scene& scene, const PointParts& points, std::span<ClosestPoint> found,
                   const PointOptions& options) {
  nearest(scene, points, 1, found, options);
}
std::vector<ClosestPoint> closest_point(const Scene& scene, const PointParts& points,
                                        const PointOptions& options) {
  return nearest(scene, points, 1, options);
}

void nearest(const Scene& scene, const PointParts& points, std::size_t k,
             std::span<ClosestPoint> found, const PointOptions& options) {
  if (k == 0 || k > kMostNearest)
    throw Error(
        ErrorCode::kInvalidArgument,
        "k is " + std::to_string(k) + "; 1 to " + std::to_string(kMostNearest) + " is expected",
        "k");
  run_point_query(scene, points, options, Answers<ClosestPoint>{found, "found", {}, k},
                  &SceneQueries::nearest);
}
std::vector<ClosestPoint> nearest(const Scene& scene, const PointParts& points, std::size_t k,
                                  const PointOptions& options) {
  return make_answers<ClosestPoint>(
      points.count * std::min(k, kMostNearest), "points",
      [&](std::span<ClosestPoint> found) { nearest(scene, points, k, found, options); });
}

void signed_distance(const Scene& scene, const PointParts& points, std::span<double> distances,
                     const PointOptions& options) {
  run_point_query(
      scene, points, options,
      Answers<double>{distances, "distances", std::numeric_limits<double>::infinity()},
      [&](const SceneQueries& by, QueryCall& call, const QueryPoints& all, std::span<double> out) {
        by.signed_distance(call, all, options.inside, out);
      });
}
std::vector<double> signed_distance(const Scene& scene, const PointParts& points,
                                    const PointOptions& options) {
  return make_answers<double>(points.count, "points", [&](std::span<double> distances) {
    signed_distance(scene, points, distances, options);
  });
}

void contains(const Scene& scene, const PointParts& points, std::span<std::uint8_t> inside,
              const PointOptions& options) {
  run_point_query(
      scene, points, options, Answers<std::uint8_t>{inside, "inside"},
      [&](const SceneQueries& by, QueryCall& call, const QueryPoints& all,
          std::span<std::uint8_t> out) { by.contains(call, all, options.inside, out); });
}
std::vector<std::uint8_t> contains(const Scene& scene, const PointParts& points,
                                   const PointOptions& options) {
  return make_answers<std::uint8_t>(points.count, "points", [&](std::span<std::uint8_t> inside) {
    contains(scene, points, inside, options);
  });
}

}  // namespace raysheaf
