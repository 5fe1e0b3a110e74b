// Triangles in memory, for every way of tracing rays through them.
#pragma once

#include <vector>

#include "render/frame/cutouts.h"
#include "render/frame/geometry.h"
#include "render/frame/primary.h"
#include "render/frame/trace.h"
#include "surface/texture.h"

namespace raysheaf {

/// The triangles that the pixels of an image see.
struct SeenPixels {
  CameraRays rays;
  std::vector<std::uint32_t> triangles;  ///< of each pixel
  std::vector<PixelGroup> groups;
  std::vector<std::uint8_t> known;  ///< for each group, whether its triangles are known
  View<float> pixel_tests;          ///< of the rays that find them; may be empty
};

class FlatGeometry : public virtual PathGeometry {
 public:
  [[nodiscard]] const Box& bounds() const override { return scene_.bounds; }
  [[nodiscard]] std::uint64_t triangle_count() const override { return scene_.triangle_count; }
  [[nodiscard]] std::size_t most_shadow_rays() const override { return std::size_t{1} << 24; }
  [[nodiscard]] Fragments first_hits(std::size_t group, const FirstHitTally& tally) override;
  [[nodiscard]] std::vector<RayHit> trace(const RayBatch& batch, BatchStatistics* statistics,
                                          View<float> ray_tests, ProgressMeter* meter) override;
  void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                     View<float> ray_tests, ProgressMeter* meter,
                     View<std::uint8_t> occluded) override;
  void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) override;
  [[nodiscard]] PixelIds ids(std::uint32_t triangle) const override;

 protected:
  /// All must outlive this object. `blends`: there are several samples per pixel.
  FlatGeometry(const Executor& executor, const SurfaceSource& source, bool blends,
               const SeenPixels& seen)
      : executor_(executor),
        source_(source),
        scene_(source.scene),
        cutouts_(executor, source.scene, source.textures, blends),
        seen_(seen) {}

  /// Closest hits, including those in holes. Otherwise as `trace` and `find_occluded`.
  [[nodiscard]] virtual std::vector<RayHit> meet(const RayBatch& batch, Facing facing,
                                                 BatchStatistics* statistics, View<float> ray_tests,
                                                 ProgressMeter* meter) = 0;
  virtual void meet_any(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                        View<float> ray_tests, ProgressMeter* meter,
                        View<std::uint8_t> occluded) = 0;
  /// The closest hits that are not in holes.
  [[nodiscard]] std::vector<RayHit> traced(const RayBatch& batch, Facing facing,
                                           BatchStatistics* statistics, View<float> ray_tests,
                                           ProgressMeter* meter);

  const Executor& executor_;
  const SurfaceSource source_;
  const FlatScene& scene_;
  const Cutouts cutouts_;

 private:
  const SeenPixels& seen_;
};

}  // namespace raysheaf
