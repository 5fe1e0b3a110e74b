#include <algorithm>

#include "paper/order/key_body.h"
#include "paper/order/keys.h"
#include "paper/order/published_body.h"

namespace raysheaf {
namespace {

/// Ray `i` of the batch with the data for its key.
KeyedRay keyed_ray(const RayBatch& batch, std::size_t i) {
  KeyedRay r;
  r.ray = batch.rays[i];
  r.square = batch.places.empty() ? octahedral(r.ray.direction) : batch.places[i];
  r.pixel = batch.pixels[i];
  r.light = batch.lights.empty() ? 0 : batch.lights[i] - batch.lights.front();
  return r;
}

KeyContext context_for(const RayBatch& batch, RayKey key, std::uint32_t key_bits,
                       const Box& scene_bounds) {
  KeyContext context;
  context.cell = entry_of(key).cell;
  context.hilbert = entry_of(key).hilbert;
  context.cube = key_cube(scene_bounds);
  context.width = batch.width;
  std::uint32_t most_axis_bits = kMostAxisBits;
  if (context.cell == KeyCell::kPixel) {
    const std::uint32_t last = *std::max_element(batch.pixels.begin(), batch.pixels.end());
    context.pixel_bits = bits_for(std::max(batch.width, last / batch.width + 1));
    most_axis_bits = context.pixel_bits;
  }
  // Slots are sorted by light, so the first and the last ray have the first and last light.
  const std::uint32_t lights =
      batch.lights.empty() ? 1 : batch.lights.back() - batch.lights.front() + 1;
  context.layout = key_layout(lights, entry_of(key).axes, key_bits, most_axis_bits);
  return context;
}

std::uint32_t published_key(const RayBatch& batch, std::size_t i, bool as_coded) {
  const Ray& ray = batch.rays[i];
  if (batch.kind != RayKind::kShadow)
    return published_bounce_key(batch.kind, ray.origin, ray.direction, as_coded);
  return published_shadow_key(batch.lights[i], ray.direction, as_coded);
}

}  // namespace

std::vector<std::uint64_t> make_keys(const Executor& executor, const RayBatch& batch, RayKey key,
                                     std::uint32_t key_bits, const Box& scene_bounds,
                                     std::uint32_t* used_bits) {
  std::vector<std::uint64_t> keys(batch.rays.size());
  *used_bits = 0;
  if (key == RayKey::kRaster || keys.empty()) return keys;
  const auto fill = [&](const auto& key_of) {
    executor.for_each(keys.size(), kWorkGrain, [&](std::size_t i) { keys[i] = key_of(i); });
  };
  if (key == RayKey::kCrsh) {
    *used_bits = batch.key_bits;
    fill([&](std::size_t i) { return batch.keys[i]; });
  } else if (key == RayKey::kPublished || key == RayKey::kCorrected) {
    *used_bits = 32;
    fill([&](std::size_t i) { return published_key(batch, i, key == RayKey::kPublished); });
  } else {
    const KeyContext context = context_for(batch, key, key_bits, scene_bounds);
    *used_bits = context.layout.bits();
    fill([&](std::size_t i) { return curve_key(context, keyed_ray(batch, i)); });
  }
  return keys;
}

}  // namespace raysheaf
