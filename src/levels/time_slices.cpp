#include "levels/time_slices.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "exec/radix_sort.h"

namespace raysheaf {
namespace {

/// The box of an instance, and its part of a tree, take some 600 ns.
constexpr std::size_t kRaysAnInstance = 64;

std::vector<std::uint32_t> order_by_time(const Executor& executor, View<const float> times) {
  if (std::is_sorted(times.begin(), times.end())) return {};
  std::vector<std::uint32_t> keys(times.size), order(times.size);
  // Bits of numbers that are not negative are in the order of the numbers; -0 becomes 0.
  std::transform(times.begin(), times.end(), keys.begin(),
                 [](float time) { return std::bit_cast<std::uint32_t>(time + 0.0f); });
  std::iota(order.begin(), order.end(), 0u);
  radix_sort_pairs(executor, keys, order);
  return order;
}

}  // namespace

TimeSlices slice_by_time(const Executor& executor, const LevelScene& scene, std::size_t rays,
                         std::size_t grain) {
  TimeSlices slices;
  const std::size_t instances = scene.instances.size;
  slices.rays_each = (kRaysAnInstance * instances + grain - 1) / grain * grain;
  if (rays <= slices.rays_each) return slices;
  slices.order = order_by_time(executor, {scene.times, rays});
  const auto time_at = [&](std::size_t place) {
    return scene.times[slices.order.empty() ? place : slices.order[place]];
  };
  slices.tops.resize((rays + slices.rays_each - 1) / slices.rays_each);
  executor.for_each(slices.tops.size(), 1, [&](std::size_t s) {
    const std::size_t first = s * slices.rays_each;
    const std::size_t last = std::min(rays, first + slices.rays_each) - 1;
    std::vector<Box> boxes(instances);
    for (std::size_t i = 0; i < instances; ++i)
      boxes[i] = world_box(scene.instances[i], fit_for(instances), scene.motions[i], time_at(first),
                           time_at(last));
    build_top_tree(Executor::serial(), View<const Box>(boxes), &slices.tops[s]);
    slices.tops[s].scratch = {};
  });
  return slices;
}

}  // namespace raysheaf
