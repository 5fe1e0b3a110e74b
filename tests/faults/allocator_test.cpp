#include "faults/allocator.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

namespace {

constexpr std::int64_t kNever = -1;
std::atomic<std::int64_t> left{kNever};  // allocations until one fails
std::atomic<bool> failed{false};
std::atomic<std::int64_t> live{0};

void* allocate(std::size_t bytes, std::size_t alignment) noexcept {
  if (left.load() >= 0 && left.fetch_sub(1) == 0) {
    failed = true;
    return nullptr;
  }
  void* memory = nullptr;
  if (bytes == 0) bytes = 1;
  if (alignment <= alignof(std::max_align_t))
    memory = std::malloc(bytes);
  else if (posix_memalign(&memory, alignment, bytes) != 0)
    memory = nullptr;
  if (memory != nullptr) ++live;
  return memory;
}

void* allocate_or_throw(std::size_t bytes, std::size_t alignment) {
  void* memory = allocate(bytes, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void release(void* memory) noexcept {
  if (memory == nullptr) return;
  --live;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t n) {
  return allocate_or_throw(n, 1);
}
void* operator new[](std::size_t n) {
  return allocate_or_throw(n, 1);
}
void* operator new(std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  return allocate(n, 1);
}
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept {
  return allocate(n, 1);
}
void operator delete(void* p) noexcept {
  release(p);
}
void operator delete[](void* p) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t) noexcept {
  release(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  release(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  release(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  release(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  release(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
  release(p);
}
void operator delete[](void* p, const std::nothrow_t&) noexcept {
  release(p);
}

namespace raysheaf::test {

std::int64_t live_allocations() {
  return live;
}

FailingAllocation::FailingAllocation(std::int64_t index) {
  failed = false;
  left = index;
}

FailingAllocation::~FailingAllocation() {
  left = kNever;
}

bool FailingAllocation::has_failed() const {
  return failed;
}

TEST(Allocator, FailsOnceAndCounts) {
  const std::int64_t before = live_allocations();
  {
    const FailingAllocation failing(1);
    const std::vector<int> first(10);
    EXPECT_FALSE(failing.has_failed());
    EXPECT_THROW(std::vector<int>(10), std::bad_alloc);
    EXPECT_TRUE(failing.has_failed());
    const std::vector<int> third(10);
    EXPECT_EQ(live_allocations(), before + 2);
  }
  EXPECT_EQ(live_allocations(), before);
}

}  // namespace raysheaf::test
