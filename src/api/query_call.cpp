#include "api/query_call.h"

#include <array>
#include <cstring>
#include <string>
#include <utility>

#include "ranks/share.h"

namespace raysheaf {
namespace {

const SceneQueries& who_answers(const Context& context, const QueryOptions& options) {
  if (answering_device(context, options) != nullptr) return on_device();
  return options.method == QueryMethod::kBrute ? by_brute_force() : by_plan();
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

}  // namespace

const DeviceBackend* answering_device(const Context& context, const QueryOptions& options) {
  return is_for_cpu(options) ? nullptr : ContextAccess::backend(context);
}

QueryCall::QueryCall(SceneAccess::State& state, std::size_t items, const QueryOptions& options)
    : watch_(options.statistics != nullptr),
      state_(state),
      reading_(state.gate),
      items_(items),
      options_(options),
      executor_(options.stop != nullptr ? state.executor().alone().until(*options.stop)
                                        : state.executor().alone()),
      queries_(who_answers(state.context, options)) {
  state.require_committed();
  executor_.check();
  if (items != 0) view_ = state.views.view_for(state.runs, options.mask);
}

bool QueryCall::make_ready(const RaySource& rays) {
  if (view_ == nullptr || options_.statistics != nullptr || chooses_hits(options_) ||
      is_for_cpu(options_) || &queries_ != &by_plan() || !are_few(rays))
    return false;
  // A thread that changes the view may wait for this one, so this one does not wait for it.
  std::shared_lock share(view_->mutex, std::try_to_lock);
  if (!share || !view_->is_current(state_.runs) || !view_->engine.is_ready_for(items_))
    return false;
  share_ = std::move(share);
  return true;
}

bool QueryCall::is_on_device(const void* data, const char* name) const {
  return data != nullptr && backend() != nullptr && backend()->is_device_memory(data, name);
}

const Entered& QueryCall::enter(const LevelWork& asked, bool in_time) {
  if (is_ready()) return entered_;
  SceneView& all = *state_.views.everything();
  std::unique_lock lock(all.mutex);
  entered_ = state_.levels.for_query(executor_, state_.runs, all, asked, worlds_of(options_),
                                     in_time, report());
  if (entered_.levels != nullptr) entered_lock_ = std::move(lock);
  return entered_;
}

DeviceQueries* QueryCall::enter_on_device() {
  SceneView& all = *state_.views.everything();
  std::unique_lock lock(all.mutex);
  DeviceQueries& engine = all.device_engine(*backend());
  if (!state_.levels.on_device(state_.executor().alone(), state_.runs, all, items_, &engine,
                               report()))
    return nullptr;
  entered_lock_ = std::move(lock);
  return &engine;
}

SceneView& QueryCall::open() {
  if (is_ready()) return *view_;
  if (!state_.runs.placed.fits())
    throw Error(ErrorCode::kUnsupported,
                counted_triangles(state_.runs) + ", which only the CPU answers", "scene");
  const bool is_locked = entered_lock_ && view_.get() == state_.views.everything().get();
  if (!is_locked) lock_ = std::unique_lock(view_->mutex);
  {
    const std::lock_guard placing(state_.runs.placing);
    state_.runs.placed.place_waiting(executor_, entered_.part);
    view_->refresh(state_.runs, entered_.part);
  }
  // Rays in a world enter all instances that are in one.
  const bool by_world = entered_.part.empty();
  if (chooses_hits(options_, by_world)) {
    HitChoice choice = choice_of_hits(options_);
    if (!by_world) choice.worlds = {};
    filter_ = view_->filter(state_.runs, choice, &filtered_);
  }
  return *view_;
}

bool QueryCall::is_closed(InsideRule rule, NearestScene* levels) {
  if (filter_) {
    report_.plan.emplace_back(
        "inside: each point sees its world's part of the surface, which may "
        "be open, so six rays a point vote");
    return false;
  }
  const Stopwatch watch;
  bool suits = true;
  if (levels != nullptr) {
    const View<const LevelInstance> instances = levels->levels->instances;
    levels->meshes = state_.views.everything()->points.closedness(
        executor_, state_.runs.placed.instances(), state_.runs.version());
    for (std::size_t i = 0; i < instances.size; ++i)
      suits = suits && ((instances[i].mask & levels->mask) == 0 || levels->meshes[i].suits(rule));
  } else {
    suits = view_->points.closedness(executor_, view_->source(), view_->version()).suits(rule);
  }
  report_.hierarchy_ms += watch.ms();
  report_.plan.emplace_back(suits ? "inside: the surface is closed, so one ray a point tells"
                                  : "inside: the surface is open, so six rays a point vote");
  return suits;
}

DeviceQueries& QueryCall::device_queries() {
  return view_->device_queries(state_.executor().alone(), *backend());
}

DeviceQuery QueryCall::device_query() {
  DeviceQuery query;
  query.brute = options_.method == QueryMethod::kBrute;
  query.check = options_.check;
  query.count = options_.count_tests;
  query.stream = options_.stream;
  query.results_stream = options_.results_stream;
  query.report = report();
  query.executor = &executor_;
  return query;
}

void QueryCall::finish() {
  if (options_.statistics == nullptr) return;
  QueryStatistics& out = *options_.statistics;
  out = {};
  out.rays = items_;
  out.triangles = visible_triangles(state_.runs, options_.mask);
  out.bound_tests = report_.bound_tests;
  out.ray_bound_tests = report_.ray_bound_tests;
  out.triangle_tests = report_.triangle_tests;
  out.update_ms = state_.update_ms;
  out.check_ms = report_.take_ms;
  out.order_ms = report_.order_ms;
  out.hierarchy_ms = report_.hierarchy_ms;
  out.trace_ms = report_.trace_ms;
  out.plan = std::move(report_.plan);
  out.total_ms = watch_.lap_ms();
}

void check_length(std::size_t answers, const char* name, std::size_t items, const char* items_name,
                  std::size_t per_item) {
  if (answers == items * per_item) return;
  std::string sentence =
      std::to_string(answers) + " results for " + std::to_string(items) + " " + items_name;
  if (per_item != 1) sentence += " with " + std::to_string(per_item) + " each";
  throw Error(ErrorCode::kInvalidArgument, sentence, name);
}

void check_place(const Context& context, const QueryOptions& options, const void* data,
                 const char* name) {
  const DeviceBackend* const backend = ContextAccess::backend(context);
  if (backend == nullptr || !is_for_cpu(options) || !backend->is_device_memory(data, name)) return;
  throw Error(ErrorCode::kUnsupported,
              "they are in the device's memory, but worlds and times are answered by the CPU: copy "
              "them to the host's memory",
              name);
}

bool run_in_pieces(SceneAccess::State& state, const QueryRays& rays, const QueryOptions& options,
                   std::span<std::byte> answers, const char* name,
                   const std::function<void(const QueryRays& rays, const QueryOptions& options,
                                            std::size_t begin, std::size_t end)>& one) {
  Communicator* const ranks = ContextAccess::ranks(state.context);
  const DeviceBackend* const backend = ContextAccess::backend(state.context);
  const auto is_there = [backend](const void* data, const char* what) {
    return backend != nullptr && backend->is_device_memory(data, what);
  };
  const Pieces pieces = pieces_of(rays.size(), ranks != nullptr ? ranks->size() : 1);
  if (ranks == nullptr || ranks->size() == 1 || pieces.number() <= 1 ||
      is_there(rays.data(), "rays") || is_there(answers.data(), name))
    return false;
  const SceneGate::Reading reading(state.gate);  // covers all pieces and their statistics
  Stopwatch watch;
  QueryStatistics sum, piece;
  sum.rays = rays.size();
  Buffer<Ray> room;
  const View<const Ray> all = take_all(state.executor(), rays, &room);
  sum.check_ms = watch.lap_ms();
  QueryOptions of_piece = options;
  of_piece.rays_per_world = 0;  // pieces may begin within a world
  std::vector<WorldId> worlds;
  if (options.statistics != nullptr) of_piece.statistics = &piece;
  std::memset(answers.data(), 0, answers.size());
  share_out(*ranks, pieces, [&](std::size_t begin, std::size_t end) {
    if (!options.ray_masks.empty())
      of_piece.ray_masks = options.ray_masks.subspan(begin, end - begin);
    if (!options.skip.empty()) of_piece.skip = options.skip.subspan(begin, end - begin);
    if (!options.ray_times.empty())
      of_piece.ray_times = options.ray_times.subspan(begin, end - begin);
    if (has_worlds(options)) {
      worlds.clear();
      for (std::size_t i = begin; i < end; ++i) worlds.push_back(worlds_of(options)[i]);
      of_piece.ray_worlds = worlds;
    }
    one(QueryRays(std::span(all.data + begin, end - begin), false), of_piece, begin, end);
    add_counts(piece, &sum);
  });
  unite(*ranks, answers);
  std::array<std::uint64_t, 3> counts{sum.bound_tests, sum.ray_bound_tests, sum.triangle_tests};
  add(*ranks, counts);
  sum.bound_tests = counts[0];
  sum.ray_bound_tests = counts[1];
  sum.triangle_tests = counts[2];
  sum.total_ms = sum.check_ms + watch.lap_ms();
  if (options.statistics == nullptr) return true;
  // Also if other processes took every piece.
  sum.triangles = visible_triangles(state.runs, options.mask);
  sum.update_ms = state.update_ms;
  *options.statistics = std::move(sum);
  return true;
}

}  // namespace raysheaf
