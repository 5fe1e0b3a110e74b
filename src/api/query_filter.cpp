#include "api/query_filter.h"

#include <string>
#include <unordered_map>

namespace raysheaf {
namespace {

void check_choice_length(std::size_t count, const char* items, std::size_t size,
                         const std::string& name) {
  if (size == 0 || size == count) return;
  throw Error(ErrorCode::kInvalidArgument,
              std::to_string(size) + " are given for " + std::to_string(count) + " " + items, name);
}

void check_worlds(const QueryOptions& options, std::size_t count, const char* items) {
  const std::string all = items, each = all.substr(0, all.size() - 1) + "_worlds";
  const std::string per_world = all + "_per_world";
  check_choice_length(count, items, options.ray_worlds.size(), each);
  const std::size_t number = options.rays_per_world;
  if (number == 0) return;
  if (!options.ray_worlds.empty())
    throw Error(ErrorCode::kInvalidArgument,
                "is given besides " + each + "; one of the two is expected", per_world);
  if (count % number != 0)
    throw Error(
        ErrorCode::kInvalidArgument,
        std::to_string(count) + " " + items + " are not a multiple of " + std::to_string(number),
        per_world);
}

}  // namespace

void check_choice_of_hits(const QueryOptions& options, std::size_t count, const char* items) {
  if (static_cast<int>(options.sides) > static_cast<int>(Sides::kBack))
    throw Error(ErrorCode::kInvalidArgument,
                "there is no value " + std::to_string(static_cast<int>(options.sides)), "sides");
  check_choice_length(count, items, options.ray_masks.size(), "ray_masks");
  check_choice_length(count, items, options.skip.size(), "skip");
  if (has_worlds(options)) check_worlds(options, count, items);
}

HitChoice choice_of_hits(const QueryOptions& options) {
  HitChoice choice;
  choice.mask = options.mask;
  choice.sides = options.sides;
  if (!options.ray_masks.empty()) choice.masks = options.ray_masks.data();
  if (!options.skip.empty()) choice.skips = options.skip.data();
  choice.worlds = worlds_of(options);
  return choice;
}

QueryFilter::QueryFilter(const Executor& executor, const SceneAccess::State& state,
                         const SceneView& view, const QueryOptions& options)
    : filter_(view.filter(state.runs, &runs_)) {
  filter_.sides = options.sides;
  // A mask of a ray and that of the query have to see an instance by the same bit.
  for (FilteredRun& run : runs_) run.mask &= options.mask;
  if (!options.ray_masks.empty()) filter_.masks = options.ray_masks.data();
  filter_.worlds = worlds_of(options);
  if (!options.skip.empty()) find_skipped(executor, options.skip);
}

/// By numbers of the view: rays do not meet the triangles that it does not show.
void QueryFilter::find_skipped(const Executor& executor, std::span<const TriangleId> ids) {
  std::unordered_map<InstanceId, FilteredRun> runs;
  runs.reserve(runs_.size());
  for (const FilteredRun& run : runs_) runs.emplace(run.inst_id, run);
  skips_.resize_uninitialized(ids.size());
  filter_.skips = skips_.data();
  executor.for_each_block(ids.size(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
    InstanceId instance = kInvalidId;  // mostly that of the ray before
    FilteredRun run;
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleId id = ids[i];
      if (id.inst_id != instance) {
        const auto found = runs.find(id.inst_id);
        instance = id.inst_id;
        run = found != runs.end() ? found->second : FilteredRun{};
      }
      skips_[i] = id.prim_id < run.count ? run.first + id.prim_id : kInvalidId;
    }
  });
}

}  // namespace raysheaf
