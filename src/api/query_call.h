// One call of a query of rays or points: the scene as committed, the view that the mask shows, the
// way in which it is answered, and the statistics.
//
//   closest_hit, nearest, ... ─► run_query ─► QueryCall ─► SceneQueries
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <type_traits>
#include <vector>

#include "api/query_batch.h"
#include "api/query_filter.h"
#include "api/scene/scene_impl.h"
#include "api/scene_queries.h"
#include "device/device_queries.h"
#include "exec/stopwatch.h"
#include "raysheaf/query.h"

namespace raysheaf {

/// Where the answers of a query go.
template <class T>
struct Answers {
  std::span<T> all;
  const char* name = "";     ///< in errors
  T nothing = {};            ///< where no triangle can be found
  std::size_t per_item = 1;  ///< for each ray or point
  /// Each is the closest or any hit of its ray: processes that share the scene's context compute
  /// some each and exchange them, and those of few rays are found on the calling thread.
  bool of_single_rays = false;
};

/// Holds the scene as it is until the call ends.
class QueryCall {
 public:
  /// `items`: how many rays or points.
  QueryCall(SceneAccess::State& state, std::size_t items, const QueryOptions& options);

  /// Tries to make the call ready for the closest or any hits of few rays, so that they need none
  /// of the context's threads and can be answered while other threads do the same: nothing of the
  /// scene has changed since a call that was not ready, and only hits are asked for.
  [[nodiscard]] bool make_ready(const RaySource& rays);
  [[nodiscard]] bool is_ready() const { return share_.owns_lock(); }

  /// Whether no triangle can be found: there are no items, or the mask shows no triangles.
  [[nodiscard]] bool is_empty() const { return view_ == nullptr; }
  /// The way in which the query is answered, chosen once.
  [[nodiscard]] const SceneQueries& queries() const { return queries_; }
  [[nodiscard]] const QueryOptions& options() const { return options_; }
  /// Stops when the caller requests it.
  [[nodiscard]] const Executor& executor() const { return executor_; }
  /// Null without statistics.
  [[nodiscard]] QueryReport* report() {
    return options_.statistics != nullptr ? &report_ : nullptr;
  }
  void add_time(double QueryReport::*stage, double ms) { report_.*stage += ms; }

  /// All items, validated, in place or in `room`.
  template <class Item>
  [[nodiscard]] View<const Item> take_all(const Source<Item>& items, Buffer<Item>* room) {
    const Stopwatch watch;
    const View<const Item> all = raysheaf::take_all(executor_, items, room);
    report_.take_ms += watch.ms();
    return all;
  }
  /// Whether an array is in the memory of the scene's device.
  [[nodiscard]] bool is_on_device(const void* data, const char* name) const;

  /// The instances, until the call ends, that the rays or points that `asked` counts had better
  /// enter than have placed, or that are too many to be placed: throws `Error` (kUnsupported) if
  /// they cannot be entered then. The others are in the view: `open` it. `in_time`: the rays have
  /// times.
  const Entered& enter(const LevelWork& asked, bool in_time = false);
  /// The same for rays that the device answers: its engine, or null.
  [[nodiscard]] DeviceQueries* enter_on_device();
  /// Locks the view of what is not entered until the call ends, and applies the scene's changes to
  /// it. Throws `Error` (kUnsupported) if its triangles are too many to be placed.
  SceneView& open();
  /// The instances, whether or not they wait to be placed.
  [[nodiscard]] const SceneRuns& scene() const { return state_.runs; }

  // After `open`.
  [[nodiscard]] const SceneView& view() const { return *view_; }
  /// Selects hits; null: all count.
  [[nodiscard]] const HitFilter* filter() const { return filter_ ? &*filter_ : nullptr; }
  /// Whether all rays from a point agree on what is inside. Adds a sentence to the plan. `levels`:
  /// null, or what points meet after `enter`; its `meshes` are set.
  [[nodiscard]] bool is_closed(InsideRule rule, NearestScene* levels = nullptr);
  [[nodiscard]] DeviceQueries& device_queries();
  [[nodiscard]] DeviceQuery device_query();

  /// Writes `nothing` to all answers. The caller's earlier work must be complete before, and a
  /// device's memory is not written by the host.
  template <class T>
  void clear(const Answers<T>& answers) {
    if (!is_on_device(answers.all.data(), answers.name))
      return std::fill(answers.all.begin(), answers.all.end(), answers.nothing);
    const std::vector<T> cleared(answers.all.size(), answers.nothing);
    backend()->write(answers.all.data(), cleared.data(), answers.all.size_bytes(), device_query());
  }
  /// Writes the statistics.
  void finish();

 private:
  [[nodiscard]] const DeviceBackend* backend() const {
    return ContextAccess::backend(state_.context);
  }

  Stopwatch watch_;  ///< runs for statistics
  SceneAccess::State& state_;
  const SceneGate::Reading reading_;
  const std::size_t items_;
  const QueryOptions& options_;
  const Executor executor_;
  const SceneQueries& queries_;
  std::shared_ptr<SceneView> view_;
  Entered entered_;
  std::unique_lock<std::shared_mutex> entered_lock_;  ///< of the view of all instances
  std::unique_lock<std::shared_mutex> lock_;
  std::shared_lock<std::shared_mutex> share_;
  std::vector<FilteredRun> filtered_;
  std::optional<HitFilter> filter_;
  QueryReport report_;
};

/// The device that answers; null: the CPU.
[[nodiscard]] const DeviceBackend* answering_device(const Context& context,
                                                    const QueryOptions& options);
/// Throws `Error` (kInvalidArgument) unless there are `per_item` answers for each item.
void check_length(std::size_t answers, const char* name, std::size_t items, const char* items_name,
                  std::size_t per_item);
/// Throws `Error` (kUnsupported) for an array in a device's memory if the CPU has to answer.
void check_place(const Context& context, const QueryOptions& options, const void* data,
                 const char* name);

/// Calls `one(rays, options, begin, end)` for this process's pieces of the rays, if processes share
/// the context; false if not. Counts are then those of all, times and the plan this process's. A
/// device's own memory is not shared.
[[nodiscard]] bool run_in_pieces(
    SceneAccess::State& state, const QueryRays& rays, const QueryOptions& options,
    std::span<std::byte> answers, const char* name,
    const std::function<void(const QueryRays& rays, const QueryOptions& options, std::size_t begin,
                             std::size_t end)>& one);

/// Calls `ask(queries, call, batch, answers)`, for example a member of `SceneQueries`, on one of
/// the context's threads, because others of them may wait for the view that the call locks. A call
/// that is ready stays on the calling thread, as does one on a device, because the stream may
/// belong to that thread. If items are invalid, names the first, no matter which one a thread has
/// found.
template <class Batch, class T, class Ask>
void run_query(const Scene& scene, const Batch& batch, const QueryOptions& options,
               const Answers<T>& answers, const Ask& ask) {
  SceneAccess::State& state = SceneAccess::state(scene);
  check_choice_of_hits(options, batch.size(), batch.name());
  check_length(answers.all.size(), answers.name, batch.size(), batch.name(), answers.per_item);
  check_place(state.context, options, answers.all.data(), answers.name);
  check_place(state.context, options, batch.data(), batch.name());
  const auto answer = [&]([[maybe_unused]] bool at_once) {
    QueryCall call(state, batch.size(), options);
    if constexpr (std::is_same_v<Batch, QueryRays>)
      if (at_once && !call.make_ready(batch)) return false;
    if (call.is_empty()) {
      Buffer<typename Batch::Element> room;
      if (!call.is_on_device(batch.data(), batch.name()))
        static_cast<void>(call.take_all(batch, &room));
      call.clear(answers);
    } else {
      std::invoke(ask, call.queries(), call, batch, answers.all);
    }
    call.finish();
    return true;
  };
  within_memory(kNoMemory, batch.name(), [&] {
    try {
      if constexpr (std::is_same_v<Batch, QueryRays>) {
        if (answers.of_single_rays) {
          if (ContextAccess::ranks(state.context) != nullptr &&
              run_in_pieces(state, batch, options, std::as_writable_bytes(answers.all),
                            answers.name,
                            [&](const QueryRays& rays, const QueryOptions& how, std::size_t begin,
                                std::size_t end) {
                              const std::span<T> some = answers.all.subspan(begin, end - begin);
                              run_query(scene, rays, how, Answers<T>{some, answers.name}, ask);
                            }))
            return;
          if (batch.size() <= kFewTogether && answer(true)) return;
        }
      }
      if (answering_device(state.context, options) != nullptr)
        answer(false);
      else
        state.executor().enter([&] { answer(false); });
    } catch (const InvalidItem&) {
      batch.throw_first_fault();
    }
  });
}

/// `count` answers, which `ask(answers)` writes.
template <class T, class Ask>
[[nodiscard]] std::vector<T> make_answers(std::size_t count, const char* items, const Ask& ask) {
  return answered(
      [&] {
        std::vector<T> all(count);
        ask(std::span<T>(all));
        return all;
      },
      items);
}

}  // namespace raysheaf
