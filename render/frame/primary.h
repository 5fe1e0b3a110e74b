// Primary visibility by rasterization or ray tracing, as fragments.
#pragma once

#include <vector>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "raysheaf/statistics.h"
#include "render/frame/surface_fetcher.h"
#include "render/frame/trace.h"
#include "render/rays/camera_rays.h"
#include "render/rays/fragment.h"
#include "render/surface/texture.h"
#include "scene/flat_scene.h"

namespace raysheaf {

class Rasterizer;
struct GbufferRequest;

struct PictureSize {
  std::uint32_t width = 0, height = 0;
};

/// Some pixels of an image, numbered in rows from the top: runs of neighbours at a constant stride.
/// They ascend.
struct PixelGroup {
  std::size_t first = 0, count = 0;
  std::size_t run = 1, stride = 1;  ///< pixels per run; distance between the first pixels of two
                                    ///< runs

  [[nodiscard]] std::size_t pixel(std::size_t i) const {
    return first + i / run * stride + i % run;
  }
};

[[nodiscard]] PixelGroup all_pixels(PictureSize size);
/// Divides all pixels into groups for threads to follow: their size depends on the image's, and
/// each consists of whole `kSkyPart`s (render/shade/shade.h) of the image. If the image's width is
/// a multiple of a `kSkyPart`, groups are tiles of that width, because neighbouring pixels see the
/// same surfaces; otherwise rows.
[[nodiscard]] std::vector<PixelGroup> groups_of(PictureSize size);

/// A ray for each pixel of the group, or of the image, in order. `bounds`: of the scene.
[[nodiscard]] RayBatch primary_rays(const Executor& executor, const Box& bounds,
                                    const CameraRays& rays, const PixelGroup& pixels,
                                    Keys keys = Keys::kMade);
[[nodiscard]] RayBatch primary_rays(const Executor& executor, const Box& bounds,
                                    const CameraFrame& frame);

/// The ray through the middle of the image.
[[nodiscard]] RayBatch middle_ray(const CameraFrame& frame);
/// The depth of its hit, or of the farthest corner of the scene.
[[nodiscard]] float depth_of(const RayHit& hit, const CameraFrame& frame, const Box& bounds);

/// The number of the triangle that each pixel sees, rows from the top. `gbuffer`: as the rasteriser
/// has it.
[[nodiscard]] std::vector<std::uint32_t> rasterize_primary(const Executor& executor,
                                                           Rasterizer& rasterizer,
                                                           const FlatScene& scene,
                                                           const CameraFrame& frame,
                                                           const GbufferRequest* gbuffer = nullptr);

/// The same by rays, which pass the backs of single-sided triangles, but do not pass holes of
/// materials. `pixel_tests`: as `ray_tests` of `trace`; `cache`: of the scene, shared with other
/// batches, or null.
[[nodiscard]] std::vector<std::uint32_t> trace_primary(
    const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
    const MethodSettings& method, BatchStatistics* statistics, View<float> pixel_tests,
    ProgressMeter* meter, TraceCache* cache = nullptr);

/// One fragment for each pixel of the group, or of the image, with the attributes of the triangle
/// there. `triangles`: of all pixels.
[[nodiscard]] Fragments fetch_fragments(const Executor& executor, const SurfaceSource& source,
                                        const CameraRays& rays, View<const std::uint32_t> triangles,
                                        const PixelGroup& pixels);
[[nodiscard]] Fragments fetch_fragments(const Executor& executor, const FlatScene& scene,
                                        const TextureSet& textures, const CameraFrame& frame,
                                        View<const std::uint32_t> triangles);

}  // namespace raysheaf
