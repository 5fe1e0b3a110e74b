// A batch of rays whose pieces are traced by several processes.
#pragma once

#include <functional>
#include <vector>

#include "ranks/share.h"
#include "render/frame/trace.h"

namespace raysheaf {

/// `ranks` if the batch is large enough to share, else null. The same in every process.
[[nodiscard]] Communicator* sharers(Communicator* ranks, const RayBatch& batch);

using TracePiece =
    std::function<std::vector<RayHit>(const RayBatch& piece, BatchStatistics* statistics,
                                      View<float> ray_tests, ProgressMeter* meter)>;

/// The hits of `batch` in every process, traced by `trace` in pieces: runs of neighbours in the
/// batch's order, which is that of pixels. Counts added to `statistics` and `ray_tests` are those
/// of all processes, times those of this one. The caller counts hits, rays and triangles.
[[nodiscard]] std::vector<RayHit> trace_shared(Communicator& ranks, const RayBatch& batch,
                                               BatchStatistics* statistics, View<float> ray_tests,
                                               ProgressMeter* meter, const TracePiece& trace);

}  // namespace raysheaf
