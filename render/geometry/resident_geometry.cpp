#include "render/geometry/resident_geometry.h"

#include <algorithm>
#include <utility>

#include "ranks/share.h"
#include "render/frame/frame.h"
#include "render/frame/primary.h"
#include "render/geometry/thread_geometry.h"
#include "render/raster/rasterizer.h"

namespace raysheaf {

ResidentGeometry::ResidentGeometry(const Executor& executor, const FlatScene& scene,
                                   const TextureSet& textures, const RenderOptions& options,
                                   TraceCache* cache, std::uint32_t samples)
    : HasLooks{material_looks(*scene.description), {}},
      FlatGeometry(executor, {scene, textures, looks}, samples > 1, pixels,
                   cache != nullptr ? cache->levels() : nullptr),
      blends_(samples > 1) {
  options_.method = method_settings(options);
  options_.cache = cache != nullptr ? cache : &own_cache_;
  options_.cache->tree = {};
  options_.bundle_samples = options.bundle_samples;
}

std::size_t ResidentGeometry::look(const Seeing& seeing, ProgressMeter* meter) {
  seen_.rays = CameraRays(seeing.frame);
  const PictureSize size{seeing.frame.width, seeing.frame.height};
  seen_.groups = is_shared() ? groups_of(size) : std::vector<PixelGroup>{all_pixels(size)};
  const bool left = seeing.rasterizer == nullptr && is_shared();  // to the threads
  seen_.known.assign(seen_.groups.size(), left ? 0 : 1);
  seen_.pixel_tests = seeing.pixel_tests;
  if (levels_ != nullptr) seen_.met.resize(std::size_t{size.width} * size.height);
  if (seeing.rasterizer != nullptr) {
    meter->begin("raster", 1);
    seen_.triangles = rasterize(seeing);
    if (cutouts_.any()) see_through(seeing, seen_.triangles, meter);
  } else if (left) {
    seen_.triangles.resize(std::size_t{size.width} * size.height);
  } else {
    find_triangles(seeing, meter);
  }
  meter->begin("surfaces", 1);
  return seen_.groups.size();
}

void ResidentGeometry::find_triangles(const Seeing& seeing, ProgressMeter* meter) {
  const RayBatch batch = primary_rays(executor_, scene_.bounds, seeing.frame);
  const std::vector<RayHit> hits = traced(batch, Facing::kSkipBackOfSingleSided,
                                          &seeing.statistics(), seeing.pixel_tests, meter);
  seen_.triangles.clear();
  for (const RayHit& hit : hits) seen_.triangles.push_back(hit.triangle);
}

void ResidentGeometry::see_through(const Seeing& seeing, View<std::uint32_t> triangles,
                                   ProgressMeter* meter) {
  const RayBatch all = primary_rays(executor_, scene_.bounds, seeing.frame);
  const std::vector<std::uint32_t> away =
      cutouts_.cut_away(all.rays, {triangles.data, triangles.size});
  if (away.empty()) return;
  std::vector<float> tests(seeing.pixel_tests.empty() ? 0 : away.size());
  const std::vector<RayHit> hits = traced(part_of(all, away), Facing::kSkipBackOfSingleSided,
                                          &seeing.statistics(), tests, meter);
  for (std::size_t i = 0; i < away.size(); ++i) {
    triangles[away[i]] = hits[i].triangle;
    if (!tests.empty()) seeing.pixel_tests[away[i]] += tests[i];
  }
}

std::vector<std::uint32_t> ResidentGeometry::rasterize(const Seeing& seeing) const {
  const CameraFrame& frame = seeing.frame;
  const GbufferRequest wish{source_.textures, seeing.gbuffer};
  return made_by_first(options_.cache->ranks, std::size_t{frame.width} * frame.height, [&] {
    return rasterize_primary(executor_, *seeing.rasterizer, scene_, frame,
                             seeing.gbuffer != nullptr ? &wish : nullptr);
  });
}

float ResidentGeometry::depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) {
  BatchStatistics not_kept;
  const RayHit hit =
      traced(middle_ray(frame), Facing::kSkipBackOfSingleSided, &not_kept, {}, meter).front();
  return depth_of(hit, frame, scene_.bounds);
}

std::vector<RayHit> ResidentGeometry::meet(const RayBatch& batch, Facing facing,
                                           BatchStatistics* statistics, View<float> ray_tests,
                                           ProgressMeter* meter) {
  if (levels_ != nullptr) return enter(batch, facing, statistics);
  TraceOptions options = options_;
  options.facing = facing;
  return raysheaf::trace(executor_, scene_, batch, options, statistics, ray_tests, meter);
}

void ResidentGeometry::meet_any(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                                View<float> ray_tests, ProgressMeter* meter,
                                View<std::uint8_t> occluded) {
  if (levels_ != nullptr) return enter_any(batch, statistics, occluded);
  TraceOptions options = options_;
  options.early_out = early_out;
  const std::vector<RayHit> hits =
      raysheaf::trace(executor_, scene_, batch, options, statistics, ray_tests, meter);
  executor_.for_each(hits.size(), kCopyGrain,
                     [&](std::size_t i) { occluded[i] = hits[i].found() ? 1 : 0; });
}

SharedWork ResidentGeometry::share() {
  if (levels_ != nullptr) return {};
  QueryReport report = options_.cache->prepare_tree(executor_, scene_);
  return {report.hierarchy_ms, std::move(report.plan)};
}

std::unique_ptr<PathGeometry> ResidentGeometry::of_one_thread() {
  return std::make_unique<ThreadGeometry>(source_, blends_, seen_, *options_.cache);
}

void ResidentGeometry::add_rays(std::uint64_t count) {
  if (levels_ == nullptr) options_.cache->dual->engine().add_rays(count);
}

}  // namespace raysheaf
