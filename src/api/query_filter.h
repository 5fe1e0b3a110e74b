// Converts the options that select hits into a filter for the engines.
#pragma once

#include <vector>

#include "api/scene/scene_impl.h"
#include "base/buffer.h"
#include "intersect/hit_filter.h"
#include "raysheaf/query.h"

namespace raysheaf {

/// Whether rays or points are in worlds.
[[nodiscard]] inline bool has_worlds(const QueryOptions& options) {
  return !options.ray_worlds.empty() || options.rays_per_world != 0;
}

[[nodiscard]] inline ItemWorlds worlds_of(const QueryOptions& options) {
  return {options.ray_worlds.empty() ? nullptr : options.ray_worlds.data(), options.rays_per_world};
}

/// Whether the options let only some hits count.
[[nodiscard]] inline bool chooses_hits(const QueryOptions& options) {
  return options.sides != Sides::kBoth || !options.ray_masks.empty() || !options.skip.empty() ||
         has_worlds(options);
}

/// Throws `Error`: kInvalidArgument for spans of another length than `count`, worlds given twice or
/// of unequal numbers, and sides that there are not. `items`: "rays" or "points".
void check_choice_of_hits(const QueryOptions& options, std::size_t count, const char* items);

/// The filter where triangles are named by their instances. The options' spans must outlive it.
[[nodiscard]] HitChoice choice_of_hits(const QueryOptions& options);

/// The filter where triangles are named by their numbers in a view.
class QueryFilter {
 public:
  /// Of `view`, which stays as it is, and of options that `chooses_hits` says yes to.
  QueryFilter(const Executor& executor, const SceneAccess::State& state, const SceneView& view,
              const QueryOptions& options);
  QueryFilter(const QueryFilter&) = delete;
  QueryFilter& operator=(const QueryFilter&) = delete;

  [[nodiscard]] const HitFilter* get() const { return &filter_; }

 private:
  void find_skipped(const Executor& executor, std::span<const TriangleId> ids);

  std::vector<FilteredRun> runs_;
  Buffer<std::uint32_t> skips_;
  HitFilter filter_;
};

}  // namespace raysheaf
