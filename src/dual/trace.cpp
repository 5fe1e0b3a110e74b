#include <algorithm>

#include "base/bits.h"
#include "dual/trace_job.h"

namespace raysheaf {
namespace {

/// Packets a task: neighbours share the boxes and triangles that they meet.
constexpr std::size_t kPacketsATask = 64;

template <class Trace>
void trace_all_tasks(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                     const RayOrder& order, View<float> ray_tests, DualCounts* counts,
                     TraceJob job, const Trace& trace) {
  std::mutex mutex;
  job.scene = scene;
  job.rays = rays.data;
  job.order = order.rays.data();
  job.ray_starts = order.face_starts;
  for (std::uint32_t f = 0; f < kFaces; ++f) {
    const std::uint32_t in_face = order.face_starts[f + 1] - order.face_starts[f];
    job.packet_starts[f + 1] = job.packet_starts[f] + div_ceil(in_face, kPacketWidth);
  }
  job.ray_tests = ray_tests.empty() ? nullptr : ray_tests.data;
  job.counts = counts;
  job.mutex = &mutex;
  const std::size_t packets = job.packet_starts[kFaces];
  executor.for_each(div_ceil(packets, kPacketsATask), 1, [&](std::size_t task) {
    const std::size_t begin = task * kPacketsATask;
    trace(job, begin, std::min(packets, begin + kPacketsATask));
  });
}

}  // namespace

void trace_closest(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                   const RayOrder& order, View<EngineHit> hits, View<float> ray_tests,
                   DualCounts* counts) {
  if (scene.tree->empty()) {
    executor.for_each(hits.size, 4096, [&](std::size_t i) { hits[i] = {}; });
    return;
  }
  TraceJob job;
  job.hits = hits.data;
  trace_all_tasks(executor, scene, rays, order, ray_tests, counts, job, trace_closest_packets);
}

void trace_any(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, View<std::uint8_t> occluded, View<float> ray_tests,
               DualCounts* counts) {
  if (scene.tree->empty()) {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    return;
  }
  TraceJob job;
  job.occluded = occluded.data;
  trace_all_tasks(executor, scene, rays, order, ray_tests, counts, job, trace_any_packets);
}

std::vector<RowHit> trace_all(const Executor& executor, const DualScene& scene,
                              View<const Ray> rays, const RayOrder& order, View<float> ray_tests,
                              DualCounts* counts) {
  std::vector<RowHit> rows;
  if (scene.tree->empty()) return rows;
  TraceJob job;
  job.rows = &rows;
  trace_all_tasks(executor, scene, rays, order, ray_tests, counts, job, trace_all_packets);
  return rows;
}

}  // namespace raysheaf
