#include <algorithm>

#include "base/bits.h"
#include "dual/stream.h"
#include "dual/trace_job.h"

namespace raysheaf {
namespace {

/// Packets a task: neighbours share the boxes and triangles that they meet. Of streams: two.
constexpr std::size_t kPacketsATask = 64;
constexpr std::size_t kStreamPacketsATask = 2 * kStreamRays / kPacketWidth;

template <class Trace>
void trace_all_tasks(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                     const RayOrder& order, View<float> ray_tests, DualCounts* counts, TraceJob job,
                     const Trace& trace) {
  std::mutex mutex;
  StreamPool own;
  job.streams = scene.streams != nullptr ? scene.streams : &own;
  job.scene = scene;
  job.bundle = scene.bundle;
  job.rays = rays.data;
  job.order = order.rays.data();
  job.ray_starts = order.starts;
  for (std::uint32_t q = 0; q < kQuarters; ++q) {
    const std::uint32_t rays_in = order.starts[q + 1] - order.starts[q];
    job.packet_starts[q + 1] = job.packet_starts[q] + div_ceil(rays_in, kPacketWidth);
  }
  job.ray_tests = ray_tests.empty() ? nullptr : ray_tests.data;
  job.counts = counts;
  job.mutex = &mutex;
  const std::size_t packets = job.packet_starts[kQuarters];
  const std::size_t a_task = scene.bundle == Bundle::kStream ? kStreamPacketsATask : kPacketsATask;
  executor.for_each(div_ceil(packets, a_task), 1, [&](std::size_t task) {
    const std::size_t begin = task * a_task;
    trace(job, begin, std::min(packets, begin + a_task));
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

RowLists trace_all(const Executor& executor, const DualScene& scene, View<const Ray> rays,
                   const RayOrder& order, View<float> ray_tests, DualCounts* counts) {
  RowLists rows;
  if (scene.tree->empty()) return rows;
  TraceJob job;
  job.rows = &rows;
  trace_all_tasks(executor, scene, rays, order, ray_tests, counts, job, trace_all_packets);
  return rows;
}

}  // namespace raysheaf
