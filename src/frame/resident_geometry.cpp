#include "frame/resident_geometry.h"

#include <span>

#include "frame/frame.h"
#include "frame/primary.h"
#include "intersect/triangle_body.h"
#include "scene/surface_reader.h"

namespace raysheaf {

ResidentGeometry::ResidentGeometry(const Executor& executor, const FlatScene& scene,
                                   const TextureSet& textures, const RenderOptions& options,
                                   TraceCache* cache)
    : executor_(executor), scene_(scene), textures_(textures) {
  options_.method = settings_for(options);
  options_.cache = cache != nullptr ? cache : &own_cache_;
  options_.cache->tree = {};
  options_.bundle_samples = options.bundle_samples;
}

Fragments ResidentGeometry::see(const Seeing& seeing, ProgressMeter* meter) {
  std::vector<std::uint32_t> triangles;
  if (seeing.rasterizer != nullptr) {
    meter->begin("raster", 1);
    triangles = rasterize(*seeing.rasterizer, seeing.frame);
  } else {
    triangles = trace_primary(executor_, scene_, seeing.frame, options_.method, seeing.statistics,
                              seeing.pixel_tests, meter, options_.cache);
  }
  meter->begin("surfaces", 1);
  return fetch_fragments(executor_, scene_, textures_, seeing.frame, triangles);
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
  return raysheaf::depth_of_middle(executor_, scene_, frame, options_.method, meter);
}

std::vector<RayHit> ResidentGeometry::trace(const RayBatch& batch, BatchStatistics* statistics,
                                            View<float> ray_tests, ProgressMeter* meter) {
  return raysheaf::trace(executor_, scene_, batch, options_, statistics, ray_tests, meter);
}

void ResidentGeometry::find_occluded(const RayBatch& batch, bool early_out,
                                     BatchStatistics* statistics, View<float> ray_tests,
                                     ProgressMeter* meter, View<std::uint8_t> occluded) {
  TraceOptions options = options_;
  options.early_out = early_out;
  raysheaf::find_occluded(executor_, scene_, batch, options, statistics, ray_tests, meter,
                          occluded);
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
