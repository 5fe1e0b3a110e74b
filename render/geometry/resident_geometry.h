// Triangles in memory, for every method, with all threads.
#pragma once

#include "render/geometry/flat_geometry.h"

namespace raysheaf {

/// A base class, because the next base class needs it initialized.
struct HasLooks {
  std::vector<MaterialLook> looks;
  SeenPixels pixels;  ///< from the last `look`
};

class ResidentGeometry : public FrameGeometry, private HasLooks, public FlatGeometry {
 public:
  /// All must outlive this object. `cache`: of the scene, kept from frame to frame; null: nothing
  /// is kept. `samples`: per pixel.
  ResidentGeometry(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
                   const RenderOptions& options, TraceCache* cache = nullptr,
                   std::uint32_t samples = 1);

  [[nodiscard]] std::size_t look(const Seeing& seeing, ProgressMeter* meter) override;
  [[nodiscard]] float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) override;

  /// For `dual` on the CPU.
  [[nodiscard]] bool is_shared() const override { return asks_alone(options_); }
  [[nodiscard]] SharedWork share() override;
  [[nodiscard]] std::unique_ptr<PathGeometry> of_one_thread() override;
  void add_rays(std::uint64_t count) override;

 protected:
  [[nodiscard]] std::vector<RayHit> meet(const RayBatch& batch, Facing facing,
                                         BatchStatistics* statistics, View<float> ray_tests,
                                         ProgressMeter* meter) override;
  void meet_any(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                View<float> ray_tests, ProgressMeter* meter, View<std::uint8_t> occluded) override;

 private:
  /// Finds what each pixel sees, by rays.
  void find_triangles(const Seeing& seeing, ProgressMeter* meter);
  /// The image of rank 0's OpenGL, because that of other ranks may differ.
  [[nodiscard]] std::vector<std::uint32_t> rasterize(const Seeing& seeing) const;
  /// Replaces triangles seen by OpenGL that have a hole at the pixel by those behind them, by rays.
  void see_through(const Seeing& seeing, View<std::uint32_t> triangles, ProgressMeter* meter);

  const bool blends_;
  TraceCache own_cache_;
  TraceOptions options_;
};

}  // namespace raysheaf
