// One call of a query: the committed scene, the validated rays, and the statistics.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "api/query_filter.h"
#include "api/query_rays.h"
#include "api/scene/scene_impl.h"
#include "device/device_queries.h"
#include "exec/stopwatch.h"
#include "raysheaf/query.h"

namespace raysheaf {

inline constexpr std::size_t kMostRays = 0x7fffffff;

/// How a query processes its rays.
enum class Passes {
  kWhole,    ///< all of them stage by stage
  kInTiles,  ///< as the engine chooses, if it runs on the CPU and not by brute force
};

/// One call: prevents changes of the scene, and collects statistics.
class Query {
 public:
  Query(const Scene& scene, const QueryRays& rays, const QueryOptions& options, Passes passes)
      : state_(SceneAccess::state(scene)),
        reading_(state_.gate),
        rays_(rays),
        options_(options),
        executor_(options.stop != nullptr ? state_.executor().alone().until(*options.stop)
                                          : state_.executor().alone()) {
    state_.require_committed();
    executor_.check();
    if (rays.size() > kMostRays)
      throw Error(ErrorCode::kUnsupported,
                  std::to_string(rays.size()) + " rays are more than 2^31 - 1", "rays");
    if (rays.size() != 0) view_ = state_.views.view_for(state_.runs, options.mask);
    if (passes == Passes::kWhole || view_ == nullptr || is_brute() || is_on_device()) take_all();
    if (view_ == nullptr) return;
    lock_ = std::unique_lock(view_->mutex);
    view_->refresh(state_.runs);
    if (chooses_hits(options)) filter_.emplace(executor_, state_, *view_, options);
    // Brute force only reads the triangles, which do not change during `reading_`.
    if (is_brute() && !is_on_device()) lock_.unlock();
  }

  /// Stops when the caller requests it.
  [[nodiscard]] const Executor& executor() const { return executor_; }
  /// All rays, validated; empty if they are processed in tiles.
  [[nodiscard]] View<const Ray> rays() const { return whole_; }
  /// The rays for an engine that processes tiles.
  [[nodiscard]] const RaySource& source() const { return rays_; }
  /// Whether nothing can be hit: there are no rays, or no triangles visible to the mask.
  [[nodiscard]] bool is_empty() const { return view_ == nullptr; }
  [[nodiscard]] bool is_brute() const { return options_.method == QueryMethod::kBrute; }
  [[nodiscard]] const DeviceBackend* backend() const {
    return ContextAccess::backend(state_.context);
  }
  [[nodiscard]] bool is_on_device() const {
    return backend() != nullptr && !chooses_hits(options_);
  }
  /// Selects hits; null: all count.
  [[nodiscard]] const HitFilter* filter() const { return filter_ ? filter_->get() : nullptr; }
  [[nodiscard]] DeviceQueries& device_queries() {
    return view_->device_queries(state_.executor().alone(), *backend());
  }
  [[nodiscard]] DeviceQuery device_query() {
    DeviceQuery query;
    query.brute = is_brute();
    query.check = options_.check;
    query.count = options_.count_tests;
    query.stream = options_.stream;
    query.results_stream = options_.results_stream;
    query.report = report();
    query.executor = &executor_;
    return query;
  }
  [[nodiscard]] SceneView& view() { return *view_; }
  [[nodiscard]] PlannedOptions engine_options() const {
    PlannedOptions options;
    options.count = options_.statistics != nullptr && options_.count_tests;
    options.filter = filter();
    return options;
  }
  [[nodiscard]] QueryReport* report() {
    return options_.statistics != nullptr ? &report_ : nullptr;
  }

  void finish() {
    if (options_.statistics == nullptr) return;
    if (!is_empty() && is_brute() && !is_on_device()) report_of_brute_force();
    QueryStatistics& out = *options_.statistics;
    out = {};
    out.rays = rays_.size();
    out.triangles = visible_triangles(state_.runs, options_.mask);
    out.bound_tests = report_.bound_tests;
    out.ray_bound_tests = report_.ray_bound_tests;
    out.triangle_tests = report_.triangle_tests;
    out.update_ms = state_.update_ms;
    out.check_ms = check_ms_ + report_.take_ms;
    out.order_ms = report_.order_ms;
    out.hierarchy_ms = report_.hierarchy_ms;
    out.trace_ms = report_.trace_ms;
    out.plan = std::move(report_.plan);
    out.total_ms = watch_.lap_ms();
  }

  void traced_by_brute_force(Stopwatch* watch) { report_.trace_ms = watch->lap_ms(); }

 private:
  void take_all() {
    // Rays in a device's memory are validated there.
    if (rays_.is_packed() && is_on_device() &&
        backend()->is_device_memory(rays_.rays().data, "rays")) {
      whole_ = rays_.rays();
      return;
    }
    const Stopwatch watch;
    whole_ = raysheaf::take_all(executor_, rays_, &room_);
    check_ms_ = watch.ms();
  }
  void report_of_brute_force() {
    if (options_.count_tests)
      report_.triangle_tests = std::uint64_t{rays_.size()} * view_->source().count;
    report_.plan = {"brute force, as requested"};
  }

  Stopwatch watch_;
  SceneAccess::State& state_;
  const SceneGate::Reading reading_;
  const QueryRays& rays_;
  Buffer<Ray> room_;
  View<const Ray> whole_;
  const QueryOptions& options_;
  const Executor executor_;
  double check_ms_ = 0;
  std::shared_ptr<SceneView> view_;
  std::unique_lock<std::mutex> lock_;
  std::optional<QueryFilter> filter_;
  QueryReport report_;
};

}  // namespace raysheaf
