#include "api/query_filter.h"

#include <string>
#include <unordered_map>

namespace raysheaf {
namespace {

void check_choice_length(std::size_t rays, std::size_t size, const char* name) {
  if (size != 0 && size != rays)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(size) + " are given for " + std::to_string(rays) + " rays", name);
}

}  // namespace

void check_choice_of_hits(const QueryOptions& options, std::size_t rays) {
  if (static_cast<int>(options.sides) > static_cast<int>(Sides::kBack))
    throw Error(ErrorCode::kInvalidArgument,
                "there is no value " + std::to_string(static_cast<int>(options.sides)), "sides");
  check_choice_length(rays, options.ray_masks.size(), "ray_masks");
  check_choice_length(rays, options.skip.size(), "skip");
}

HitChoice choice_of_hits(const QueryOptions& options) {
  HitChoice choice;
  choice.mask = options.mask;
  choice.sides = options.sides;
  if (!options.ray_masks.empty()) choice.masks = options.ray_masks.data();
  if (!options.skip.empty()) choice.skips = options.skip.data();
  return choice;
}

QueryFilter::QueryFilter(const Executor& executor, const SceneAccess::State& state,
                         const SceneView& view, const QueryOptions& options)
    : filter_(view.filter(state.runs, &runs_)) {
  filter_.sides = options.sides;
  // A mask of a ray and that of the query have to see an instance by the same bit.
  for (FilteredRun& run : runs_) run.mask &= options.mask;
  if (!options.ray_masks.empty()) filter_.masks = options.ray_masks.data();
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
