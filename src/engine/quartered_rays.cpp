#include "engine/quartered_rays.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/bits.h"

namespace raysheaf {

template <class Body>
void QuarteredRays::for_each_tile(const Executor& executor, const Body& body) const {
  executor.for_each(div_ceil(rays_.size(), kTile), 1, [&](std::size_t number) {
    const std::size_t begin = number * kTile;
    body(begin, std::min(rays_.size(), begin + kTile), number);
  });
}

void QuarteredRays::take(const Executor& executor, const RaySource& rays) {
  rays_.resize_uninitialized(rays.size());
  places_.resize_uninitialized(rays.size());
  counts_.resize(div_ceil(rays.size(), kTile));
  for_each_tile(executor, [&](std::size_t begin, std::size_t end, std::size_t number) {
    const Borrowed<Tile> tile(spares_);
    tile->rays.resize_uninitialized(end - begin);
    tile->quarters.resize_uninitialized(end - begin);
    const View<const Ray> from = rays.take(begin, end, tile->rays.data());
    sort_tile(from, begin, tile->quarters.data(), &counts_[number]);
  });
  make_order(executor);
}

void QuarteredRays::sort_tile(View<const Ray> from, std::size_t begin, std::uint8_t* quarters,
                              Starts* counts) {
  find_quarters(from, quarters);
  *counts = {};
  for (std::size_t i = 0; i < from.size; ++i) ++(*counts)[quarters[i]];
  Starts next = *counts;
  std::exclusive_scan(next.begin(), next.end(), next.begin(), 0u);
  for (std::size_t i = 0; i < from.size; ++i) {
    const std::uint32_t place = next[quarters[i]]++;
    places_[begin + i] = static_cast<std::uint16_t>(place);
    rays_[begin + place] = from[i];
  }
}

void QuarteredRays::make_order(const Executor& executor) {
  order_.rays.resize_uninitialized(rays_.size());
  std::vector<Starts> places = counts_;
  std::uint32_t sum = 0;
  for (std::uint32_t q = 0; q < kQuarters; ++q) {
    order_.starts[q] = sum;
    for (Starts& tile : places) sum += std::exchange(tile[q], sum);
  }
  order_.starts[kQuarters] = sum;
  for_each_tile(executor, [&](std::size_t begin, std::size_t /*end*/, std::size_t number) {
    auto from = static_cast<std::uint32_t>(begin);
    for (std::uint32_t q = 0; q < kQuarters; ++q) {
      const std::uint32_t count = counts_[number][q];
      std::uint32_t* const out = order_.rays.data() + places[number][q];
      std::iota(out, out + count, from);
      from += count;
    }
  });
}

View<EngineHit> QuarteredRays::hits() {
  hits_.resize_uninitialized(rays_.size());
  return hits_;
}

View<std::uint8_t> QuarteredRays::occluded() {
  occluded_.resize_uninitialized(rays_.size());
  return occluded_;
}

void QuarteredRays::hand_over_hits(const Executor& executor, const HitSink& sink) {
  for_each_tile(executor, [&](std::size_t begin, std::size_t end, std::size_t /*number*/) {
    const Borrowed<Tile> tile(spares_);
    tile->hits.resize_uninitialized(end - begin);
    for (std::size_t i = begin; i < end; ++i) tile->hits[i - begin] = hits_[begin + places_[i]];
    sink(begin, tile->hits);
  });
}

void QuarteredRays::hand_over_occluded(const Executor& executor,
                                       View<std::uint8_t> occluded) const {
  for_each_tile(executor, [&](std::size_t begin, std::size_t end, std::size_t /*number*/) {
    for (std::size_t i = begin; i < end; ++i) occluded[i] = occluded_[begin + places_[i]];
  });
}

std::size_t QuarteredRays::bytes() const {
  return rays_.capacity_bytes() + places_.capacity_bytes() + counts_.capacity() * sizeof(Starts) +
         order_.bytes() + hits_.capacity_bytes() + occluded_.capacity_bytes() + spares_.bytes();
}

}  // namespace raysheaf
