// Memory for plain data that is written before it is read, and reused frame after frame.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include "raysheaf/large_vector.h"

namespace raysheaf {

/// Aligned to a cache line, or on large pages. It grows and never shrinks; elements are not
/// initialised.
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
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] std::size_t capacity_bytes() const { return capacity_ * sizeof(T); }
  T& operator[](std::size_t i) const { return memory_.get()[i]; }
  [[nodiscard]] T* begin() const { return data(); }
  [[nodiscard]] T* end() const { return data() + size_; }

 private:
  struct Free {
    std::size_t bytes = 0;
    void operator()(T* memory) const { free_large(memory, bytes); }
  };
  using Memory = std::unique_ptr<T[], Free>;

  static Memory allocate(std::size_t bytes) {
    return {static_cast<T*>(allocate_large(bytes)), Free{bytes}};
  }

  Memory memory_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// The same for few elements, in the scope where it is.
template <class T, std::size_t kCount>
class StackRoom {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  [[nodiscard]] T* data() { return reinterpret_cast<T*>(bytes_); }

 private:
  alignas(64) std::byte bytes_[kCount * sizeof(T)];
};

}  // namespace raysheaf
