// Memory of a device. It is allocated through an allocator that is passed in, so that tests can
// make it run out, and freed by its owner.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "base/view.h"

namespace raysheaf {

/// The source of a device's memory.
class DeviceAllocator {
 public:
  virtual ~DeviceAllocator() = default;

  /// Allocates `bytes`, at least 1, aligned for any vector of a device. Throws Error (kOutOfMemory)
  /// with the message of the source that is exhausted, and with `stage` as its place.
  [[nodiscard]] virtual void* allocate(const char* stage, std::size_t bytes) = 0;
  /// Frees memory that queued work may still use: it is reused only after that work.
  virtual void free(void* memory) noexcept = 0;
};

/// It grows and never shrinks; elements are not initialised, and are lost when it grows. The
/// allocator must outlive it.
template <class T>
class DeviceBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  explicit DeviceBuffer(DeviceAllocator& allocator) : allocator_(&allocator) {}
  DeviceBuffer(DeviceBuffer&& other) noexcept
      : allocator_(other.allocator_),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~DeviceBuffer() { release(); }

  void swap(DeviceBuffer& other) noexcept {
    std::swap(allocator_, other.allocator_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  /// `count` elements of unknown content. If memory runs out, throws as the allocator does, and the
  /// buffer is empty.
  void resize_uninitialized(const char* stage, std::size_t count) {
    size_ = 0;
    if (count > capacity_) {
      release();
      data_ = static_cast<T*>(allocator_->allocate(stage, count * sizeof(T)));
      capacity_ = count;
    }
    size_ = count;
  }
  void release() noexcept {
    if (data_ != nullptr) allocator_->free(data_);
    data_ = nullptr;
    size_ = capacity_ = 0;
  }

  [[nodiscard]] T* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity_bytes() const { return capacity_ * sizeof(T); }
  [[nodiscard]] View<T> view() const { return {data_, size_}; }
  [[nodiscard]] View<const T> view_const() const { return {data_, size_}; }

 private:
  DeviceAllocator* allocator_;
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace raysheaf
