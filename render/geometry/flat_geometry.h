// Triangles in memory, for every way of tracing rays through them: placed, or in their meshes,
// where rays enter the instances (levels/level_scene.h).
#pragma once

#include <vector>

#include "levels/level_scene.h"
#include "render/frame/cutouts.h"
#include "render/frame/geometry.h"
#include "render/frame/primary.h"
#include "render/frame/trace.h"
#include "render/surface/texture.h"

namespace raysheaf {

/// The triangles that the pixels of an image see.
struct SeenPixels {
  CameraRays rays;
  std::vector<std::uint32_t> triangles;  ///< of each pixel
  std::vector<TriangleAt> met;           ///< the same for `MetTriangles`; empty: not needed
  std::vector<PixelGroup> groups;
  std::vector<std::uint8_t> known;  ///< for each group, whether its triangles are known
  View<float> pixel_tests;          ///< of the rays that find them; may be empty
};

class FlatGeometry : public virtual PathGeometry {
 public:
  [[nodiscard]] const Box& bounds() const override { return scene_.bounds; }
  [[nodiscard]] std::uint64_t triangle_count() const override { return triangle_count_; }
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
  /// All must outlive this object. `blends`: there are several samples per pixel. `levels`: rays
  /// enter instances; null: these are placed.
  FlatGeometry(const Executor& executor, const SurfaceSource& source, bool blends, SeenPixels& seen,
               const LevelScene* levels)
      : executor_(executor),
        met_(seen.met),
        source_{source.scene, source.textures, source.looks, levels != nullptr ? &met_ : nullptr},
        scene_(source.scene),
        cutouts_(executor, source_, blends),
        levels_(levels),
        seen_(seen),
        triangle_count_(levels != nullptr ? source.scene.description->triangle_count()
                                          : source.scene.triangle_count) {}

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
  /// `meet` and `meet_any` where rays enter instances.
  [[nodiscard]] std::vector<RayHit> enter(const RayBatch& batch, Facing facing,
                                          BatchStatistics* statistics);
  void enter_any(const RayBatch& batch, BatchStatistics* statistics, View<std::uint8_t> occluded);
  /// Notes the triangle that a pixel sees.
  void note_seen(std::size_t pixel, std::uint32_t triangle);

  const Executor& executor_;
  MetTriangles met_;
  const SurfaceSource source_;
  const FlatScene& scene_;
  const Cutouts cutouts_;
  const LevelScene* const levels_;
  SeenPixels& seen_;

 private:
  const std::uint64_t triangle_count_;
};

}  // namespace raysheaf
