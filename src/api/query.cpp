// The front door of queries: checks, the view that the mask shows, the engine, names for the hits.
#include "raysheaf/query.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "api/query_brute.h"
#include "api/query_check.h"
#include "api/scene_impl.h"
#include "exec/stopwatch.h"
#include "ranks/share.h"

namespace raysheaf {
namespace {

constexpr std::size_t kMostRays = 0x7fffffff;

/// One call: holds the scene as it is, and counts what is done.
class Query {
 public:
  Query(const Scene& scene, std::span<const Ray> rays, const QueryOptions& options)
      : state_(SceneAccess::state(scene)),
        reading_(state_.gate),
        rays_(rays.data(), rays.size()),
        options_(options),
        executor_(options.stop != nullptr ? state_.executor().until(*options.stop)
                                          : state_.executor()) {
    state_.require_committed();
    executor_.check();
    if (rays.size() > kMostRays)
      throw Error(ErrorCode::kUnsupported,
                  std::to_string(rays.size()) + " rays are more than 2^31 - 1", "rays");
    Stopwatch watch;
    // Rays in a device's memory are looked over there.
    if (options.check && !(is_on_device() && backend()->is_device_memory(rays.data())))
      check_rays(executor(), rays_);
    check_ms_ = watch.lap_ms();
    if (rays.empty()) return;
    view_ = state_.views.view_for(state_.runs, options.mask);
    if (view_ == nullptr) return;
    lock_ = std::unique_lock(view_->mutex);
    view_->refresh(state_.runs);
    // Brute force reads the triangles alone, which stay while `reading_` is there.
    if (is_brute() && !is_on_device()) lock_.unlock();
  }

  /// Until the caller asks to stop.
  [[nodiscard]] const Executor& executor() const { return executor_; }
  [[nodiscard]] View<const Ray> rays() const { return rays_; }
  /// Whether nothing can be met: no rays, or no triangles that they see.
  [[nodiscard]] bool is_empty() const { return view_ == nullptr; }
  [[nodiscard]] bool is_brute() const { return options_.method == QueryMethod::kBrute; }
  [[nodiscard]] const DeviceBackend* backend() const {
    return ContextAccess::backend(state_.context);
  }
  [[nodiscard]] bool is_on_device() const { return backend() != nullptr; }
  [[nodiscard]] DeviceEngine& device_engine() {
    return view_->device_engine(state_.executor(), *backend());
  }
  [[nodiscard]] DeviceQuery device_query() {
    DeviceQuery query;
    query.brute = is_brute();
    query.check = options_.check;
    query.count = options_.count_tests;
    query.stream = options_.stream;
    query.report = report();
    query.executor = &executor_;
    return query;
  }
  [[nodiscard]] SceneView& view() { return *view_; }
  [[nodiscard]] EngineOptions engine_options() const {
    return {Facing::kBoth, options_.statistics != nullptr && options_.count_tests};
  }
  [[nodiscard]] EngineReport* report() {
    return options_.statistics != nullptr ? &report_ : nullptr;
  }

  /// Writes the statistics.
  void finish() {
    if (options_.statistics == nullptr) return;
    if (!is_empty() && is_brute() && !is_on_device()) report_of_brute_force();
    QueryStatistics& out = *options_.statistics;
    out = {};
    out.rays = rays_.size;
    out.triangles = is_empty() ? 0 : view_->source().count;
    out.bound_tests = report_.bound_tests;
    out.ray_bound_tests = report_.ray_bound_tests;
    out.triangle_tests = report_.triangle_tests;
    out.update_ms = state_.update_ms;
    out.check_ms = check_ms_;
    out.order_ms = report_.order_ms;
    out.hierarchy_ms = report_.hierarchy_ms;
    out.trace_ms = report_.trace_ms;
    out.plan = std::move(report_.plan);
    out.total_ms = watch_.lap_ms();
  }

  void traced_by_brute_force(Stopwatch* watch) { report_.trace_ms = watch->lap_ms(); }

 private:
  void report_of_brute_force() {
    if (options_.count_tests)
      report_.triangle_tests = std::uint64_t{rays_.size} * view_->source().count;
    report_.plan = {"brute force, as asked for"};
  }

  Stopwatch watch_;
  SceneAccess::State& state_;
  const SceneGate::Reading reading_;
  View<const Ray> rays_;
  const QueryOptions& options_;
  const Executor executor_;
  double check_ms_ = 0;
  std::shared_ptr<SceneView> view_;
  std::unique_lock<std::mutex> lock_;
  EngineReport report_;
};

void check_length(std::span<const Ray> rays, std::size_t size, const char* name) {
  if (size != rays.size())
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(size) + " results for " + std::to_string(rays.size()) + " rays",
                name);
}

/// Where nothing can be met. A device's memory is not written from here.
template <class T>
void clear(const Query& query, std::span<T> out) {
  if (out.empty()) return;
  if (query.is_on_device() && query.backend()->is_device_memory(out.data()))
    return query.backend()->write(out.data(), std::vector<T>(out.size()).data(), out.size_bytes());
  std::fill(out.begin(), out.end(), T{});
}

void closest_hits(Query* query, std::span<Hit> hits) {
  SceneView& view = query->view();
  if (query->is_on_device())
    return query->device_engine().closest_hit(query->rays(), query->device_query(),
                                              View<Hit>(hits.data(), hits.size()));
  if (query->is_brute()) {
    Stopwatch watch;
    Buffer<EngineHit> found;
    found.resize_uninitialized(hits.size());
    brute::closest_hit(query->executor(), view.source(), query->rays(), found);
    query->traced_by_brute_force(&watch);
    view.name_hits(query->executor(), found, hits.data());
    return;
  }
  view.scratch.resize_uninitialized(hits.size());
  view.engine.closest_hit(query->executor(), query->rays(), query->engine_options(), view.scratch,
                          {}, query->report());
  view.name_hits(query->executor(), view.scratch, hits.data());
}

void any_hits(Query* query, std::span<std::uint8_t> occluded) {
  const View<std::uint8_t> out(occluded.data(), occluded.size());
  if (query->is_on_device())
    return query->device_engine().any_hit(query->rays(), query->device_query(), out);
  if (query->is_brute()) {
    Stopwatch watch;
    brute::any_hit(query->executor(), query->view().source(), query->rays(), out);
    query->traced_by_brute_force(&watch);
    return;
  }
  query->view().engine.any_hit(query->executor(), query->rays(), query->engine_options(), out, {},
                               query->report());
}

/// Calls `take(rows)` with what was found, which has a `for_each` as `FoundRows` has.
template <class Take>
void find_rows(Query* query, const Take& take) {
  if (query->is_empty()) return take(brute::Rows{});
  if (query->is_on_device())
    return take(query->device_engine().all_hits(query->rays(), query->device_query()));
  if (!query->is_brute())
    return take(query->view().engine.all_hits(query->executor(), query->rays(),
                                              query->engine_options(), query->report()));
  Stopwatch watch;
  const brute::Rows rows =
      brute::all_hits(query->executor(), query->view().source(), query->rays());
  query->traced_by_brute_force(&watch);
  take(rows);
}

/// The lengths of rows.
struct MeasureRow {
  std::uint64_t* lengths;

  void operator()(std::size_t ray, View<const EngineHit> hits) const { lengths[ray] = hits.size; }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(lengths + ray, 1); }
};

/// Rows where they begin.
struct NameRow {
  Query* query;  ///< where nothing can be hit it has no view
  const std::uint64_t* begins;
  Hit* out;

  void operator()(std::size_t ray, View<const EngineHit> hits) const {
    query->view().name_hits(hits, out + begins[ray]);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(out + begins[ray], 1); }
};

void name_rows(Query* query, HitRows* out) {
  const std::size_t rays = query->rays().size;
  out->offsets.assign(rays + 1, 0);
  std::uint64_t* const ends = out->offsets.data() + 1;
  find_rows(query, [&](const auto& rows) {
    rows.for_each(query->executor(), MeasureRow{ends});
    for (std::size_t i = 1; i < rays; ++i) ends[i] += ends[i - 1];
    out->hits.resize(out->offsets.back());
    rows.for_each(query->executor(), NameRow{query, out->offsets.data(), out->hits.data()});
  });
}

void count_hits(Query* query, std::span<std::uint32_t> counts) {
  clear(*query, counts);
  if (query->is_on_device() && !query->is_empty())
    return query->device_engine().count_hits(query->rays(), query->device_query(),
                                             View<std::uint32_t>(counts.data(), counts.size()));
  find_rows(query, [&](const auto& rows) {
    rows.for_each(query->executor(), [&](std::size_t ray, View<const EngineHit> hits) {
      counts[ray] = static_cast<std::uint32_t>(hits.size);
    });
  });
}

void add_counts(const QueryStatistics& piece, QueryStatistics* sum) {
  for (const auto field : {&QueryStatistics::bound_tests, &QueryStatistics::ray_bound_tests,
                           &QueryStatistics::triangle_tests})
    sum->*field += piece.*field;
  for (const auto field :
       {&QueryStatistics::order_ms, &QueryStatistics::hierarchy_ms, &QueryStatistics::trace_ms})
    sum->*field += piece.*field;
  sum->triangles = piece.triangles;
  sum->update_ms = piece.update_ms;
  if (sum->plan.empty()) sum->plan = piece.plan;
}

/// `one(rays, answers, options)`, in pieces where processes share the scene's context. Counts are
/// then those of all, times and the plan this process's. A device's own memory is not shared.
template <class Answer, class One>
void answer(const Scene& scene, std::span<const Ray> rays, std::span<Answer> answers,
            const QueryOptions& options, const One& one) {
  const Context& context = SceneAccess::state(scene).context;
  Communicator* const ranks = ContextAccess::ranks(context);
  const DeviceBackend* const backend = ContextAccess::backend(context);
  const auto on_device = [backend](const void* data) {
    return backend != nullptr && backend->is_device_memory(data);
  };
  const Pieces pieces = pieces_of(rays.size(), ranks != nullptr ? ranks->size() : 1);
  if (ranks == nullptr || ranks->size() == 1 || pieces.number() <= 1 || on_device(rays.data()) ||
      on_device(answers.data()))
    return one(rays, answers, options);
  Stopwatch watch;
  QueryStatistics sum, piece;
  sum.rays = rays.size();
  if (options.check) check_rays(ContextAccess::executor(context), {rays.data(), rays.size()});
  sum.check_ms = watch.lap_ms();
  QueryOptions of_piece = options;
  of_piece.check = false;
  if (options.statistics != nullptr) of_piece.statistics = &piece;
  std::memset(static_cast<void*>(answers.data()), 0, answers.size_bytes());
  share_out(*ranks, pieces, [&](std::size_t begin, std::size_t end) {
    one(rays.subspan(begin, end - begin), answers.subspan(begin, end - begin), of_piece);
    add_counts(piece, &sum);
  });
  unite(*ranks, answers);
  std::array<std::uint64_t, 3> counts{sum.bound_tests, sum.ray_bound_tests, sum.triangle_tests};
  add(*ranks, counts);
  sum.bound_tests = counts[0];
  sum.ray_bound_tests = counts[1];
  sum.triangle_tests = counts[2];
  sum.total_ms = sum.check_ms + watch.lap_ms();
  if (options.statistics != nullptr) *options.statistics = std::move(sum);
}

}  // namespace

void closest_hit(const Scene& scene, std::span<const Ray> rays, std::span<Hit> hits,
                 const QueryOptions& options) {
  translated([&] {
    check_length(rays, hits.size(), "hits");
    answer(scene, rays, hits, options, [&](auto some, std::span<Hit> out, const auto& how) {
      Query query(scene, some, how);
      if (query.is_empty())
        clear(query, out);
      else
        closest_hits(&query, out);
      query.finish();
    });
  });
}

std::vector<Hit> closest_hit(const Scene& scene, std::span<const Ray> rays,
                             const QueryOptions& options) {
  return translated([&] {
    std::vector<Hit> hits(rays.size());
    closest_hit(scene, rays, hits, options);
    return hits;
  });
}

void any_hit(const Scene& scene, std::span<const Ray> rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options) {
  translated([&] {
    check_length(rays, occluded.size(), "occluded");
    answer(scene, rays, occluded, options,
           [&](auto some, std::span<std::uint8_t> out, const auto& how) {
             Query query(scene, some, how);
             if (query.is_empty())
               clear(query, out);
             else
               any_hits(&query, out);
             query.finish();
           });
  });
}

std::vector<std::uint8_t> any_hit(const Scene& scene, std::span<const Ray> rays,
                                  const QueryOptions& options) {
  return translated([&] {
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(scene, rays, occluded, options);
    return occluded;
  });
}

HitRows all_hits(const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
  return translated([&] {
    Query query(scene, rays, options);
    HitRows rows;
    name_rows(&query, &rows);
    query.finish();
    return rows;
  });
}

void hit_counts(const Scene& scene, std::span<const Ray> rays, std::span<std::uint32_t> counts,
                const QueryOptions& options) {
  translated([&] {
    check_length(rays, counts.size(), "counts");
    Query query(scene, rays, options);
    count_hits(&query, counts);
    query.finish();
  });
}

std::vector<std::uint32_t> hit_counts(const Scene& scene, std::span<const Ray> rays,
                                      const QueryOptions& options) {
  return translated([&] {
    std::vector<std::uint32_t> counts(rays.size());
    hit_counts(scene, rays, counts, options);
    return counts;
  });
}

}  // namespace raysheaf
