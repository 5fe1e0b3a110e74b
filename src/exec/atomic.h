// Atomic operations on words that the threads of one loop share.
#pragma once

#include <cstdint>

#ifdef __CUDACC__
#include <cooperative_groups.h>
#include <cooperative_groups/reduce.h>

#include <cuda/atomic>
#endif

#include "base/host_device.h"

namespace raysheaf {

/// Reads before the atomic operation: if most items do not lower the word, few threads wait for
/// each other.
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

/// Reads a word that other threads of the loop may be lowering.
template <class Word>
RAYSHEAF_HD inline Word seen_now(const Word* word) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile Word*>(word);
#else
  return __atomic_load_n(word, __ATOMIC_RELAXED);
#endif
}

/// Sets the word, which is 0 or 1, to 1. No thread may read it before the loop has ended. Reads it
/// first to avoid needless writes.
RAYSHEAF_HD inline void raise_flag(std::uint32_t* word) {
#ifdef __CUDA_ARCH__
  volatile std::uint32_t* const at = word;
  if (*at == 0) *at = 1;
#else
  if (__atomic_load_n(word, __ATOMIC_RELAXED) == 0) __atomic_store_n(word, 1u, __ATOMIC_RELAXED);
#endif
}

/// Adds one and returns the previous value. A thread that gets a later number sees everything that
/// this thread wrote before.
RAYSHEAF_HD inline std::uint32_t arrive_at(std::uint32_t* counter) {
#ifdef __CUDA_ARCH__
  return cuda::atomic_ref<std::uint32_t, cuda::thread_scope_device>(*counter).fetch_add(
      1u, cuda::memory_order_acq_rel);
#else
  return __atomic_fetch_add(counter, 1u, __ATOMIC_ACQ_REL);
#endif
}

/// Stores a word for the next thread; returns the previous one. The thread that receives a word
/// sees all writes that came before it.
RAYSHEAF_HD inline std::uint32_t exchange_at(std::uint32_t* place, std::uint32_t word) {
#ifdef __CUDA_ARCH__
  return cuda::atomic_ref<std::uint32_t, cuda::thread_scope_device>(*place).exchange(
      word, cuda::memory_order_acq_rel);
#else
  return __atomic_exchange_n(place, word, __ATOMIC_ACQ_REL);
#endif
}

/// Adds to a sum that no thread reads before the loop has ended.
RAYSHEAF_HD inline void add_to(std::uint64_t* sum, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  atomicAdd(reinterpret_cast<unsigned long long*>(sum), static_cast<unsigned long long>(value));
#else
  __atomic_fetch_add(sum, value, __ATOMIC_RELAXED);
#endif
}

/// Adds to a sum to which most threads add: the threads of a warp that arrive here together add
/// once.
RAYSHEAF_HD inline void add_to_common(std::uint64_t* sum, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  const auto here = cooperative_groups::coalesced_threads();
  const std::uint64_t all =
      cooperative_groups::reduce(here, value, cooperative_groups::plus<std::uint64_t>());
  if (here.thread_rank() == 0) add_to(sum, all);
#else
  add_to(sum, value);
#endif
}

}  // namespace raysheaf
