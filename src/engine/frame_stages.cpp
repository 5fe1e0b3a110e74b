#include "engine/frame_stages.h"

#include <algorithm>
#include <utility>

namespace raysheaf {

BatchStatistics& FrameTally::batch(RayKind kind, std::uint32_t bounce) {
  auto& batches = statistics.batches;
  const auto found = std::find_if(batches.begin(), batches.end(), [&](const BatchStatistics& b) {
    return b.kind == kind && b.bounce == bounce;
  });
  if (found != batches.end()) return *found;
  BatchStatistics batch;
  batch.kind = kind;
  batch.bounce = bounce;
  batch.triangles = triangles_;
  const auto later = std::find_if(batches.begin(), batches.end(), [&](const BatchStatistics& b) {
    return std::pair(b.bounce, b.kind) > std::pair(bounce, kind);
  });
  kept_plans_.insert(kept_plans_.begin() + (later - batches.begin()), 0);
  return *batches.insert(later, std::move(batch));
}

void FrameTally::keep_first_plans() {
  for (std::size_t i = 0; i < kept_plans_.size(); ++i) {
    std::vector<std::string>& plan = statistics.batches[i].plan;
    if (kept_plans_[i] > 0) plan.resize(kept_plans_[i]);
    kept_plans_[i] = plan.size();
  }
}

PixelIds ids_of(const FlatScene& scene, std::uint32_t triangle) {
  if (triangle == kInvalidId) return {};
  const FlatMesh& mesh = scene.meshes[scene.mesh_of_triangle[triangle]];
  return {mesh.inst_id, mesh.geom_id, triangle - mesh.first_triangle};
}

void add_device_report(EngineReport report, BatchStatistics* statistics) {
  statistics->bound_tests += report.bound_tests;
  statistics->ray_bound_tests += report.ray_bound_tests;
  statistics->final_tests += report.triangle_tests;
  statistics->times_ms.order += report.order_ms;
  statistics->times_ms.hierarchy += report.hierarchy_ms;
  statistics->times_ms.traverse += report.trace_ms;
  for (std::string& sentence : report.plan) statistics->plan.push_back(std::move(sentence));
}

namespace {

/// Adds what each level did; the deepest is named first.
void add_levels(const std::vector<std::uint64_t>& tests, const std::vector<std::uint64_t>& hits,
                BatchStatistics* statistics) {
  const auto levels = static_cast<std::uint32_t>(tests.size());
  statistics->levels.resize(std::max<std::size_t>(levels, statistics->levels.size()));
  for (std::uint32_t l = 1; l <= levels; ++l) {
    LevelStatistics& level = statistics->levels[levels - l];
    level.level = l;
    level.tests += tests[l - 1];
    level.hits += hits[l - 1];
  }
}

}  // namespace

void add_counts(const TraverseCounts& counts, BatchStatistics* statistics) {
  add_levels(counts.tests, counts.hits, statistics);
  statistics->mesh_sphere_tests += counts.mesh_sphere_tests;
  statistics->final_tests += counts.final_tests;
}

void add_counts(const PacketCounts& counts, BatchStatistics* statistics) {
  add_levels(counts.tests, counts.hits, statistics);
  statistics->final_tests += counts.final_tests;
}

}  // namespace raysheaf
