// The walk of the points of a tile, as SIMD.
#pragma once

#include <vector>

#include "nearest/nearest.h"

namespace raysheaf {

/// A child that waits: the least squared distance of each point to its box, and what `BvhNode` says
/// of it.
struct alignas(64) NearestStop {
  float near[16];
  std::uint32_t first, count;
};

struct NearestTask {
  const NearestScene* scene;
  std::uint32_t begin;  ///< the number of points[0] among all
  const QueryPoint* points;
  const std::uint64_t* order;  ///< as nearest/tile_order.h has it
  std::uint32_t count;
  std::uint32_t k;
  double slack;          ///< far more than the error of any distance to a triangle that is met
  FoundTriangle* found;  ///< k a point, by its number
  std::vector<NearestStop>* stack;  ///< not empty
  const Executor* executor;         ///< is checked before every 16 points
};

void find_nearest_in_order(const NearestTask& task);

}  // namespace raysheaf
