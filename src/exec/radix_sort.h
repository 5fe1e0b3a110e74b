// Sorts keys, and moves a value with each.
//
// Least significant digit first; each digit is a pass of exec/bucket_sort.h. O(n) work per digit;
// scratch memory of two pairs per item.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/executor.h"

namespace raysheaf {

/// Sorts ascending by the low `key_bits` bits of the keys; equal keys keep their order. `values[i]`
/// belongs to `keys[i]` before and after; higher bits of the keys are kept, but not compared.
///
/// Digits cover only the bits in which keys differ: equal or sorted keys are detected in one pass
/// and left unchanged, and keys with few distinct values need few passes. Throws Error and changes
/// nothing if the sizes differ or are 2^32 or more.
void radix_sort_pairs(const Executor& executor, std::vector<std::uint32_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits = 32);
void radix_sort_pairs(const Executor& executor, std::vector<std::uint64_t>& keys,
                      std::vector<std::uint32_t>& values, std::uint32_t key_bits = 64);

}  // namespace raysheaf
