#include <algorithm>
#include <limits>

#include "exec/radix_sort.h"
#include "exec/scan.h"
#include "paper/order/order.h"
#include "paper/order/order_body.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Shorter runs, on average, are not worth compressing (docs/order.md).
constexpr std::size_t kLeastRun = 2;

void expect(bool holds, const char* sentence, const char* place) {
  if (!holds) throw Error(ErrorCode::kInvalidArgument, sentence, place);
}

void expect_countable(std::size_t size, const char* place) {
  expect(size <= std::numeric_limits<std::uint32_t>::max(), "more than 2^32 - 1 items", place);
}

auto head_flags(View<const std::uint32_t> keys) {
  return [first = keys.data](std::size_t ray) { return begins_chunk(first, ray); };
}

FlagCounts count_heads(const Executor& executor, View<const std::uint32_t> keys) {
  expect_countable(keys.size, "compress");
  return count_flags(executor, keys.size, head_flags(keys));
}

std::vector<std::uint32_t> numbers(const Executor& executor, std::size_t count) {
  std::vector<std::uint32_t> numbered(count);
  executor.for_each(count, kCopyGrain, [out = numbered.data()](std::size_t i) {
    out[i] = static_cast<std::uint32_t>(i);
  });
  return numbered;
}

/// The lengths of consecutive runs of the stream.
void measure_runs(const Executor& executor, Chunks& chunks) {
  chunks.sizes.resize(chunks.bases.size());
  executor.for_each_block(chunks.sizes.size(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
    const std::uint32_t* bases = chunks.bases.data();
    const std::size_t last = chunks.sizes.size() - 1;
    for (std::size_t i = begin; i < std::min(end, last); ++i)
      chunks.sizes[i] = bases[i + 1] - bases[i];
    if (end > last) chunks.sizes[last] = chunks.ray_count - bases[last];
  });
}

/// Writes the chunks whose heads were counted.
Chunks compress_at(const Executor& executor, View<const std::uint32_t> keys,
                   const FlagCounts& heads) {
  Chunks chunks;
  chunks.ray_count = static_cast<std::uint32_t>(keys.size);
  chunks.keys.resize(heads.total);
  chunks.bases.resize(heads.total);
  for_each_scanned(executor, heads, keys.size, head_flags(keys),
                   [in = keys.data, out_keys = chunks.keys.data(), bases = chunks.bases.data()](
                       std::size_t ray, bool is_head, std::uint32_t heads_up_to) {
                     if (!is_head) return;
                     out_keys[chunk_of_head(heads_up_to)] = in[ray];
                     bases[chunk_of_head(heads_up_to)] = static_cast<std::uint32_t>(ray);
                   });
  measure_runs(executor, chunks);
  return chunks;
}

/// The same order without chunks, which cost more than they save if few neighbours have equal keys.
void order_rays(const Executor& executor, View<const std::uint32_t> keys,
                View<std::uint32_t> permutation, std::uint32_t key_bits) {
  std::vector<std::uint32_t> sorted(keys.begin(), keys.end());
  std::vector<std::uint32_t> rays = numbers(executor, keys.size);
  radix_sort_pairs(executor, sorted, rays, key_bits);
  std::copy(rays.begin(), rays.end(), permutation.begin());
}

}  // namespace

Chunks compress(const Executor& executor, View<const std::uint32_t> keys) {
  return compress_at(executor, keys, count_heads(executor, keys));
}

void sort_chunks(const Executor& executor, Chunks& chunks, std::uint32_t key_bits) {
  const std::size_t count = chunks.keys.size();
  std::vector<std::uint32_t> from = numbers(executor, count);
  radix_sort_pairs(executor, chunks.keys, from, key_bits);
  std::vector<std::uint32_t> bases(count), sizes(count);
  executor.for_each(count, kCopyGrain, [&](std::size_t i) {
    bases[i] = chunks.bases[from[i]];
    sizes[i] = chunks.sizes[from[i]];
  });
  chunks.bases.swap(bases);
  chunks.sizes.swap(sizes);
}

void decompress(const Executor& executor, const Chunks& chunks, View<std::uint32_t> permutation) {
  expect(permutation.size == chunks.ray_count, "permutation and rays differ in number",
         "decompress");
  std::vector<std::uint32_t> starts(chunks.sizes.size());
  const std::uint32_t total = exclusive_scan(executor, chunks.sizes, starts);
  expect(total == chunks.ray_count, "the chunks do not cover all rays", "decompress");
  const auto count = static_cast<std::uint32_t>(starts.size());
  executor.for_each_block(total, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t chunk = chunk_at(starts.data(), count, static_cast<std::uint32_t>(begin));
    for (std::size_t place = begin; place < end; ++chunk) {
      const std::uint32_t skipped = static_cast<std::uint32_t>(place) - starts[chunk];
      const std::size_t length = std::min<std::size_t>(chunks.sizes[chunk] - skipped, end - place);
      std::uint32_t ray = chunks.bases[chunk] + skipped;
      for (const std::size_t stop = place + length; place < stop; ++place)
        permutation.data[place] = ray++;
    }
  });
}

std::uint32_t order_by_key(const Executor& executor, View<const std::uint32_t> keys,
                           View<std::uint32_t> permutation, std::uint32_t key_bits) {
  expect(permutation.size == keys.size, "permutation and keys differ in number", "order");
  const FlagCounts heads = count_heads(executor, keys);
  if (heads.total > keys.size / kLeastRun) {
    order_rays(executor, keys, permutation, key_bits);
    return heads.total;
  }
  Chunks chunks = compress_at(executor, keys, heads);
  sort_chunks(executor, chunks, key_bits);
  decompress(executor, chunks, permutation);
  return heads.total;
}

}  // namespace raysheaf
