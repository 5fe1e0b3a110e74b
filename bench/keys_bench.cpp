// The cost of computing a batch's keys, without sorting. Arguments: number of rays / threads / key
// bits.
#include <benchmark/benchmark.h>

#include <cmath>

#include "paper/order/keys.h"

namespace raysheaf {
namespace {

constexpr Box kBox{{-1, -1, -1}, {1, 1, 1}};

/// Rays that a wavy sheet reflects as if seen from above: rays that are close are close in the
/// stream.
RayBatch sheet_of_rays(std::size_t count) {
  RayBatch batch;
  batch.kind = RayKind::kReflection;
  batch.width = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
  const auto side = static_cast<float>(batch.width);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = 2 * static_cast<float>(i % batch.width) / side - 1;
    const float z = 2 * static_cast<float>(i / batch.width) / side - 1;
    batch.rays.push_back({{x, 0.1f * std::sin(20 * x), z}, 0, {x - std::cos(20 * x), 1, z}});
    batch.pixels.push_back(i);
    batch.keys.push_back(i);
  }
  return batch;
}

void keys(benchmark::State& state, RayKey key) {
  const RayBatch batch = sheet_of_rays(static_cast<std::size_t>(state.range(0)));
  const Executor executor(static_cast<std::uint32_t>(state.range(1)));
  std::uint32_t used_bits = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(make_keys(
        executor, batch, key, static_cast<std::uint32_t>(state.range(2)), kBox, &used_bits));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

int register_all() {
  for (int k = 0; k <= static_cast<int>(RayKey::kTwoPointHilbert); ++k) {
    const auto key = static_cast<RayKey>(k);
    benchmark::RegisterBenchmark(to_string(key), keys, key)
        ->ArgsProduct({{262144}, {1, 2}, {32, 64}})
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
  return 0;
}
[[maybe_unused]] const int kRegistered = register_all();

}  // namespace
}  // namespace raysheaf
