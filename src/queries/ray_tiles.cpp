#include "queries/ray_tiles.h"

#include <algorithm>
#include <mutex>

#include "base/bits.h"
#include "exec/stopwatch.h"

namespace raysheaf {
namespace {

/// Rays per tile: those of each of several quarters should fill a stream, but a small batch must
/// also be divided among many threads.
constexpr std::size_t kLeastTile = 8192, kMostTile = 32768, kTiles = 64;

}  // namespace

std::size_t RayTiles::tile_size(std::size_t rays, std::size_t row) {
  const std::size_t size = std::clamp<std::size_t>(div_ceil(rays, kTiles), kLeastTile, kMostTile);
  return row == 0 ? size : rows_of_tiles(size, row);
}

template <class Trace>
TileTimes RayTiles::run(const Executor& executor, const RaySource& rays, std::size_t row,
                        DualCounts* counts, const Trace& trace) {
  const std::size_t size = tile_size(rays.size(), row);
  const Executor serial = Executor::serial();
  const Stopwatch watch;
  std::mutex mutex;
  TileTimes of_threads;
  executor.for_each(div_ceil(rays.size(), size), 1, [&](std::size_t number) {
    const std::size_t begin = number * size, end = std::min(rays.size(), begin + size);
    const Borrowed<Tile> tile(spares_);
    DualCounts found;
    TileTimes times;
    Stopwatch lap;
    tile->rays.resize_uninitialized(end - begin);
    const View<const Ray> some = rays.take(begin, end, tile->rays.data());
    times.take_ms = lap.lap_ms();
    order_rays(serial, some, Sorting::kByQuarter, &tile->order, row);
    times.order_ms = lap.lap_ms();
    trace(*tile, begin, some, serial, &found);
    times.trace_ms = lap.lap_ms();
    const std::lock_guard<std::mutex> lock(mutex);
    counts->add(found);
    of_threads.take_ms += times.take_ms;
    of_threads.order_ms += times.order_ms;
    of_threads.trace_ms += times.trace_ms;
  });
  const double sum = of_threads.take_ms + of_threads.order_ms + of_threads.trace_ms;
  const double part = sum > 0 ? watch.ms() / sum : 0;
  return {part * of_threads.take_ms, part * of_threads.order_ms, part * of_threads.trace_ms};
}

TileTimes RayTiles::closest_hit(const Executor& executor, const RaySource& rays, std::size_t row,
                                const DualScene& scene, const HitSink& sink, DualCounts* counts) {
  return run(executor, rays, row, counts,
             [&](Tile& tile, std::size_t begin, View<const Ray> some, const Executor& serial,
                 DualCounts* found) {
               tile.hits.resize_uninitialized(some.size);
               trace_closest(serial, scene, some, tile.order, tile.hits, {}, found);
               sink(begin, tile.hits);
             });
}

TileTimes RayTiles::any_hit(const Executor& executor, const RaySource& rays, std::size_t row,
                            const DualScene& scene, View<std::uint8_t> occluded,
                            DualCounts* counts) {
  return run(executor, rays, row, counts,
             [&](Tile& tile, std::size_t begin, View<const Ray> some, const Executor& serial,
                 DualCounts* found) {
               trace_any(serial, scene, some, tile.order, occluded.slice(begin, some.size), {},
                         found);
             });
}

}  // namespace raysheaf
