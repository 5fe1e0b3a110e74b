#include "scene/placed_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <tuple>
#include <vector>

#include "scene/placing.h"

namespace raysheaf {
namespace {

/// How far a box reaches to a side: to the lower one of axis `side`, or to the upper of `side` - 3.
float reach(const Box& box, int side) {
  return side < 3 ? -component(box.min, side) : component(box.max, side - 3);
}

void join(const Box& other, Box* box) {
  box->min = min(box->min, other.min);
  box->max = max(box->max, other.max);
}

/// With another number for NaN, which sums may be that cancel at corners.
Vec3 known(Vec3 p, float other) {
  const auto one = [other](float x) { return std::isnan(x) ? other : x; };
  return {one(p.x), one(p.y), one(p.z)};
}

/// The box of the corners of an instance, exactly.
Box corner_box(const Executor& executor, const InstanceCorners& corners) {
  std::mutex mutex;
  Box box;
  executor.for_each_block(corners.count(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
    Box some;
    for (std::size_t i = begin; i < end; ++i)
      for (const Vec3 corner : corners(static_cast<std::uint32_t>(i)))
        join({corner, corner}, &some);
    const std::lock_guard lock(mutex);
    join(some, &box);
  });
  return box;
}

/// Boxes that contain the corners of the instances.
std::vector<Box> outer_boxes(const Executor& executor, View<const PlacedInstance> instances) {
  std::vector<Box> boxes(instances.size);
  for (std::size_t begin = 0, end = 0; begin < instances.size; begin = end) {
    PlacedInstance mesh = instances[begin];
    while (end < instances.size && instances[end].geom_id == mesh.geom_id) ++end;
    mesh.to_world = Affine();
    const Box box = corner_box(executor, InstanceCorners(mesh));
    executor.for_each(end - begin, kWorkGrain, [&](std::size_t i) {
      constexpr float kFar = std::numeric_limits<float>::infinity();
      const Box outer = placed_box(make_placing(instances[begin + i].to_world, box), box);
      boxes[begin + i] = {known(outer.min, -kFar), known(outer.max, kFar)};
    });
  }
  return boxes;
}

}  // namespace

Box placed_bounds(const Executor& executor, View<const PlacedInstance> instances) {
  const std::vector<Box> outer = outer_boxes(executor, instances);
  Box box;
  for (int side = 0; side < 6; ++side) {
    const auto row = [&](std::uint32_t i) { return instances[i].to_world.m[side % 3]; };
    std::vector<std::uint32_t> far;
    for (std::uint32_t i = 0; i < outer.size(); ++i)
      if (reach(outer[i], side) > reach(box, side)) far.push_back(i);
    std::sort(far.begin(), far.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple(-reach(outer[a], side), instances[a].geom_id, row(a)) <
             std::tuple(-reach(outer[b], side), instances[b].geom_id, row(b));
    });
    for (std::size_t k = 0; k < far.size(); ++k) {
      const std::uint32_t i = far[k];
      if (!(reach(outer[i], side) > reach(box, side))) break;
      if (k != 0 && instances[i].geom_id == instances[far[k - 1]].geom_id &&
          row(i) == row(far[k - 1]))
        continue;
      join(corner_box(executor, InstanceCorners(instances[i])), &box);
    }
  }
  // Adding 0 turns -0 into +0.
  box.min += {0, 0, 0};
  box.max += {0, 0, 0};
  return box;
}

}  // namespace raysheaf
