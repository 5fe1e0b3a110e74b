// Memory of an emulated device that only the device can access while it works. If code on the host
// follows a device pointer, the process crashes at once, as with a real device.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <map>
#include <mutex>
#include <new>

#include "emulated/emulated_device.h"

namespace raysheaf::test {

/// Pages of one range, which is inaccessible except during a device's work.
class GuardedMemory : public HostAllocator {
 public:
  explicit GuardedMemory(std::uint64_t capacity = std::uint64_t{1} << 40)
      : HostAllocator(capacity) {
    void* const all =
        mmap(nullptr, kRoom, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED) throw std::bad_alloc();
    begin_ = static_cast<std::byte*>(all);
  }
  ~GuardedMemory() override { munmap(begin_, kRoom); }

  void open() override {
    const std::lock_guard<std::mutex> lock(guard_);
    if (works_++ == 0) protect(PROT_READ | PROT_WRITE);
  }
  void close() noexcept override {
    const std::lock_guard<std::mutex> lock(guard_);
    if (--works_ == 0) protect(PROT_NONE);
  }

 protected:
  void* take(std::size_t bytes) override {
    const std::lock_guard<std::mutex> lock(guard_);
    const std::size_t pages = whole_pages(bytes);
    if (const auto kept = kept_.find(pages); kept != kept_.end()) {
      std::byte* const place = kept->second;
      kept_.erase(kept);
      return place;
    }
    if (kRoom - used_ < pages) throw std::bad_alloc();
    std::byte* const place = begin_ + used_;
    used_ += pages;
    if (works_ != 0) protect(PROT_READ | PROT_WRITE);
    return place;
  }
  void give_back(void* memory, std::size_t bytes) noexcept override {
    const std::lock_guard<std::mutex> lock(guard_);
    madvise(memory, whole_pages(bytes), MADV_DONTNEED);
    kept_.emplace(whole_pages(bytes), static_cast<std::byte*>(memory));
  }

 private:
  static constexpr std::size_t kRoom = std::size_t{1} << 36;
  static std::size_t whole_pages(std::size_t bytes) {
    static const auto kPage = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    return (bytes + kPage - 1) / kPage * kPage;
  }
  void protect(int access) noexcept {
    if (used_ != 0) static_cast<void>(mprotect(begin_, used_, access));
  }

  std::mutex guard_;
  std::byte* begin_ = nullptr;
  std::size_t used_ = 0;
  int works_ = 0;
  std::multimap<std::size_t, std::byte*> kept_;  // by size
};

/// Lets a test access a device's memory.
class Reach {
 public:
  explicit Reach(HostAllocator& memory) : memory_(memory) { memory_.open(); }
  Reach(const Reach&) = delete;
  Reach& operator=(const Reach&) = delete;
  ~Reach() { memory_.close(); }

 private:
  HostAllocator& memory_;
};

}  // namespace raysheaf::test
