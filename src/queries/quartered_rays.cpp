#include "queries/quartered_rays.h"

#include <algorithm>
#include <numeric>

#include "base/bits.h"

namespace raysheaf {

template <class Body>
void QuarteredRays::for_each_tile(const Executor& executor, const Body& body) const {
  executor.for_each(div_ceil(rays_.size(), kTile), 1, [&](std::size_t number) {
    const std::size_t begin = number * kTile;
    body(begin, std::min(rays_.size(), begin + kTile), number);
  });
}

void QuarteredRays::take(const Executor& executor, const RaySource& rays, std::size_t first,
                         std::size_t last) {
  const Executor serial = Executor::serial();
  first_ = first;
  rays_.resize_uninitialized(last - first);
  numbers_.resize_uninitialized(last - first);
  starts_.resize(div_ceil(last - first, kTile));
  order_.sort.count(
      executor, starts_.size(), kQuarters, [&](std::size_t number, std::uint32_t* counts) {
        const std::size_t begin = number * kTile, end = std::min(rays_.size(), begin + kTile);
        const Borrowed<RayTile> tile(spares_);
        tile->room.resize_uninitialized(end - begin);
        const View<const Ray> from = rays.take(first + begin, first + end, tile->room.data());
        order_rays(serial, from, &tile->order);
        const Starts& starts = starts_[number] = tile->order.starts;
        for (std::uint32_t q = 0; q < kQuarters; ++q) counts[q] = starts[q + 1] - starts[q];
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t n = tile->order.rays[i - begin];
          numbers_[i] = static_cast<std::uint16_t>(n);
          rays_[i] = from[n];
        }
      });
  // The order of all rays, from the sorted tiles.
  std::copy_n(order_.sort.starts().begin(), order_.starts.size(), order_.starts.begin());
  order_.rays.resize_uninitialized(rays_.size());
  order_.sort.put(executor, [&](std::size_t number, const std::uint32_t* next) {
    const Starts& starts = starts_[number];
    for (std::uint32_t q = 0; q < kQuarters; ++q) {
      std::uint32_t* const out = order_.rays.data() + next[q];
      std::iota(out, out + (starts[q + 1] - starts[q]),
                static_cast<std::uint32_t>(number * kTile) + starts[q]);
    }
  });
}

View<IndexedHit> QuarteredRays::hits() {
  hits_.resize_uninitialized(rays_.size());
  return hits_;
}

View<std::uint8_t> QuarteredRays::occluded() {
  occluded_.resize_uninitialized(rays_.size());
  return occluded_;
}

void QuarteredRays::hand_over_hits(const Executor& executor, const HitSink& sink) {
  for_each_tile(executor, [&](std::size_t begin, std::size_t end, std::size_t /*number*/) {
    const Borrowed<RayTile> tile(spares_);
    tile->hits.resize_uninitialized(end - begin);
    for (std::size_t i = begin; i < end; ++i) tile->hits[numbers_[i]] = hits_[i];
    sink(first_ + begin, tile->hits);
  });
}

void QuarteredRays::hand_over_occluded(const Executor& executor,
                                       View<std::uint8_t> occluded) const {
  for_each_tile(executor, [&](std::size_t begin, std::size_t end, std::size_t /*number*/) {
    for (std::size_t i = begin; i < end; ++i) occluded[first_ + begin + numbers_[i]] = occluded_[i];
  });
}

std::size_t QuarteredRays::bytes() const {
  return rays_.capacity_bytes() + numbers_.capacity_bytes() + starts_.capacity() * sizeof(Starts) +
         order_.bytes() + hits_.capacity_bytes() + occluded_.capacity_bytes() + spares_.bytes();
}

}  // namespace raysheaf
