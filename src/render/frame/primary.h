// What each pixel sees, by rasterisation or by tracing, as fragments.
#pragma once

#include <vector>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "rays/camera_rays.h"
#include "rays/fragment.h"
#include "raysheaf/statistics.h"
#include "render/frame/surface_fetcher.h"
#include "render/frame/trace.h"
#include "scene/flat_scene.h"
#include "surface/texture.h"

namespace raysheaf {

class Rasterizer;

struct PictureSize {
  std::uint32_t width = 0, height = 0;
};

/// Some pixels of a picture, numbered in rows from the top: runs of neighbours, each as far from
/// the one before it. They ascend.
struct PixelGroup {
  std::size_t first = 0, count = 0;
  std::size_t run = 1, stride = 1;  ///< pixels of a run; from its first to the next one's

  [[nodiscard]] std::size_t pixel(std::size_t i) const {
    return first + i / run * stride + i % run;
  }
};

[[nodiscard]] PixelGroup all_pixels(PictureSize size);
/// All pixels once, for threads to follow: of a size that goes by the picture's, and each of whole
/// `kSkyPart`s (render/shade/shade.h) of the picture. Tiles a `kSkyPart` wide, for what stands
/// close together sees the same, where the picture is whole ones wide; or else rows.
[[nodiscard]] std::vector<PixelGroup> groups_of(PictureSize size);

/// A ray a pixel of the group, or of all, in their order. `bounds`: of the scene.
[[nodiscard]] RayBatch primary_rays(const Executor& executor, const Box& bounds,
                                    const CameraRays& rays, const PixelGroup& pixels,
                                    Keys keys = Keys::kMade);
[[nodiscard]] RayBatch primary_rays(const Executor& executor, const Box& bounds,
                                    const CameraFrame& frame);

/// The ray through the middle of the picture.
[[nodiscard]] RayBatch middle_ray(const CameraFrame& frame);
/// The depth of its hit, or of the farthest corner of the scene.
[[nodiscard]] float depth_of(const RayHit& hit, const CameraFrame& frame, const Box& bounds);

/// The number of the triangle that each pixel sees, rows from the top.
[[nodiscard]] std::vector<std::uint32_t> rasterize_primary(const Executor& executor,
                                                           Rasterizer& rasterizer,
                                                           const FlatScene& scene,
                                                           const CameraFrame& frame);

/// The same by rays, which pass the backs of single-sided triangles, but see everything that
/// materials cut away. `pixel_tests`: as `trace` has
/// it; `cache`: of the scene, shared with other batches, or null.
[[nodiscard]] std::vector<std::uint32_t> trace_primary(
    const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
    const MethodSettings& method, BatchStatistics* statistics, View<float> pixel_tests,
    ProgressMeter* meter, TraceCache* cache = nullptr);

/// One fragment a pixel of the group, or of all, with the attributes of the triangle there.
/// `triangles`: of all pixels.
[[nodiscard]] Fragments fetch_fragments(const Executor& executor, const SurfaceSource& source,
                                        const CameraRays& rays, View<const std::uint32_t> triangles,
                                        const PixelGroup& pixels);
[[nodiscard]] Fragments fetch_fragments(const Executor& executor, const FlatScene& scene,
                                        const TextureSet& textures, const CameraFrame& frame,
                                        View<const std::uint32_t> triangles);

}  // namespace raysheaf
