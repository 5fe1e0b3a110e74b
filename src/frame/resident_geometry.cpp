#include "frame/resident_geometry.h"

#include <algorithm>
#include <span>

#include "frame/frame.h"
#include "frame/primary.h"
#include "intersect/triangle_body.h"
#include "scene/surface_reader.h"
#include "shade/shade.h"

namespace raysheaf {

namespace {

/// Pixels that `dual` follows together: what their rays need, about 1 KB each, is the same memory
/// for all of a large picture.
constexpr std::size_t kMostFirstHits = std::size_t{1} << 18;
static_assert(kMostFirstHits % kSkyPart == 0);

}  // namespace

ResidentGeometry::ResidentGeometry(const Executor& executor, const FlatScene& scene,
                                   const TextureSet& textures, const RenderOptions& options,
                                   TraceCache* cache, std::uint32_t samples)
    : executor_(executor),
      scene_(scene),
      textures_(textures),
      cutouts_(executor, scene, textures, samples > 1) {
  options_.method = settings_for(options);
  options_.cache = cache != nullptr ? cache : &own_cache_;
  options_.cache->tree = {};
  options_.bundle_samples = options.bundle_samples;
}

std::size_t ResidentGeometry::look(const Seeing& seeing, ProgressMeter* meter) {
  frame_ = seeing.frame;
  const std::size_t pixels = std::size_t{frame_.width} * frame_.height;
  groups_ = split(pixels, asks_alone(options_) ? kMostFirstHits : pixels);
  if (seeing.rasterizer != nullptr) {
    meter->begin("raster", 1);
    triangles_ = rasterize(*seeing.rasterizer, frame_);
    if (cutouts_.any()) see_through(seeing, triangles_, meter);
  } else {
    triangles_ = trace_triangles(seeing, meter);
  }
  meter->begin("surfaces", 1);
  return groups_.size();
}

std::vector<std::uint32_t> ResidentGeometry::trace_triangles(const Seeing& seeing,
                                                             ProgressMeter* meter) {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(std::size_t{frame_.width} * frame_.height);
  BatchStatistics& statistics = seeing.statistics();
  for (const PixelRange& pixels : groups_) {
    RayBatch batch = primary_rays(executor_, scene_.bounds, frame_, pixels);
    batch.part = groups_.size() > 1;
    const View<float> tests = seeing.pixel_tests;
    const std::size_t known = statistics.plan.size();
    const std::vector<RayHit> hits =
        traced(batch, Facing::kSkipBackOfSingleSided, &statistics,
               tests.empty() ? tests : tests.slice(pixels.first, pixels.count), meter);
    if (known > 0) statistics.plan.resize(known);  // the first group's
    for (const RayHit& hit : hits) triangles.push_back(hit.triangle);
  }
  return triangles;
}

Fragments ResidentGeometry::first_hits(std::size_t group) {
  return fetch_fragments(executor_, scene_, textures_, frame_, triangles_, groups_[group]);
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

std::vector<std::uint32_t> ResidentGeometry::rasterize(Rasterizer& rasterizer,
                                                       const CameraFrame& frame) const {
  Communicator* const ranks = options_.cache->ranks;
  if (ranks == nullptr) return rasterize_primary(executor_, rasterizer, scene_, frame);
  std::vector<std::uint32_t> triangles(std::size_t{frame.width} * frame.height);
  if (ranks->rank() == 0) triangles = rasterize_primary(executor_, rasterizer, scene_, frame);
  ranks->broadcast(std::as_writable_bytes(std::span(triangles)));
  return triangles;
}

float ResidentGeometry::depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) {
  BatchStatistics not_kept;
  const RayHit hit =
      traced(middle_ray(frame), Facing::kSkipBackOfSingleSided, &not_kept, {}, meter).front();
  return depth_of(hit, frame, scene_.bounds);
}

std::vector<RayHit> ResidentGeometry::traced(const RayBatch& batch, Facing facing,
                                             BatchStatistics* statistics, View<float> ray_tests,
                                             ProgressMeter* meter) {
  TraceOptions options = options_;
  options.facing = facing;
  const auto first_hits = [&](const RayBatch& rays, View<float> tests) {
    return raysheaf::trace(executor_, scene_, rays, options, statistics, tests, meter);
  };
  std::vector<RayHit> hits = first_hits(batch, ray_tests);
  if (cutouts_.any()) cutouts_.pass(batch, first_hits, hits, ray_tests);
  return hits;
}

std::vector<RayHit> ResidentGeometry::trace(const RayBatch& batch, BatchStatistics* statistics,
                                            View<float> ray_tests, ProgressMeter* meter) {
  return traced(batch, Facing::kBoth, statistics, ray_tests, meter);
}

void ResidentGeometry::find_occluded(const RayBatch& batch, bool early_out,
                                     BatchStatistics* statistics, View<float> ray_tests,
                                     ProgressMeter* meter, View<std::uint8_t> occluded) {
  TraceOptions options = options_;
  options.early_out = early_out;
  raysheaf::find_occluded(executor_, scene_, batch, options, statistics, ray_tests, meter,
                          occluded);
  if (!cutouts_.any()) return;
  // Something is in their way; whether it is there where they meet it, its triangle must tell.
  std::vector<std::uint32_t> stopped;
  for (std::uint32_t i = 0; i < occluded.size; ++i)
    if (occluded[i] != 0) stopped.push_back(i);
  if (stopped.empty()) return;
  RayBatch rays = part_of(batch, stopped);
  rays.names_hits = true;
  std::vector<float> tests(ray_tests.empty() ? 0 : stopped.size());
  const std::vector<RayHit> hits = traced(rays, Facing::kBoth, statistics, tests, meter);
  for (std::size_t i = 0; i < stopped.size(); ++i) {
    occluded[stopped[i]] = hits[i].found() ? 1 : 0;
    if (!tests.empty()) ray_tests[stopped[i]] += tests[i];
  }
}

void ResidentGeometry::fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) {
  executor_.for_each_block(fragments.size, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    SurfaceReader reader(*scene_.description, textures_);
    for (std::size_t i = begin; i < end; ++i) {
      Fragment& f = fragments[i];
      if (f.triangle == kInvalidId) continue;
      reader.hold(scene_, f.triangle);
      const Vec3(&corner)[3] = reader.held().corner;
      TriangleHit where{};
      intersect_triangle(make_ray_setup(rays[i]), corner[0], corner[1], corner[2], &where);
      f.surface = reader.at(where.u, where.v, f.incoming);
    }
  });
}

PixelIds ResidentGeometry::ids(std::uint32_t triangle) const {
  return ids_of(scene_, triangle);
}

}  // namespace raysheaf
