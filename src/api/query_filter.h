// The options that let only some hits count.
#pragma once

#include <cstddef>
#include <span>

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

/// Whether the CPU answers, whatever the context's device.
[[nodiscard]] inline bool is_for_cpu(const QueryOptions& options) {
  return has_worlds(options) || !options.ray_times.empty();
}

/// Throws `Error`: kInvalidArgument for spans of another length than `count`, worlds given twice or
/// of unequal numbers, and sides that there are not; kInvalidData for times outside [0, 1].
/// `items`: "rays" or "points".
void check_choice_of_hits(const QueryOptions& options, std::size_t count, const char* items);

/// Throws `Error` (kInvalidData) naming the first time that is not from 0 to 1.
void check_times(std::span<const float> times, const char* name);

/// The options' spans must outlive it.
[[nodiscard]] HitChoice choice_of_hits(const QueryOptions& options);

/// Whether the options let only some hits count, among those that the mask shows; unless
/// `by_world`, of what is in all worlds.
[[nodiscard]] inline bool chooses_hits(const QueryOptions& options, bool by_world = true) {
  return options.sides != Sides::kBoth || !options.ray_masks.empty() || !options.skip.empty() ||
         (by_world && has_worlds(options));
}

}  // namespace raysheaf
