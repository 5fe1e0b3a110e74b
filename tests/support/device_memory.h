// An allocator of device memory that counts allocations and fails on request.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "exec/device.h"

namespace raysheaf::test {

/// Forwards to another allocator. After `let(n)`, the n-th allocation and all later ones fail.
class FailingAllocator : public DeviceAllocator {
 public:
  static constexpr std::uint64_t kAlways = ~std::uint64_t{0};

  explicit FailingAllocator(DeviceAllocator& under) : under_(under) {}

  void let(std::uint64_t allocations) { left_ = allocations; }
  [[nodiscard]] std::uint64_t made() const { return made_; }
  /// The number of allocations that were not freed.
  [[nodiscard]] std::size_t alive() const { return alive_.size(); }

  [[nodiscard]] void* allocate(const char* stage, std::size_t bytes) override {
    if (left_ == 0)
      throw Error(ErrorCode::kOutOfMemory, "CUDA says: out of memory (a test's)", stage);
    if (left_ != kAlways) --left_;
    ++made_;
    void* const memory = under_.allocate(stage, bytes);
    alive_.insert(memory);
    return memory;
  }
  void free(void* memory) noexcept override {
    alive_.erase(memory);
    under_.free(memory);
  }

 private:
  DeviceAllocator& under_;
  std::uint64_t left_ = kAlways, made_ = 0;
  std::set<void*> alive_;
};

template <class Device, class T>
DeviceBuffer<T> to_device(Device& device, const std::vector<T>& items) {
  DeviceBuffer<T> buffer(device.allocator());
  buffer.resize_uninitialized("test", items.size());
  device.copy("test", buffer.data(), items.data(), items.size() * sizeof(T));
  return buffer;
}

template <class Device, class T>
std::vector<T> to_host(Device& device, View<T> view, std::size_t count) {
  std::vector<T> items(count);
  device.copy("test", items.data(), view.data, count * sizeof(T));
  device.synchronize("test");
  return items;
}
template <class Device, class T>
std::vector<T> to_host(Device& device, const DeviceBuffer<T>& buffer) {
  return to_host(device, buffer.view(), buffer.size());
}

}  // namespace raysheaf::test
