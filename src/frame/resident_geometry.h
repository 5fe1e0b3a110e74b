// Triangles in memory, met by any method.
#pragma once

#include "frame/cutouts.h"
#include "frame/geometry.h"
#include "frame/primary.h"
#include "frame/trace.h"
#include "scene/texture.h"

namespace raysheaf {

class ResidentGeometry : public FrameGeometry {
 public:
  /// All must outlive it. `cache`: of the scene, kept from frame to frame; none: nothing is.
  /// `samples`: of a pixel.
  ResidentGeometry(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
                   const RenderOptions& options, TraceCache* cache = nullptr,
                   std::uint32_t samples = 1);

  [[nodiscard]] const Box& bounds() const override { return scene_.bounds; }
  [[nodiscard]] std::uint64_t triangle_count() const override { return scene_.triangle_count; }
  [[nodiscard]] std::size_t most_shadow_rays() const override { return std::size_t{1} << 24; }
  [[nodiscard]] std::size_t look(const Seeing& seeing, ProgressMeter* meter) override;
  [[nodiscard]] Fragments first_hits(std::size_t group) override;
  [[nodiscard]] std::vector<RayHit> trace(const RayBatch& batch, BatchStatistics* statistics,
                                          View<float> ray_tests, ProgressMeter* meter) override;
  void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                     View<float> ray_tests, ProgressMeter* meter,
                     View<std::uint8_t> occluded) override;
  [[nodiscard]] float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) override;
  void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) override;
  [[nodiscard]] PixelIds ids(std::uint32_t triangle) const override;

 private:
  [[nodiscard]] std::vector<std::uint32_t> trace_triangles(const Seeing& seeing,
                                                           ProgressMeter* meter);
  /// What OpenGL of rank 0 shows: that of others may be another one.
  [[nodiscard]] std::vector<std::uint32_t> rasterize(Rasterizer& rasterizer,
                                                     const CameraFrame& frame) const;
  /// Brings what OpenGL shows to what is there, by rays.
  void see_through(const Seeing& seeing, View<std::uint32_t> triangles, ProgressMeter* meter);
  /// The first hits that are there.
  [[nodiscard]] std::vector<RayHit> traced(const RayBatch& batch, Facing facing,
                                           BatchStatistics* statistics, View<float> ray_tests,
                                           ProgressMeter* meter);

  const Executor& executor_;
  const FlatScene& scene_;
  const TextureSet& textures_;
  const Cutouts cutouts_;
  TraceCache own_cache_;
  TraceOptions options_;
  // Of the last `look`.
  CameraFrame frame_;
  std::vector<std::uint32_t> triangles_;  ///< that each pixel sees
  std::vector<PixelRange> groups_;
};

}  // namespace raysheaf
