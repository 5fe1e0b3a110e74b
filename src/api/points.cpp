// The front door of point queries: the view that the mask shows, its tree, names for what is found.
#include "raysheaf/points.h"

#include <algorithm>
#include <cmath>

#include "api/points_brute.h"
#include "api/query_check.h"
#include "api/query_points.h"
#include "api/scene/scene_impl.h"
#include "exec/stopwatch.h"
#include "nearest/closest_body.h"
#include "nearest/point_rows_body.h"
#include "queries/tree_queries.h"

namespace raysheaf {
namespace {

/// One call: holds the scene as it is.
class PointQuery {
 public:
  PointQuery(const Scene& scene, const QueryPoints& points, const PointOptions& options)
      : state_(SceneAccess::state(scene)),
        reading_(state_.gate),
        points_(points),
        options_(options),
        executor_(options.stop != nullptr ? state_.executor().alone().until(*options.stop)
                                          : state_.executor().alone()) {
    state_.require_committed();
    executor_.check();
    if (points.size() != 0) view_ = state_.views.view_for(state_.runs, options.mask);
    if (view_ == nullptr) return;
    lock_ = std::unique_lock(view_->mutex);
    view_->refresh(state_.runs);
    // Brute force only reads the triangles, which do not change during `reading_`.
    if (is_brute() && !is_on_device()) lock_.unlock();
  }

  [[nodiscard]] const Executor& executor() const { return executor_; }
  [[nodiscard]] const QueryPoints& points() const { return points_; }
  /// Whether there are no points, or no triangles that they see.
  [[nodiscard]] bool is_empty() const { return view_ == nullptr; }
  [[nodiscard]] bool is_brute() const { return options_.method == QueryMethod::kBrute; }
  [[nodiscard]] bool is_on_device() const { return backend() != nullptr; }
  [[nodiscard]] DeviceQueries& device_queries() {
    return view_->device_queries(state_.executor().alone(), *backend());
  }
  /// `needs_closed`: the query asks what is inside.
  [[nodiscard]] DevicePointQuery device_query(bool needs_closed) {
    DevicePointQuery query;
    query.brute = is_brute();
    query.rule = rule();
    query.closed = needs_closed && !is_brute() && is_closed();
    query.stream = options_.stream;
    query.results_stream = options_.results_stream;
    query.report = options_.statistics != nullptr ? &report_ : nullptr;
    query.executor = &executor_;
    return query;
  }
  /// The points, on a device: `packed` is left to the caller where they are in the host's memory.
  [[nodiscard]] DevicePoints device_points() const {
    const PointParts& parts = points_.parts();
    DevicePoints given;
    if (!lies_there(parts.points.data, "points")) return given;
    given.rows = parts.points;
    given.check = points_.is_checked();
    if (lies_there(parts.radii.data, "radii"))
      given.radii = parts.radii;
    else if (parts.radii.data != nullptr)
      given.radius = number_at(parts.radii, 0, 0);
    return given;
  }
  /// The answers if there are no triangles.
  template <class T>
  void clear(std::span<T> out, const T& nothing, const char* name) const {
    if (!lies_there(points_.parts().points.data, "points")) static_cast<void>(take_all());
    if (!lies_there(out.data(), name)) return std::fill(out.begin(), out.end(), nothing);
    DeviceQuery after;
    after.stream = options_.stream;
    after.results_stream = options_.results_stream;
    const std::vector<T> all(out.size(), nothing);
    backend()->write(out.data(), all.data(), out.size_bytes(), after);
  }
  [[nodiscard]] const SceneView& view() const { return *view_; }
  [[nodiscard]] InsideRule rule() const { return options_.inside; }

  /// The trees, brought to where the triangles are.
  [[nodiscard]] NearestScene trees() {
    view_->engine.prepare_tree(executor_, &report_);
    view_->engine.add_rays(points_.size());
    Stopwatch watch;
    const NearestScene trees = view_->points.scene(
        executor_, view_->source(), TreeQueries::tree(view_->engine), view_->version());
    report_.hierarchy_ms += watch.lap_ms();
    return trees;
  }
  [[nodiscard]] bool is_closed() {
    Stopwatch watch;
    const Closedness closed =
        view_->points.closedness(executor_, view_->source(), view_->version());
    report_.hierarchy_ms += watch.lap_ms();
    const bool suits = closed.suits(rule());
    report_.plan.emplace_back(suits ? "inside: the surface is closed, so one ray a point tells"
                                    : "inside: the surface is open, so six rays a point vote");
    return suits;
  }

  /// All points, validated.
  [[nodiscard]] std::vector<QueryPoint> take_all() const {
    std::vector<QueryPoint> all(points_.size());
    executor_.for_each_block(all.size(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
      points_.take(begin, end, all.data() + begin);
    });
    return all;
  }

  /// Writes the statistics.
  void finish() {
    if (options_.statistics == nullptr) return;
    QueryStatistics& out = *options_.statistics;
    out = {};
    out.rays = points_.size();
    out.triangles = visible_triangles(state_.runs, options_.mask);
    out.update_ms = state_.update_ms;
    out.hierarchy_ms = report_.hierarchy_ms;
    out.plan = std::move(report_.plan);
    if (is_brute() && !is_empty()) out.plan = {"brute force, as asked for"};
    out.order_ms = report_.order_ms;
    out.total_ms = watch_.lap_ms();
    out.trace_ms = is_on_device() ? report_.trace_ms : out.total_ms - out.hierarchy_ms;
  }

 private:
  [[nodiscard]] const DeviceBackend* backend() const {
    return ContextAccess::backend(state_.context);
  }
  /// Whether an array lies in the memory of the scene's device.
  [[nodiscard]] bool lies_there(const void* data, const char* name) const {
    return data != nullptr && backend() != nullptr && backend()->is_device_memory(data, name);
  }

  Stopwatch watch_;
  SceneAccess::State& state_;
  const SceneGate::Reading reading_;
  const QueryPoints& points_;
  const PointOptions& options_;
  const Executor executor_;
  std::shared_ptr<SceneView> view_;
  std::unique_lock<std::mutex> lock_;
  QueryReport report_;
};

ClosestPoint point_on(const QueryPoint& point, std::uint32_t triangle, const Corners& corners) {
  return closest_point_on(point.at, triangle, corners.a, corners.b, corners.c);
}

/// The most points that a device answers at once, and the most triangles that it finds for them.
constexpr std::size_t kMostDevicePoints = std::size_t{1} << 20;
constexpr std::size_t kMostDeviceFound = std::size_t{1} << 21;

/// Calls `answer(points, ask)` for parts of the points, which find `k` triangles each.
template <class Answer>
void for_each_device_part(const PointQuery& query, std::size_t k, DevicePointQuery ask,
                          const Answer& answer) {
  const std::size_t most =
      std::max<std::size_t>(1, std::min(kMostDevicePoints, kMostDeviceFound / k));
  const DevicePoints all = query.device_points();
  DevicePoints part = all;
  Buffer<QueryPoint> packed;
  for (; part.first < query.points().size(); part.first += most) {
    query.executor().check();
    part.count = std::min(most, query.points().size() - part.first);
    if (all.rows.data != nullptr) {
      part.rows = rows_from(all.rows, part.first);
      if (all.radii.data != nullptr) part.radii = rows_from(all.radii, part.first);
    } else {
      packed.resize_uninitialized(part.count);
      query.executor().for_each_block(
          part.count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
            query.points().take(part.first + begin, part.first + end, packed.data() + begin);
          });
      part.packed = {packed.data(), packed.size()};
    }
    answer(part, ask);
    ask.tells = false;
  }
}

/// For brute force: finds the corners by number.
void write_found(const PointQuery& query, View<const QueryPoint> points,
                 View<const FoundTriangle> found, std::size_t k, ClosestPoint* out) {
  const TriangleSource source = query.view().source();
  query.executor().for_each_block(points.size, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * k; i < end * k; ++i) {
      out[i] = {};
      if (found[i].triangle == kInvalidId) continue;
      const TriangleRun& run = source.runs[source.run_of(found[i].triangle)];
      const auto [a, b, c] = run.corners(found[i].triangle - run.first);
      out[i] = point_on(points[i / k], found[i].triangle, {a, b, c});
    }
    query.view().name_points({out + begin * k, (end - begin) * k});
  });
}

void nearest(PointQuery* query, std::size_t k, std::span<ClosestPoint> out) {
  if (query->is_empty()) return query->clear(out, ClosestPoint{}, "found");
  if (query->is_on_device()) {
    DeviceQueries& there = query->device_queries();
    return for_each_device_part(*query, k, query->device_query(false),
                                [&](const DevicePoints& points, const DevicePointQuery& ask) {
                                  there.nearest(points, static_cast<std::uint32_t>(k), ask,
                                                {out.data() + points.first * k, points.count * k});
                                });
  }
  if (query->is_brute()) {
    const std::vector<QueryPoint> points = query->take_all();
    std::vector<FoundTriangle> found(points.size() * k);
    brute::nearest(query->executor(), query->view().source(), points, k, found);
    return write_found(*query, points, found, k, out.data());
  }
  const NearestScene trees = query->trees();
  find_nearest(query->executor(), trees, query->points(), static_cast<std::uint32_t>(k),
               [&](const NearestTile& tile) {
                 ClosestPoint* const to = out.data() + tile.begin * k;
                 for (std::size_t i = 0; i < tile.found.size; ++i) {
                   const FoundTriangle& one = tile.found[i];
                   to[i] = one.triangle == kInvalidId
                               ? ClosestPoint{}
                               : point_on(tile.points[i / k], one.triangle,
                                          corners_at(trees[one.tree], one.place));
                 }
                 query->view().name_points({to, tile.found.size});
               });
}

void signed_distances(PointQuery* query, std::span<double> out) {
  if (query->is_empty())
    return query->clear(out, std::numeric_limits<double>::infinity(), "distances");
  if (query->is_on_device()) {
    DeviceQueries& there = query->device_queries();
    return for_each_device_part(
        *query, 1, query->device_query(true),
        [&](const DevicePoints& points, const DevicePointQuery& ask) {
          there.signed_distance(points, ask, {out.data() + points.first, points.count});
        });
  }
  if (query->is_brute()) {
    const std::vector<QueryPoint> points = query->take_all();
    std::vector<FoundTriangle> found(points.size());
    std::vector<std::uint8_t> inside(points.size());
    brute::nearest(query->executor(), query->view().source(), points, 1, found);
    brute::contains(query->executor(), query->view().source(), points, query->rule(), inside);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = inside[i] != 0 && found[i].distance > 0 ? -found[i].distance : found[i].distance;
    return;
  }
  const NearestScene trees = query->trees();
  find_signed_distances(query->executor(), trees, query->points(), query->rule(),
                        query->is_closed(), {out.data(), out.size()});
}

void contains(PointQuery* query, std::span<std::uint8_t> out) {
  if (query->is_empty()) return query->clear(out, std::uint8_t{0}, "inside");
  const View<std::uint8_t> inside(out.data(), out.size());
  if (query->is_on_device()) {
    DeviceQueries& there = query->device_queries();
    return for_each_device_part(*query, 1, query->device_query(true),
                                [&](const DevicePoints& points, const DevicePointQuery& ask) {
                                  there.contains(points, ask,
                                                 inside.slice(points.first, points.count));
                                });
  }
  if (query->is_brute())
    return brute::contains(query->executor(), query->view().source(), query->take_all(),
                           query->rule(), inside);
  const NearestScene trees = query->trees();
  find_inside(query->executor(), *trees.tree, query->points(), query->rule(), query->is_closed(),
              inside);
}

/// Points and radii are read by the same machine; one radius for all may be in the host's memory.
void check_point_places(const DeviceBackend& backend, const PointParts& parts) {
  if (parts.count == 0 || parts.radii.data == nullptr) return;
  const bool points_there = backend.is_device_memory(parts.points.data, "points");
  const bool radii_there = backend.is_device_memory(parts.radii.data, "radii");
  if (points_there == radii_there || (points_there && parts.radii.row_stride == 0)) return;
  throw Error(ErrorCode::kUnsupported,
              points_there ? "they are in the host's memory, but the points in the device's: put "
                             "both there, or give one radius for all, with a row stride of 0"
                           : "they are in the device's memory, but the points in the host's: put "
                             "both into one",
              "radii");
}

/// `body(query)`, among the context's threads: others of them may wait for the view that it holds.
/// On a device it stays on the calling thread. Names the first of several invalid points, whichever
/// a thread has found.
template <class Body>
void run_point_query(const Scene& scene, const PointParts& parts, std::size_t results,
                     std::size_t per_point, const char* name, const PointOptions& options,
                     const Body& body) {
  if (results != parts.count * per_point)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(results) + " results for " + std::to_string(parts.count) +
                    " points" +
                    (per_point != 1 ? " with " + std::to_string(per_point) + " each" : ""),
                name);
  const QueryPoints points(parts, options.check);
  const Context& context = SceneAccess::state(scene).context;
  const DeviceBackend* const backend = ContextAccess::backend(context);
  if (backend != nullptr) check_point_places(*backend, parts);
  const auto work = [&] {
    PointQuery query(scene, points, options);
    body(&query);
    query.finish();
  };
  within_memory("there is not enough memory to answer them", "points", [&] {
    try {
      backend != nullptr ? work() : ContextAccess::executor(context).enter(work);
    } catch (const WrongPoint&) {
      points.throw_first_fault();
    }
  });
}

template <class Result, class Ask>
std::vector<Result> make_results(std::size_t count, const Ask& ask) {
  return within_memory("there is not enough memory to answer them", "points", [&] {
    std::vector<Result> results(count);
    ask(std::span<Result>(results));
    return results;
  });
}

}  // namespace

void closest_point(const Scene& scene, const PointParts& points, std::span<ClosestPoint> found,
                   const PointOptions& options) {
  run_point_query(scene, points, found.size(), 1, "found", options,
                  [&](PointQuery* query) { nearest(query, 1, found); });
}
std::vector<ClosestPoint> closest_point(const Scene& scene, const PointParts& points,
                                        const PointOptions& options) {
  return make_results<ClosestPoint>(
      points.count, [&](auto found) { closest_point(scene, points, found, options); });
}

void nearest(const Scene& scene, const PointParts& points, std::size_t k,
             std::span<ClosestPoint> found, const PointOptions& options) {
  if (k == 0 || k > kMostNearest)
    throw Error(
        ErrorCode::kInvalidArgument,
        "k is " + std::to_string(k) + "; 1 to " + std::to_string(kMostNearest) + " is expected",
        "k");
  run_point_query(scene, points, found.size(), k, "found", options,
                  [&](PointQuery* query) { nearest(query, k, found); });
}
std::vector<ClosestPoint> nearest(const Scene& scene, const PointParts& points, std::size_t k,
                                  const PointOptions& options) {
  return make_results<ClosestPoint>(points.count * std::min(k, kMostNearest),
                                    [&](auto found) { nearest(scene, points, k, found, options); });
}

void signed_distance(const Scene& scene, const PointParts& points, std::span<double> distances,
                     const PointOptions& options) {
  run_point_query(scene, points, distances.size(), 1, "distances", options,
                  [&](PointQuery* query) { signed_distances(query, distances); });
}
std::vector<double> signed_distance(const Scene& scene, const PointParts& points,
                                    const PointOptions& options) {
  return make_results<double>(
      points.count, [&](auto distances) { signed_distance(scene, points, distances, options); });
}

void contains(const Scene& scene, const PointParts& points, std::span<std::uint8_t> inside,
              const PointOptions& options) {
  run_point_query(scene, points, inside.size(), 1, "inside", options,
                  [&](PointQuery* query) { contains(query, inside); });
}
std::vector<std::uint8_t> contains(const Scene& scene, const PointParts& points,
                                   const PointOptions& options) {
  return make_results<std::uint8_t>(points.count,
                                    [&](auto inside) { contains(scene, points, inside, options); });
}

}  // namespace raysheaf
