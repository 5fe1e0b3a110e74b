#include <algorithm>
#include <utility>

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
  job.packets_a_task = a_task;
  if (job.rows != nullptr) job.rows->resize(div_ceil(packets, a_task));
  executor.for_each(div_ceil(packets, a_task), 1, [&](std::size_t task) {
    const std::size_t begin = task * a_task;
    trace(job, begin, std::min(packets, begin + a_task));
  });
}

}  // namespace

void make_rows(const std::vector<RowHit>& found, std::uint32_t first, std::uint32_t end,
               RowList* list) {
  list->first = first;
  list->ends.resize_uninitialized(end - first);
  list->hits.resize_uninitialized(found.size());
  std::fill(list->ends.begin(), list->ends.end(), 0u);
  // ends[i] is first the length of row i, then where it begins, then, filled, where it ends.
  for (const RowHit& hit : found) ++list->ends[hit.place - first];
  std::uint32_t begin = 0;
  for (std::uint32_t& at : list->ends) begin += std::exchange(at, begin);
  for (const RowHit& hit : found) list->hits[list->ends[hit.place - first]++] = hit.hit;
  begin = 0;
  for (const std::uint32_t row_end : list->ends) {
    std::sort(list->hits.begin() + begin, list->hits.begin() + row_end,
              [](const EngineHit& a, const EngineHit& b) {
                return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
              });
    begin = row_end;
  }
}

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

void trace_all(const Executor& executor, const DualScene& scene, View<const Ray> rays,
               const RayOrder& order, RowLists* rows, View<float> ray_tests, DualCounts* counts) {
  if (scene.tree->empty()) return rows->clear();
  TraceJob job;
  job.rows = rows;
  trace_all_tasks(executor, scene, rays, order, ray_tests, counts, job, trace_all_packets);
}

}  // namespace raysheaf
