#include "scene/placed_runs.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/vec.h"
#include "exec/executor.h"
#include "exec/for_each_part.h"
#include "scene/transform_points.h"

namespace raysheaf {
namespace {

bool is_within(Vec3 p) {
  const Vec3 size = abs(p);
  return size.x <= kLargestCoordinate && size.y <= kLargestCoordinate &&
         size.z <= kLargestCoordinate;
}

/// Whether every corner of its triangles is within the world. Other vertices may be anywhere.
bool is_within(const TriangleRun& run) {
  for (std::uint32_t i = 0; i < run.count; ++i)
    for (const Vec3 corner : run.corners(i))
      if (!is_within(corner)) return false;
  return true;
}

}  // namespace

void PlacedRuns::list(std::vector<PlacedInstance> instances) {
  const auto order = [](const PlacedInstance& a) { return std::tie(a.geom_id, a.inst_id); };
  std::vector<Buffer<Vec3>> world(instances.size());
  std::vector<std::uint8_t> waits(instances.size());
  std::size_t before = 0;
  std::vector<TriangleRun> runs;
  runs.reserve(instances.size());
  triangle_count_ = 0;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    while (before < instances_.size() && order(instances_[before]) < order(instances[i])) ++before;
    if (before < instances_.size() && order(instances_[before]) == order(instances[i])) {
      world[i] = std::move(world_[before]);
      waits[i] = waits_[before];
    }
    runs.push_back({nullptr, nullptr, static_cast<std::uint32_t>(triangle_count_),
                    instances[i].triangle_count});
    triangle_count_ += instances[i].triangle_count;
  }
  instances_ = std::move(instances);
  runs_ = std::move(runs);
  world_ = std::move(world);
  waits_ = std::move(waits);
  waiting_ = 0;
  for (std::size_t i = 0; i < waits_.size(); ++i)
    if (waits_[i] != 0) waiting_ += instances_[i].triangle_count;
  for (std::size_t i = 0; i < runs_.size(); ++i) settle(i);
}

void PlacedRuns::let_wait(std::uint32_t number) {
  const PlacedInstance& instance = instances_[number];
  const std::uint8_t waits = instance.is_identity() ? 0 : 1;
  if (std::exchange(waits_[number], waits) == waits) return;
  if (waits != 0)
    waiting_ += instance.triangle_count;
  else
    waiting_ -= instance.triangle_count;
}

void PlacedRuns::place_waiting(const Executor& executor, View<const std::uint8_t> entered) {
  if (waiting_ == 0) return;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < waits_.size(); ++i)
    if (waits_[i] != 0 && (entered.empty() || entered[i] == 0)) numbers.push_back(i);
  static_cast<void>(place(executor, View<const std::uint32_t>(numbers)));
}

std::uint32_t PlacedRuns::place(const Executor& executor, View<const std::uint32_t> numbers) {
  std::vector<std::uint32_t> moved;
  std::vector<std::size_t> sizes;
  for (const std::uint32_t number : numbers) {
    const PlacedInstance& instance = instances_[number];
    if (instance.is_identity()) continue;
    world_[number].resize_uninitialized(instance.positions.size);
    point(number);
    moved.push_back(number);
    sizes.push_back(instance.positions.size);
  }
  std::vector<std::uint8_t> is_doubtful(moved.size());
  for_each_part(executor, sizes, [&](std::size_t i, std::size_t begin, std::size_t end) {
    const PlacedInstance& instance = instances_[moved[i]];
    if (transform_points(instance.to_world, instance.positions.data + begin, end - begin,
                         world_[moved[i]].data() + begin))
      return;
    std::atomic_ref(is_doubtful[i]).store(1, std::memory_order_relaxed);
  });
  for (const std::uint32_t number : numbers)
    if (std::exchange(waits_[number], 0) != 0) waiting_ -= instances_[number].triangle_count;
  std::uint32_t refused = kInvalidId;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const std::uint32_t id = instances_[moved[i]].inst_id;
    if (is_doubtful[i] != 0 && id < refused && !is_within(runs_[moved[i]])) refused = id;
  }
  return refused;
}

std::size_t PlacedRuns::memory_bytes() const {
  std::size_t bytes = instances_.capacity() * sizeof(PlacedInstance) +
                      runs_.capacity() * sizeof(TriangleRun) +
                      world_.capacity() * sizeof(Buffer<Vec3>);
  for (const Buffer<Vec3>& vertices : world_) bytes += vertices.capacity_bytes();
  return bytes;
}

std::vector<Box> boxes_of(const Executor& executor, View<const TriangleRun> runs) {
  std::vector<std::size_t> sizes(runs.size);
  for (std::size_t i = 0; i < runs.size; ++i) sizes[i] = runs[i].count;
  std::vector<Box> boxes(runs.size);
  std::mutex mutex;
  for_each_part(executor, sizes, [&](std::size_t i, std::size_t begin, std::size_t end) {
    Box box;
    for (std::size_t t = begin; t < end; ++t) {
      for (const Vec3 corner : runs[i].corners(static_cast<std::uint32_t>(t))) {
        box.min = min(box.min, corner);
        box.max = max(box.max, corner);
      }
    }
    const std::lock_guard lock(mutex);
    boxes[i].min = min(boxes[i].min, box.min);
    boxes[i].max = max(boxes[i].max, box.max);
  });
  // Adding 0 turns -0 into +0. Which of the two a box gets would depend on the order of the tasks.
  for (Box& box : boxes) {
    box.min += {0, 0, 0};
    box.max += {0, 0, 0};
  }
  return boxes;
}

}  // namespace raysheaf
