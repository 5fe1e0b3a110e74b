// Sorts keys and carries a value with each.
//
// Least significant digit first, with counts and places for every block of the input, so that all
// passes are parallel and stable (Satish, Harris, Garland 2009, "Designing Efficient Sorting
// Algorithms for Manycore GPUs", section 4). Work O(n) a digit; scratch of two pairs an item.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/executor.h"

namespace raysheaf {

/// Sorts ascending by the low `key_bits` bits of the keys; equal ones keep their order. `values[i]`
/// belongs to `keys[i]` before and after; higher bits of the keys are carried, not compared.
///
/// Digits cover the bits in which keys differ and no others: equal or sorted keys are left alone
/// after one look, and keys that take few values need few passes.
/// Throws Error, nothing changed, if the sizes differ or are 2^32 or more.
void radix_sort_pairs(const Executor& executor, std::vector<std::uint32_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits = 32);
void radix_sort_pairs(const Executor& executor, std::vector<std::uint64_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits = 64);

}  // namespace raysheaf
