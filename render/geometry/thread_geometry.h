// Triangles in memory, traced by one thread with the method `dual`, through the object tree that
// all threads share.
#pragma once

#include "base/buffer.h"
#include "exec/executor.h"
#include "queries/tree_queries.h"
#include "render/geometry/flat_geometry.h"

namespace raysheaf {

class ThreadGeometry : public FlatGeometry {
 public:
  /// All must outlive this object. The cache's tree must be up to date when rays are traced.
  ThreadGeometry(const SurfaceSource& source, bool blends, SeenPixels& seen,
                 const TraceCache& cache)
      : FlatGeometry(serial_, source, blends, seen, cache.levels()), cache_(cache) {}

  /// By rays, if not known before.
  [[nodiscard]] Fragments first_hits(std::size_t group, const FirstHitTally& tally) override;

  /// The same for every thread.
  [[nodiscard]] std::size_t most_shadow_rays() const override { return std::size_t{1} << 18; }

 protected:
  [[nodiscard]] std::vector<RayHit> meet(const RayBatch& batch, Facing facing,
                                         BatchStatistics* statistics, View<float> ray_tests,
                                         ProgressMeter* meter) override;
  void meet_any(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                View<float> ray_tests, ProgressMeter* meter, View<std::uint8_t> occluded) override;

 private:
  void find_first_hits(const PixelGroup& pixels, const FirstHitTally& tally);

  const Executor serial_ = Executor::serial();
  const TraceCache& cache_;
  TreeQueries queries_;
  Buffer<IndexedHit> closest_;
};

}  // namespace raysheaf
