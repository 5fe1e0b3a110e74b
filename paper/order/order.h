// Sorts rays by key: compress, sort, decompress. `trim` (render/rays/raygen.h) comes before.
//
// Rays that are near in space are often near in the stream, too, so runs of equal keys are sorted
// instead of rays (Garanzha & Loop 2010, "Fast Ray Sorting and Breadth-First Packet Traversal for
// GPU Ray Tracing", section 3; Reis, Costa, Pereira 2017, "Coherent Ray-Space Hierarchy via Ray
// Hashing and Sorting", section 3). docs/order.md has drawings and measurements.
//
// All steps take O(n) work. Results do not depend on the number of threads. Counts are below 2^32.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

/// Runs of equal keys, one chunk per run. In the order of the stream the bases ascend from 0 and
/// each run ends where the next begins; in any order the runs cover [0, ray_count) and none is
/// empty.
struct Chunks {
  std::vector<std::uint32_t> keys, bases, sizes;  ///< a run's key, its first ray, its length
  std::uint32_t ray_count = 0;
};

/// The longest possible runs of `keys`, in the order of the stream.
Chunks compress(const Executor& executor, View<const std::uint32_t> keys);

/// Sorts the chunks by the low `key_bits` bits of their keys; equal ones keep their order.
void sort_chunks(const Executor& executor, Chunks& chunks, std::uint32_t key_bits = 32);

/// Writes the rays of all chunks consecutively: `permutation[i]` is the ray at place i. Throws
/// Error if the sizes do not sum to `ray_count` or the permutation has another size.
void decompress(const Executor& executor, const Chunks& chunks, View<std::uint32_t> permutation);

/// Compresses, sorts and decompresses: `permutation` becomes the stable order of the rays by the
/// low `key_bits` bits of their keys. If runs are shorter than two rays on average, the rays are
/// sorted directly, with the same result. Returns the number of runs; throws Error if sizes differ.
std::uint32_t order_by_key(const Executor& executor, View<const std::uint32_t> keys,
                           View<std::uint32_t> permutation, std::uint32_t key_bits = 32);

}  // namespace raysheaf
