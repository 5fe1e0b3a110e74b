// Triangles in blocks that stream past the rays of a frame (raysheaf/stream.h).
#pragma once

#include "out_of_core/streamer.h"
#include "render/frame/geometry.h"
#include "render/surface/surface.h"

namespace raysheaf {

class StreamedGeometry : public FrameGeometry {
 public:
  /// The streamer's source and context must outlive it. `most_shadow_rays`: the number for which
  /// there is memory.
  StreamedGeometry(const Executor& executor, Streamer* streamer, const TextureSet& textures,
                   std::size_t most_shadow_rays);

  [[nodiscard]] const Box& bounds() const override { return streamer_.bounds(); }
  [[nodiscard]] std::uint64_t triangle_count() const override { return streamer_.triangle_count(); }
  [[nodiscard]] std::size_t most_shadow_rays() const override { return most_shadow_rays_; }
  /// By rays.
  [[nodiscard]] std::size_t look(const Seeing& seeing, ProgressMeter* meter) override;
  [[nodiscard]] Fragments first_hits(std::size_t group, const FirstHitTally& tally) override;
  [[nodiscard]] float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) override;
  /// The number of a hit's triangle is that of its ray.
  [[nodiscard]] std::vector<RayHit> trace(const RayBatch& batch, BatchStatistics* statistics,
                                          View<float> ray_tests, ProgressMeter* meter) override;
  void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                     View<float> ray_tests, ProgressMeter* meter,
                     View<std::uint8_t> occluded) override;
  /// Reads the shading data of the blocks with hits, each once; if several processes stream, each
  /// reads those of its blocks.
  void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) override;
  [[nodiscard]] PixelIds ids(std::uint32_t triangle) const override;

  /// Milliseconds, bytes and blocks of `fetch_surfaces`.
  [[nodiscard]] const StreamStatistics& shading() const { return shading_; }

 private:
  [[nodiscard]] std::vector<RayHit> closest(const RayBatch& batch, const StreamRequest& request,
                                            BatchStatistics* statistics);
  /// Adds the batch to `statistics`, and makes the request to the streamer.
  [[nodiscard]] StreamRequest begin(const RayBatch& batch, BatchStatistics* statistics,
                                    View<float> ray_tests, ProgressMeter* meter) const;
  [[nodiscard]] std::vector<RayHit> traced(const RayBatch& batch, Facing facing,
                                           BatchStatistics* statistics, View<float> ray_tests,
                                           ProgressMeter* meter);

  /// Combines the surfaces of all processes: each has those of its own blocks.
  void exchange_surfaces(const std::vector<std::uint32_t>& met, View<Fragment> fragments);

  const Executor& executor_;
  Streamer& streamer_;
  const TextureSet& textures_;
  std::size_t most_shadow_rays_;
  std::vector<StreamHit> hits_;  ///< of the last batch of closest hits
  Fragments first_hits_;         ///< of the last `look`, until `first_hits` returns them
  StreamStatistics shading_;
};

}  // namespace raysheaf
