#include "raysheaf/large_vector.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "base/aligned.h"

namespace raysheaf {
namespace {

constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;

std::align_val_t alignment_of(std::size_t bytes) {
  return std::align_val_t{bytes >= kLargePageBytes ? kLargePageBytes : kCacheLineBytes};
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment_of(bytes));
#if defined(__linux__)
  // A wish: nothing depends on whether it is granted.
  if (bytes >= kLargePageBytes) static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));
#endif
  return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
  ::operator delete(memory, alignment_of(bytes));
}

}  // namespace raysheaf
