#include "queries/ray_tiles.h"

#include <algorithm>
#include <mutex>

#include "base/bits.h"
#include "exec/stopwatch.h"

namespace raysheaf {

std::size_t ray_tile_size(std::size_t rays, std::size_t row) {
  // Those of each of several quarters should fill a stream, but a small batch must also be divided
  // among many threads.
  constexpr std::size_t kLeast = 8192, kMost = 32768, kTiles = 64;
  const std::size_t size = std::clamp<std::size_t>(div_ceil(rays, kTiles), kLeast, kMost);
  return row == 0 ? size : rows_of_tiles(size, row);
}

void for_each_ray_tile(const Executor& executor, const RaySource& rays, std::size_t row,
                       Spares<RayTile>* spares, QueryReport* report,
                       const std::function<void(RayTile&, DualCounts*)>& trace) {
  const std::size_t size = ray_tile_size(rays.size(), row);
  const Executor serial = Executor::serial();
  const Stopwatch loop;
  std::mutex mutex;
  DualCounts counts;
  QueryReport of_threads;
  executor.for_each(div_ceil(rays.size(), size), 1, [&](std::size_t number) {
    const std::size_t begin = number * size, end = std::min(rays.size(), begin + size);
    const Borrowed<RayTile> tile(*spares);
    DualCounts found;
    Stopwatch watch;
    tile->begin = begin;
    tile->room.resize_uninitialized(end - begin);
    tile->rays = rays.take(begin, end, tile->room.data());
    const double take_ms = watch.lap_ms();
    order_rays(serial, tile->rays, &tile->order, row);
    const double order_ms = watch.lap_ms();
    trace(*tile, &found);
    const double trace_ms = watch.lap_ms();
    const std::lock_guard<std::mutex> lock(mutex);
    counts.add(found);
    of_threads.lap(&QueryReport::take_ms, take_ms);
    of_threads.lap(&QueryReport::order_ms, order_ms);
    of_threads.lap(&QueryReport::trace_ms, trace_ms);
  });
  if (report == nullptr) return;
  report->add(counts);
  const double part = of_threads.total_ms > 0 ? loop.ms() / of_threads.total_ms : 0;
  for (const auto stage : {&QueryReport::take_ms, &QueryReport::order_ms, &QueryReport::trace_ms})
    report->lap(stage, part * of_threads.*stage);
}

}  // namespace raysheaf
