// What threads of one loop may do to a word that they share.
#pragma once

#include <cstdint>

#include "base/host_device.h"

namespace raysheaf {

/// Looks first: where most items do not lower the word, few of them wait for each other.
template <class Word>
RAYSHEAF_HD inline void lower_to(Word* word, Word value) {
  static_assert(sizeof(Word) == 4 || sizeof(Word) == 8);
#ifdef __CUDA_ARCH__
  if (value < *static_cast<volatile Word*>(word)) {
    if constexpr (sizeof(Word) == 4) {
      atomicMin(reinterpret_cast<unsigned*>(word), static_cast<unsigned>(value));
    } else {
      atomicMin(reinterpret_cast<unsigned long long*>(word),
                static_cast<unsigned long long>(value));
    }
  }
#else
  Word seen = __atomic_load_n(word, __ATOMIC_RELAXED);
  while (value < seen && !__atomic_compare_exchange_n(word, &seen, value, true, __ATOMIC_RELAXED,
                                                      __ATOMIC_RELAXED)) {
  }
#endif
}

/// What other threads of the loop may be lowering.
template <class Word>
RAYSHEAF_HD inline Word seen_now(const Word* word) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile Word*>(word);
#else
  return __atomic_load_n(word, __ATOMIC_RELAXED);
#endif
}

/// Makes the word 1, which is 0 or 1 and which nobody reads before the loop has ended. Looks first.
RAYSHEAF_HD inline void raise_flag(std::uint32_t* word) {
#ifdef __CUDA_ARCH__
  volatile std::uint32_t* const at = word;
  if (*at == 0) *at = 1;
#else
  if (__atomic_load_n(word, __ATOMIC_RELAXED) == 0) __atomic_store_n(word, 1u, __ATOMIC_RELAXED);
#endif
}

/// Adds one; returns what was there. What the thread wrote before is seen by whoever is given a
/// later number.
RAYSHEAF_HD inline std::uint32_t arrive_at(std::uint32_t* counter) {
#ifdef __CUDA_ARCH__
  __threadfence();
  const std::uint32_t before = atomicAdd(counter, 1u);
  __threadfence();
  return before;
#else
  return __atomic_fetch_add(counter, 1u, __ATOMIC_ACQ_REL);
#endif
}

/// Adds to a sum that nobody reads before the loop has ended.
RAYSHEAF_HD inline void add_to(std::uint64_t* sum, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(sum), static_cast<unsigned long long>(value));
#else
  __atomic_fetch_add(sum, value, __ATOMIC_RELAXED);
#endif
}

}  // namespace raysheaf
