// Sorting as many rays as a shadow batch has, step by step, and the sort compared with
// alternatives. Arguments: number of rays / threads. Labels: the kind of keys.
#include <benchmark/benchmark.h>
#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "exec/radix_sort.h"
#include "exec/scan.h"
#include "paper/order/order.h"
#include "render/rays/raygen.h"

namespace raysheaf {
namespace {

using Words = std::vector<std::uint32_t>;

enum class Kind { kRandom, kCoarse, kBands, kSorted };

/// The coarse keys use five bits from here on.
constexpr std::uint32_t kField = 1u << 12;

/// Random: 32 random bits. Coarse: 32 values of one field, at random. Bands: the same 32 values in
/// runs of 64 rays, as in an image. Sorted: random ones in order.
template <Kind kKind>
Words make_keys(std::size_t count) {
  std::mt19937 random(7);
  Words keys(count);
  std::uint32_t band = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = static_cast<std::uint32_t>(random());
    if (i % 64 == 0) band = bits;
    keys[i] = kKind == Kind::kCoarse  ? (bits >> 27) * kField
              : kKind == Kind::kBands ? (band >> 27) * kField
                                      : bits;
  }
  if constexpr (kKind == Kind::kSorted) std::sort(keys.begin(), keys.end());
  return keys;
}

Words numbers(std::size_t count) {
  Words values(count);
  std::iota(values.begin(), values.end(), 0u);
  return values;
}

std::vector<std::uint64_t> packed(const Words& keys) {
  std::vector<std::uint64_t> pairs(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) pairs[i] = std::uint64_t{keys[i]} << 32 | i;
  return pairs;
}

std::size_t rays(const benchmark::State& state) {
  return static_cast<std::size_t>(state.range(0));
}
Executor executor_of(const benchmark::State& state) {
  return Executor(static_cast<std::uint32_t>(state.range(1)));
}
void count_rays(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

/// Times `work` on a fresh copy of `input` each time, without the time of copying.
template <class Input, class Work>
void time_on_copy(benchmark::State& state, const Input& input, const Work& work) {
  Input copy;
  for (auto _ : state) {
    state.PauseTiming();
    copy = input;
    state.ResumeTiming();
    work(copy);
    benchmark::ClobberMemory();
  }
  count_rays(state);
}

void scan(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Words in(rays(state), 1u);
  Words out(in.size());
  for (auto _ : state) benchmark::DoNotOptimize(exclusive_scan(executor, in, out));
  count_rays(state);
}

template <Kind kKind>
void sort_radix(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const std::pair<Words, Words> input(make_keys<kKind>(rays(state)), numbers(rays(state)));
  time_on_copy(state, input,
               [&](auto& pairs) { radix_sort_pairs(executor, pairs.first, pairs.second); });
}

template <Kind kKind>
void sort_radix_64(benchmark::State& state) {
  const Executor executor = executor_of(state);
  std::pair<std::vector<std::uint64_t>, Words> input(packed(make_keys<kKind>(rays(state))),
                                                     numbers(rays(state)));
  for (std::uint64_t& key : input.first) key *= 0x9e3779b97f4a7c15u;
  time_on_copy(state, input,
               [&](auto& pairs) { radix_sort_pairs(executor, pairs.first, pairs.second); });
}

template <Kind kKind>
void sort_std(benchmark::State& state) {
  time_on_copy(state, packed(make_keys<kKind>(rays(state))),
               [](auto& pairs) { std::sort(pairs.begin(), pairs.end()); });
}

template <Kind kKind>
void sort_std_stable(benchmark::State& state) {
  time_on_copy(state, packed(make_keys<kKind>(rays(state))), [](auto& pairs) {
    std::stable_sort(pairs.begin(), pairs.end(), [](auto a, auto b) { return a >> 32 < b >> 32; });
  });
}

template <Kind kKind>
void sort_vqsort(benchmark::State& state) {
  const hwy::Sorter sorter;
  time_on_copy(state, packed(make_keys<kKind>(rays(state))),
               [&](auto& pairs) { sorter(pairs.data(), pairs.size(), hwy::SortAscending()); });
}

void trim_slots(benchmark::State& state) {
  const Executor executor = executor_of(state);
  std::mt19937 random(7);
  std::vector<std::uint8_t> empty(rays(state));
  for (std::uint8_t& flag : empty) flag = random() % 16 == 0 ? 1 : 0;
  for (auto _ : state) benchmark::DoNotOptimize(trim(executor, empty));
  count_rays(state);
}

template <Kind kKind>
void compress_rays(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Words keys = make_keys<kKind>(rays(state));
  for (auto _ : state) benchmark::DoNotOptimize(compress(executor, keys));
  count_rays(state);
}

template <Kind kKind>
void sort_compressed(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Words keys = make_keys<kKind>(rays(state));
  time_on_copy(state, compress(executor, keys),
               [&](Chunks& chunks) { sort_chunks(executor, chunks); });
}

template <Kind kKind>
void decompress_rays(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Words keys = make_keys<kKind>(rays(state));
  Chunks chunks = compress(executor, keys);
  sort_chunks(executor, chunks);
  Words permutation(rays(state));
  for (auto _ : state) {
    decompress(executor, chunks, permutation);
    benchmark::ClobberMemory();
  }
  count_rays(state);
}

template <Kind kKind>
void whole_order(benchmark::State& state) {
  const Executor executor = executor_of(state);
  const Words keys = make_keys<kKind>(rays(state));
  Words permutation(rays(state));
  for (auto _ : state) benchmark::DoNotOptimize(order_by_key(executor, keys, permutation));
  count_rays(state);
}

constexpr std::int64_t kRays = 512 * 512;

void one_and_two(benchmark::internal::Benchmark* bench) {
  bench->Args({kRays, 1})->Args({kRays, 2})->Unit(benchmark::kMicrosecond)->UseRealTime();
}
void one(benchmark::internal::Benchmark* bench) {
  bench->Args({kRays, 1})->Unit(benchmark::kMicrosecond)->UseRealTime();
}

#define RAYSHEAF_BENCH_KINDS(function, threads)       \
  BENCHMARK(function<Kind::kRandom>)->Apply(threads); \
  BENCHMARK(function<Kind::kCoarse>)->Apply(threads); \
  BENCHMARK(function<Kind::kBands>)->Apply(threads);  \
  BENCHMARK(function<Kind::kSorted>)->Apply(threads)

BENCHMARK(scan)->Apply(one_and_two);
BENCHMARK(trim_slots)->Apply(one_and_two);
RAYSHEAF_BENCH_KINDS(sort_radix, one_and_two);
BENCHMARK(sort_radix_64<Kind::kRandom>)->Apply(one_and_two);
RAYSHEAF_BENCH_KINDS(sort_std, one);
RAYSHEAF_BENCH_KINDS(sort_std_stable, one);
RAYSHEAF_BENCH_KINDS(sort_vqsort, one);
RAYSHEAF_BENCH_KINDS(compress_rays, one_and_two);
RAYSHEAF_BENCH_KINDS(sort_compressed, one_and_two);
RAYSHEAF_BENCH_KINDS(decompress_rays, one_and_two);
RAYSHEAF_BENCH_KINDS(whole_order, one_and_two);

}  // namespace
}  // namespace raysheaf
