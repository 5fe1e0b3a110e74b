// Rays with times in slices of time, each with a tree over the instances where its rays meet them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "levels/level_scene.h"

namespace raysheaf {

/// In one tree for all times, the boxes of what moves far hold much that a ray does not meet.
struct TimeSlices {
  std::vector<std::uint32_t> order;  ///< the numbers of the rays, by time; empty: as they come
  std::size_t rays_each = 0;         ///< so many of them in a row are in a slice
  std::vector<ObjectTree> tops;      ///< of the slices; empty: `LevelScene::top` is for all
};

/// For so many rays, in all worlds; the scene has times. A slice has `grain` rays or a multiple of
/// it, and so many that its tree costs a ray some nanoseconds.
[[nodiscard]] TimeSlices slice_by_time(const Executor& executor, const LevelScene& scene,
                                       std::size_t rays, std::size_t grain);

}  // namespace raysheaf
