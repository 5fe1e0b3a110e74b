// A vector for millions of results.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace raysheaf {

/// Allocates memory for `LargeAllocator`. Throws std::bad_alloc.
[[nodiscard]] void* allocate_large(std::size_t bytes);
void free_large(void* memory, std::size_t bytes) noexcept;

/// Allocates on cache lines; 2 MiB or more on large pages if the system has them, because for
/// memory that is written once and read once the first access to each page costs most. Elements
/// without an initial value stay uninitialized: `resize` touches no memory. Throws std::bad_alloc.
template <class T>
class LargeAllocator {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>&) {}  // NOLINT: rebinding

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_large(count * sizeof(T)));
  }
  void deallocate(T* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(T)); }

  template <class U>
  void construct(U* /*at*/) noexcept {}
  template <class U, class First, class... Others>
  void construct(U* at, First&& first, Others&&... others) {
    ::new (static_cast<void*>(at)) U(std::forward<First>(first), std::forward<Others>(others)...);
  }

  template <class U>
  bool operator==(const LargeAllocator<U>& /*other*/) const {
    return true;
  }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

}  // namespace raysheaf
