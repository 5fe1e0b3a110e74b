#include "paper/order/ray_order.h"

#include <numeric>

#include "exec/radix_sort.h"
#include "paper/order/keys.h"
#include "paper/order/order.h"

namespace raysheaf {
namespace {

/// The number of runs of equal keys.
std::uint64_t run_count(const std::vector<std::uint64_t>& keys) {
  std::uint64_t runs = keys.empty() ? 0 : 1;
  for (std::size_t i = 1; i < keys.size(); ++i) runs += keys[i] != keys[i - 1] ? 1 : 0;
  return runs;
}

}  // namespace

std::vector<std::uint32_t> ray_order(const Executor& executor, const RayBatch& batch,
                                     const Box& scene_bounds, const MethodSettings& method,
                                     BatchStatistics* statistics) {
  std::vector<std::uint32_t> order(batch.rays.size());
  if (method.key == RayKey::kCrsh) {
    statistics->chunks += order_by_key(executor, batch.keys, order, batch.key_bits);
    return order;
  }
  std::iota(order.begin(), order.end(), 0u);
  if (method.key == RayKey::kRaster) return order;
  std::uint32_t used_bits = 0;
  std::vector<std::uint64_t> keys =
      make_keys(executor, batch, method.key, method.key_bits, scene_bounds, &used_bits);
  if (used_bits > 32) {
    statistics->chunks += run_count(keys);
    radix_sort_pairs(executor, keys, order, used_bits);
    return order;
  }
  std::vector<std::uint32_t> low(keys.size());
  executor.for_each(keys.size(), kCopyGrain,
                    [&](std::size_t i) { low[i] = static_cast<std::uint32_t>(keys[i]); });
  statistics->chunks += order_by_key(executor, low, order, used_bits);
  return order;
}

}  // namespace raysheaf
