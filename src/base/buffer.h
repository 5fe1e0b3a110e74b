// Memory for plain data that is written before it is read, and used again frame after frame.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "base/aligned.h"

namespace raysheaf {

/// Buffers of this size or more start on one, and ask the system for pages as large: what is
/// scattered over many small ones spends its time looking them up.
inline constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;

/// On a cache line; grows and never shrinks; elements are not initialised.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// `count` elements of unknown content.
  void resize_uninitialized(std::size_t count) {
    if (count > capacity_) {
      memory_.reset();
      capacity_ = 0;
      memory_ = allocate(count * sizeof(T));
      capacity_ = count;
    }
    size_ = count;
  }
  [[nodiscard]] T* data() const { return memory_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity_bytes() const { return capacity_ * sizeof(T); }
  T& operator[](std::size_t i) const { return memory_.get()[i]; }
  [[nodiscard]] T* begin() const { return data(); }
  [[nodiscard]] T* end() const { return data() + size_; }

 private:
  struct Free {
    std::align_val_t alignment{kCacheLineBytes};
    void operator()(T* p) const { ::operator delete(p, alignment); }
  };
  using Memory = std::unique_ptr<T[], Free>;

  static Memory allocate(std::size_t bytes) {
    const bool large = bytes >= kLargePageBytes;
    const std::align_val_t alignment{large ? kLargePageBytes : kCacheLineBytes};
    Memory memory(static_cast<T*>(::operator new(bytes, alignment)), Free{alignment});
#if defined(__linux__)
    // A wish: nothing depends on whether it is granted.
    if (large) static_cast<void>(madvise(memory.get(), bytes, MADV_HUGEPAGE));
#endif
    return memory;
  }

  Memory memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace raysheaf
