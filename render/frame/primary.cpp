#include "render/frame/primary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "intersect/triangle_body.h"
#include "render/raster/projection.h"
#include "render/raster/rasterizer.h"
#include "render/raster/resolve.h"
#include "render/rays/hash_body.h"
#include "render/shade/shade.h"

namespace raysheaf {
namespace {

/// The number of pixels that a thread follows together, with all their bounces: few enough that the
/// data of their rays, about 1 KB per pixel, stay in its caches, and enough for a stream of rays to
/// a light. For small images, fewer, so that all threads have work.
std::size_t group_pixels(std::size_t pixels) {
  constexpr std::size_t kMost = 4096, kGroups = 64;
  const std::size_t part = (pixels / kGroups + kSkyPart - 1) / kSkyPart * kSkyPart;
  return std::clamp(part, kSkyPart, kMost);
}

/// Calls `body(i, pixel, x, y)` for pixels [begin, end) of the group, without a division for each
/// pixel.
template <class Body>
void for_each_pixel(const PixelGroup& pixels, std::size_t begin, std::size_t end,
                    std::uint32_t width, const Body& body) {
  for (std::size_t i = begin; i < end;) {
    auto pixel = static_cast<std::uint32_t>(pixels.pixel(i));
    std::uint32_t x = pixel % width, y = pixel / width;
    const std::size_t run_end = std::min(end, i + pixels.run - i % pixels.run);
    for (; i < run_end; ++i, ++pixel, ++x) {
      if (x == width) x = 0, ++y;
      body(i, pixel, x, y);
    }
  }
}

}  // namespace

std::vector<std::uint32_t> rasterize_primary(const Executor& executor, Rasterizer& rasterizer,
                                             const FlatScene& scene, const CameraFrame& frame,
                                             const GbufferRequest* gbuffer) {
  std::vector<std::uint32_t> drawn;
  std::vector<std::uint32_t> triangles =
      rasterizer.visible_triangles(executor, scene, frame, nullptr, &drawn, gbuffer);
  resolve_silhouettes(executor, scene, frame, drawn, triangles);
  return triangles;
}

PixelGroup all_pixels(PictureSize size) {
  const std::size_t count = std::size_t{size.width} * size.height;
  return {0, count, std::max<std::size_t>(count, 1), count};
}

std::vector<PixelGroup> groups_of(PictureSize size) {
  const std::size_t width = size.width, pixels = width * size.height;
  const std::size_t most = group_pixels(pixels);
  std::vector<PixelGroup> groups;
  if (width % kSkyPart != 0) {
    for (std::size_t first = 0; first < pixels; first += most)
      groups.push_back({first, std::min(most, pixels - first), most, most});
    return groups;
  }
  const std::size_t rows = most / kSkyPart;
  for (std::size_t y = 0; y < size.height; y += rows) {
    const std::size_t count = std::min(rows, size.height - y) * kSkyPart;
    for (std::size_t x = 0; x < width; x += kSkyPart)
      groups.push_back({y * width + x, count, kSkyPart, width});
  }
  return groups;
}

RayBatch primary_rays(const Executor& executor, const Box& bounds, const CameraFrame& frame) {
  return primary_rays(executor, bounds, CameraRays(frame), all_pixels({frame.width, frame.height}));
}

RayBatch primary_rays(const Executor& executor, const Box& bounds, const CameraRays& rays,
                      const PixelGroup& pixels, Keys keys) {
  RayBatch batch;
  batch.kind = RayKind::kPrimary;
  batch.bounce = 0;
  const std::uint32_t width = batch.width = rays.frame().width;
  batch.key_bits = kBounceKeyBits;
  batch.rays.resize(pixels.count);
  const bool keyed = keys == Keys::kMade;
  batch.keys.resize(keyed ? pixels.count : 0);
  batch.pixels.resize(keyed ? pixels.count : 0);
  executor.for_each_block(pixels.count, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    for_each_pixel(pixels, begin, end, width,
                   [&](std::size_t i, std::uint32_t pixel, std::uint32_t x, std::uint32_t y) {
                     const Ray ray = batch.rays[i] = rays.at(x, y);
                     if (!keyed) return;
                     batch.pixels[i] = pixel;
                     batch.keys[i] = bounce_key(bounds, ray.origin, ray.direction);
                   });
  });
  return batch;
}

std::vector<std::uint32_t> trace_primary(const Executor& executor, const FlatScene& scene,
                                         const CameraFrame& frame, const MethodSettings& method,
                                         BatchStatistics* statistics, View<float> pixel_tests,
                                         ProgressMeter* meter, TraceCache* cache) {
  const RayBatch batch = primary_rays(executor, scene.bounds, frame);
  TraceOptions options;
  options.method = method;
  options.facing = Facing::kSkipBackOfSingleSided;
  options.cache = cache;
  const std::vector<RayHit> hits =
      trace(executor, scene, batch, options, statistics, pixel_tests, meter);
  std::vector<std::uint32_t> triangles(hits.size());
  std::transform(hits.begin(), hits.end(), triangles.begin(),
                 [](const RayHit& hit) { return hit.triangle; });
  return triangles;
}

RayBatch middle_ray(const CameraFrame& frame) {
  RayBatch batch;
  batch.kind = RayKind::kPrimary;
  batch.rays = {{frame.eye, frame.z_near, frame.forward, frame.z_far}};
  batch.keys = batch.pixels = {0};
  return batch;
}

float depth_of(const RayHit& hit, const CameraFrame& frame, const Box& bounds) {
  if (hit.found() && hit.t > 0) return hit.t;
  const float farthest = farthest_depth(frame, bounds);
  return farthest > 0 ? farthest : 1;
}

Fragments fetch_fragments(const Executor& executor, const FlatScene& scene,
                          const TextureSet& textures, const CameraFrame& frame,
                          View<const std::uint32_t> triangles) {
  const std::vector<MaterialLook> looks = material_looks(*scene.description);
  return fetch_fragments(executor, {scene, textures, looks}, CameraRays(frame), triangles,
                         all_pixels({frame.width, frame.height}));
}

Fragments fetch_fragments(const Executor& executor, const SurfaceSource& source,
                          const CameraRays& rays, View<const std::uint32_t> triangles,
                          const PixelGroup& pixels) {
  Fragments fragments(pixels.count);
  executor.for_each_block(pixels.count, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    SurfaceFetcher fetcher(source);
    Ray seen[kFetchedTogether];
    for (std::size_t first = begin; first < end; first += kFetchedTogether) {
      const std::size_t count = std::min(kFetchedTogether, end - first);
      for_each_pixel(pixels, first, first + count, rays.frame().width,
                     [&](std::size_t i, std::uint32_t pixel, std::uint32_t x, std::uint32_t y) {
                       begin_fragment(&fragments[i], triangles[pixel], pixel);
                       seen[i - first] = rays.at(x, y);
                     });
      fetcher.fetch({seen, count}, Arrival::kSeen, View<Fragment>(fragments).slice(first, count));
    }
  });
  return fragments;
}

}  // namespace raysheaf
