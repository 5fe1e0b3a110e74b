// Implements the public queries: the view for the mask, the engine, and the ids of hits.
#include "raysheaf/query.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "api/query_brute.h"
#include "api/query_call.h"
#include "api/query_check.h"
#include "api/scene/scene_impl.h"
#include "exec/stopwatch.h"
#include "ranks/share.h"

namespace raysheaf {
namespace {

/// Every hit of a row.
constexpr std::size_t kEveryHit = ~std::size_t{0};

void check_length(std::size_t rays, std::size_t size, const char* name) {
  if (size != rays)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(size) + " results for " + std::to_string(rays) + " rays", name);
}

/// The answer if nothing can be hit. The caller's earlier work must be complete before, and a
/// device's memory is not written by the host.
template <class T>
void clear(Query* query, std::span<T> out, const char* name) {
  if (out.empty()) return;
  if (query->is_on_device() && query->backend()->is_device_memory(out.data(), name))
    return query->backend()->write(out.data(), std::vector<T>(out.size()).data(), out.size_bytes(),
                                   query->device_query());
  std::fill(out.begin(), out.end(), T{});
}

void closest_hits(Query* query, std::span<Hit> hits) {
  SceneView& view = query->view();
  if (query->is_on_device())
    return query->device_queries().closest_hit(query->rays(), query->device_query(),
                                               View<Hit>(hits.data(), hits.size()));
  if (query->is_brute()) {
    Stopwatch watch;
    Buffer<IndexedHit> found;
    found.resize_uninitialized(hits.size());
    brute::closest_hit(query->executor(), view.source(), query->rays(), query->filter(), found);
    query->traced_by_brute_force(&watch);
    view.name_hits(query->executor(), found, hits.data());
    return;
  }
  view.engine.closest_hit(
      query->executor(), query->source(), query->engine_options(),
      [&](std::size_t begin, View<const IndexedHit> found) {
        view.name_hits(found, hits.data() + begin);
      },
      query->report());
}

void any_hits(Query* query, std::span<std::uint8_t> occluded) {
  const View<std::uint8_t> out(occluded.data(), occluded.size());
  if (query->is_on_device())
    return query->device_queries().any_hit(query->rays(), query->device_query(), out);
  if (query->is_brute()) {
    Stopwatch watch;
    brute::any_hit(query->executor(), query->view().source(), query->rays(), query->filter(), out);
    query->traced_by_brute_force(&watch);
    return;
  }
  query->view().engine.any_hit(query->executor(), query->source(), query->engine_options(), out,
                               query->report());
}

/// Calls `take(rows)` with the found rows, which have a `for_each` like `FoundRows`.
template <class Take>
void find_rows(Query* query, const Take& take) {
  if (query->is_empty()) return take(brute::Rows{});
  if (query->is_on_device())
    return take(query->device_queries().all_hits(query->rays(), query->device_query()));
  if (!query->is_brute())
    return take(query->view().engine.all_hits(query->executor(), RaysInPlace(query->rays()),
                                              query->engine_options(), query->report()));
  Stopwatch watch;
  const brute::Rows rows =
      brute::all_hits(query->executor(), query->view().source(), query->rays(), query->filter());
  query->traced_by_brute_force(&watch);
  take(rows);
}

/// The lengths of rows, of which `most` hits are kept.
struct MeasureRow {
  std::uint64_t* lengths;
  std::size_t most;

  void operator()(std::size_t ray, View<const IndexedHit> hits) const {
    lengths[ray] = std::min(hits.size, most);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(lengths + ray, 1); }
};

/// Writes the hits of rows, with ids, to the rows' places.
struct NameRow {
  Query* query;  ///< without a view if nothing can be hit
  const std::uint64_t* begins;
  Hit* out;
  std::size_t most;

  void operator()(std::size_t ray, View<const IndexedHit> hits) const {
    query->view().name_hits({hits.data, std::min(hits.size, most)}, out + begins[ray]);
  }
  void comes_soon(std::size_t ray) const { __builtin_prefetch(out + begins[ray], 1); }
};

void name_rows(Query* query, std::size_t most, HitRows* out) {
  const std::size_t rays = query->rays().size;
  out->offsets.assign(rays + 1, 0);
  std::uint64_t* const ends = out->offsets.data() + 1;
  find_rows(query, [&](const auto& rows) {
    rows.for_each(query->executor(), MeasureRow{ends, most});
    for (std::size_t i = 1; i < rays; ++i) ends[i] += ends[i - 1];
    out->hits.resize(out->offsets.back());
    rows.for_each(query->executor(), NameRow{query, out->offsets.data(), out->hits.data(), most});
  });
}

void count_hits(Query* query, std::span<std::uint32_t> counts) {
  if (query->is_empty()) return clear(query, counts, "counts");
  if (query->is_on_device())
    return query->device_queries().count_hits(query->rays(), query->device_query(),
                                              View<std::uint32_t>(counts.data(), counts.size()));
  if (!query->is_brute())
    return query->view().engine.hit_counts(
        query->executor(), RaysInPlace(query->rays()), query->engine_options(),
        View<std::uint32_t>(counts.data(), counts.size()), query->report());
  std::fill(counts.begin(), counts.end(), 0u);
  find_rows(query, [&](const auto& rows) {
    rows.for_each(query->executor(), [&](std::size_t ray, View<const IndexedHit> hits) {
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
  if (sum->plan.empty()) sum->plan = piece.plan;
}

/// Where hits are chosen, the CPU answers, for which rays and answers must be in the host's memory.
void check_place(const Scene& scene, const QueryOptions& options, const void* data,
                 const char* name) {
  const DeviceBackend* const backend = ContextAccess::backend(SceneAccess::state(scene).context);
  if (backend != nullptr && chooses_hits(options) && backend->is_device_memory(data, name))
    throw Error(
        ErrorCode::kUnsupported,
        "they are in the device's memory, but sides, masks of rays and skipped triangles are "
        "answered by the CPU: copy them to the host's memory",
        name);
}

/// Calls `one(rays, answers, options)`, in pieces where processes share the scene's context. Counts
/// are then those of all, times and the plan this process's. A device's own memory is not shared.
template <class Answer, class One>
void answer(const Scene& scene, const QueryRays& rays, std::span<Answer> answers, const char* name,
            const QueryOptions& options, const One& one) {
  SceneAccess::State& state = SceneAccess::state(scene);
  const Context& context = state.context;
  Communicator* const ranks = ContextAccess::ranks(context);
  const DeviceBackend* const backend = ContextAccess::backend(context);
  const auto on_device = [backend](const void* data, const char* what) {
    return backend != nullptr && backend->is_device_memory(data, what);
  };
  const Pieces pieces = pieces_of(rays.size(), ranks != nullptr ? ranks->size() : 1);
  if (ranks == nullptr || ranks->size() == 1 || pieces.number() <= 1 ||
      (rays.is_packed() && on_device(rays.rays().data, "rays")) || on_device(answers.data(), name))
    return one(rays, answers, options);
  const SceneGate::Reading reading(state.gate);  // covers all pieces and their statistics
  Stopwatch watch;
  QueryStatistics sum, piece;
  sum.rays = rays.size();
  Buffer<Ray> room;
  const View<const Ray> all = take_all(ContextAccess::executor(context), rays, &room);
  sum.check_ms = watch.lap_ms();
  QueryOptions of_piece = options;
  if (options.statistics != nullptr) of_piece.statistics = &piece;
  std::memset(static_cast<void*>(answers.data()), 0, answers.size_bytes());
  share_out(*ranks, pieces, [&](std::size_t begin, std::size_t end) {
    if (!options.ray_masks.empty())
      of_piece.ray_masks = options.ray_masks.subspan(begin, end - begin);
    if (!options.skip.empty()) of_piece.skip = options.skip.subspan(begin, end - begin);
    one(QueryRays(all.slice(begin, end - begin), false), answers.subspan(begin, end - begin),
        of_piece);
    add_counts(piece, &sum);
  });
  unite(*ranks, answers);
  std::array<std::uint64_t, 3> counts{sum.bound_tests, sum.ray_bound_tests, sum.triangle_tests};
  add(*ranks, counts);
  sum.bound_tests = counts[0];
  sum.ray_bound_tests = counts[1];
  sum.triangle_tests = counts[2];
  sum.total_ms = sum.check_ms + watch.lap_ms();
  if (options.statistics == nullptr) return;
  // Also if other processes took every piece.
  sum.triangles = visible_triangles(state.runs, options.mask);
  sum.update_ms = state.update_ms;
  *options.statistics = std::move(sum);
}

/// Calls `ask(rays)`; if rays are invalid, names the first, no matter which one a thread has found.
template <class Rays, class Ask>
void with_rays(const Rays& given, const QueryOptions& options, const Ask& ask) {
  const QueryRays rays(given, options.check);
  check_choice_of_hits(options, rays.size());
  answered([&] {
    try {
      ask(rays);
    } catch (const WrongRay&) {
      rays.throw_first_fault();
    }
  });
}

/// Calls `body(query)` on one of the context's threads, because others of them may wait for the
/// view that it holds. On a device it stays on the calling thread, because the stream may belong to
/// that thread.
template <class Body>
void run_query(const Scene& scene, const QueryRays& rays, const QueryOptions& options,
               Passes passes, const Body& body) {
  const Context& context = SceneAccess::state(scene).context;
  const auto work = [&] {
    Query query(scene, rays, options, passes);
    body(&query);
    query.finish();
  };
  if (rays.is_packed()) check_place(scene, options, rays.rays().data, "rays");
  if (ContextAccess::backend(context) != nullptr && !chooses_hits(options)) return work();
  ContextAccess::executor(context).enter(work);
}

void closest_hit(const Scene& scene, const QueryRays& rays, std::span<Hit> hits,
                 const QueryOptions& options) {
  constexpr const char* kName = "hits";
  check_length(rays.size(), hits.size(), kName);
  check_place(scene, options, hits.data(), kName);
  answer(scene, rays, hits, kName, options,
         [&](const QueryRays& some, std::span<Hit> out, const QueryOptions& how) {
           run_query(scene, some, how, Passes::kInTiles, [&](Query* query) {
             if (query->is_empty())
               clear(query, out, kName);
             else
               closest_hits(query, out);
           });
         });
}

void any_hit(const Scene& scene, const QueryRays& rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options) {
  constexpr const char* kName = "occluded";
  check_length(rays.size(), occluded.size(), kName);
  check_place(scene, options, occluded.data(), kName);
  answer(scene, rays, occluded, kName, options,
         [&](const QueryRays& some, std::span<std::uint8_t> out, const QueryOptions& how) {
           run_query(scene, some, how, Passes::kInTiles, [&](Query* query) {
             if (query->is_empty())
               clear(query, out, kName);
             else
               any_hits(query, out);
           });
         });
}

HitRows all_hits(const Scene& scene, const QueryRays& rays, std::size_t most,
                 const QueryOptions& options) {
  HitRows rows;
  run_query(scene, rays, options, Passes::kWhole,
            [&](Query* query) { name_rows(query, most, &rows); });
  return rows;
}

void hit_counts(const Scene& scene, const QueryRays& rays, std::span<std::uint32_t> counts,
                const QueryOptions& options) {
  check_length(rays.size(), counts.size(), "counts");
  check_place(scene, options, counts.data(), "counts");
  run_query(scene, rays, options, Passes::kWhole, [&](Query* query) { count_hits(query, counts); });
}

}  // namespace

void closest_hit(const Scene& scene, std::span<const Ray> rays, std::span<Hit> hits,
                 const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { closest_hit(scene, r, hits, options); });
}

void closest_hit(const Scene& scene, const RayParts& rays, std::span<Hit> hits,
                 const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { closest_hit(scene, r, hits, options); });
}

std::vector<Hit> closest_hit(const Scene& scene, std::span<const Ray> rays,
                             const QueryOptions& options) {
  return answered([&] {
    std::vector<Hit> hits(rays.size());
    closest_hit(scene, rays, hits, options);
    return hits;
  });
}

void any_hit(const Scene& scene, std::span<const Ray> rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { any_hit(scene, r, occluded, options); });
}

void any_hit(const Scene& scene, const RayParts& rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { any_hit(scene, r, occluded, options); });
}

std::vector<std::uint8_t> any_hit(const Scene& scene, std::span<const Ray> rays,
                                  const QueryOptions& options) {
  return answered([&] {
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(scene, rays, occluded, options);
    return occluded;
  });
}

HitRows all_hits(const Scene& scene, std::span<const Ray> rays, const QueryOptions& options) {
  HitRows rows;
  with_rays(rays, options,
            [&](const QueryRays& r) { rows = all_hits(scene, r, kEveryHit, options); });
  return rows;
}

HitRows all_hits(const Scene& scene, const RayParts& rays, const QueryOptions& options) {
  HitRows rows;
  with_rays(rays, options,
            [&](const QueryRays& r) { rows = all_hits(scene, r, kEveryHit, options); });
  return rows;
}

HitRows first_hits(const Scene& scene, std::span<const Ray> rays, std::uint32_t most,
                   const QueryOptions& options) {
  HitRows rows;
  with_rays(rays, options, [&](const QueryRays& r) { rows = all_hits(scene, r, most, options); });
  return rows;
}

HitRows first_hits(const Scene& scene, const RayParts& rays, std::uint32_t most,
                   const QueryOptions& options) {
  HitRows rows;
  with_rays(rays, options, [&](const QueryRays& r) { rows = all_hits(scene, r, most, options); });
  return rows;
}

void hit_counts(const Scene& scene, std::span<const Ray> rays, std::span<std::uint32_t> counts,
                const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { hit_counts(scene, r, counts, options); });
}

void hit_counts(const Scene& scene, const RayParts& rays, std::span<std::uint32_t> counts,
                const QueryOptions& options) {
  with_rays(rays, options, [&](const QueryRays& r) { hit_counts(scene, r, counts, options); });
}

std::vector<std::uint32_t> hit_counts(const Scene& scene, std::span<const Ray> rays,
                                      const QueryOptions& options) {
  return answered([&] {
    std::vector<std::uint32_t> counts(rays.size());
    hit_counts(scene, rays, counts, options);
    return counts;
  });
}

}  // namespace raysheaf
