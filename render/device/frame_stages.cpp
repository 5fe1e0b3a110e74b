#include "render/device/frame_stages.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace raysheaf {

namespace {

constexpr std::uint64_t BatchStatistics::*kBatchCounts[] = {
    &BatchStatistics::chunks, &BatchStatistics::mesh_sphere_tests, &BatchStatistics::bound_tests,
    &BatchStatistics::ray_bound_tests, &BatchStatistics::final_tests};

/// More levels than any hierarchy has.
constexpr std::uint32_t kMostLevels = 64;

}  // namespace

std::size_t FrameTally::place_of(RayKind kind, std::uint32_t bounce) const {
  const auto& batches = statistics.batches;
  const auto found = std::find_if(batches.begin(), batches.end(), [&](const BatchStatistics& b) {
    return std::pair(b.bounce, b.kind) >= std::pair(bounce, kind);
  });
  return static_cast<std::size_t>(found - batches.begin());
}

BatchStatistics& FrameTally::batch(RayKind kind, std::uint32_t bounce) {
  auto& batches = statistics.batches;
  const std::size_t place = place_of(kind, bounce);
  if (place < batches.size() && batches[place].kind == kind && batches[place].bounce == bounce)
    return batches[place];
  BatchStatistics batch;
  batch.kind = kind;
  batch.bounce = bounce;
  batch.triangles = triangles_;
  const auto at = static_cast<std::ptrdiff_t>(place);
  kept_plans_.insert(kept_plans_.begin() + at, KeptPlan{});
  return *batches.insert(batches.begin() + at, std::move(batch));
}

void FrameTally::keep_plans(std::size_t group) {
  for (std::size_t i = 0; i < kept_plans_.size(); ++i) {
    std::vector<std::string>& plan = statistics.batches[i].plan;
    KeptPlan& kept = kept_plans_[i];
    if (plan.size() == kept.sentences) continue;
    if (group < kept.group) {
      plan.erase(plan.begin(), plan.begin() + static_cast<std::ptrdiff_t>(kept.sentences));
      kept = {plan.size(), group};
    } else {
      plan.resize(kept.sentences);
    }
  }
}

bool FrameTally::wants_plan(RayKind kind, std::uint32_t bounce, std::size_t group) const {
  const auto& batches = statistics.batches;
  const std::size_t place = place_of(kind, bounce);
  const bool known =
      place < batches.size() && batches[place].kind == kind && batches[place].bounce == bounce;
  return !known || group < kept_plans_[place].group;
}

void FrameTally::take(FrameTally* other, double time_part) {
  FrameStatistics& from = other->statistics;
  statistics.raster_ms += time_part * from.raster_ms;
  statistics.shade_ms += time_part * from.shade_ms;
  for (std::size_t i = 0; i < from.batches.size(); ++i) {
    BatchStatistics& more = from.batches[i];
    BatchStatistics& sum = batch(more.kind, more.bounce);
    sum.rays += more.rays;
    sum.hits += more.hits;
    std::vector<std::uint64_t> numbers = numbers_of(sum);
    const std::vector<std::uint64_t> added = numbers_of(more);
    for (std::size_t n = 0; n < numbers.size(); ++n) numbers[n] += added[n];
    set_numbers(numbers.data(), &sum);
    sum.times_ms.add(more.times_ms, time_part);
    KeptPlan& kept = kept_plans_[place_of(more.kind, more.bounce)];
    if (other->kept_plans_[i].group >= kept.group) continue;
    kept = other->kept_plans_[i];
    sum.plan = std::move(more.plan);
  }
  from = {};
  other->kept_plans_.clear();
}

void FrameTally::tell_first(std::string sentence) {
  if (statistics.batches.empty()) return;
  std::vector<std::string>& plan = statistics.batches.front().plan;
  plan.insert(plan.begin(), std::move(sentence));
  ++kept_plans_.front().sentences;
}

std::vector<std::uint64_t> numbers_of(const BatchStatistics& batch) {
  std::vector<std::uint64_t> numbers;
  numbers.reserve(number_count());
  for (const auto field : kBatchCounts) numbers.push_back(batch.*field);
  const std::size_t first = numbers.size();
  numbers.resize(number_count());
  for (const LevelStatistics& level : batch.levels) {
    const std::size_t place = first + 2 * std::size_t{(level.level - 1) % kMostLevels};
    numbers[place] += level.tests;
    numbers[place + 1] += level.hits;
  }
  return numbers;
}

void set_numbers(const std::uint64_t* numbers, BatchStatistics* batch) {
  for (const auto field : kBatchCounts) batch->*field = *numbers++;
  batch->levels.clear();
  for (std::uint32_t l = kMostLevels; l >= 1; --l) {
    const LevelStatistics level{l, numbers[2 * (l - 1)], numbers[2 * (l - 1) + 1]};
    if (level.tests > 0 || !batch->levels.empty()) batch->levels.push_back(level);
  }
}

std::size_t number_count() {
  return std::size(kBatchCounts) + 2 * kMostLevels;
}

PixelIds ids_of(const FlatScene& scene, TriangleAt triangle) {
  const FlatMesh& mesh = scene.meshes[triangle.mesh];
  return {mesh.inst_id, mesh.geom_id, triangle.prim};
}

void add_engine_report(const QueryReport& report, std::size_t part, BatchStatistics* statistics) {
  statistics->bound_tests += report.bound_tests;
  statistics->ray_bound_tests += report.ray_bound_tests;
  statistics->final_tests += report.triangle_tests;
  statistics->times_ms.order += report.order_ms;
  statistics->times_ms.hierarchy += report.hierarchy_ms;
  statistics->times_ms.traverse += report.trace_ms;
  const std::string of = part == 0 ? "" : "[" + std::to_string(part) + " rays] ";
  for (const std::string& sentence : report.plan) statistics->plan.push_back(of + sentence);
}

}  // namespace raysheaf
