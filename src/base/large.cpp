#include "base/large.h"

#include "raysheaf/large_vector.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "base/aligned.h"

namespace raysheaf {
namespace {

constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;

bool is_large(std::size_t bytes) {
  return bytes >= kLargePageBytes;
}

void* allocate_fresh(std::size_t bytes) {
  const auto alignment = std::align_val_t{is_large(bytes) ? kLargePageBytes : kCacheLineBytes};
  void* memory = ::operator new(bytes, alignment);
#if defined(__linux__)
  // A wish: nothing depends on whether it is granted.
  if (is_large(bytes)) static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE));
#endif
  return memory;
}

/// Large blocks that wait for who needs them next.
class SpareBlocks {
 public:
  void add_keeper() {
    const std::lock_guard lock(mutex_);
    ++keepers_;
  }
  void remove_keeper() {
    const std::lock_guard lock(mutex_);
    if (--keepers_ > 0) return;
    while (!spare_.empty()) release_oldest();
    lent_.clear();
    lent_bytes_ = most_lent_ = 0;
  }

  [[nodiscard]] void* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (keepers_ == 0) return allocate_fresh(bytes);
    auto best = spare_.end();
    for (auto block = spare_.begin(); block != spare_.end(); ++block) {
      const bool fits = block->bytes >= bytes;
      if (fits && (best == spare_.end() || block->bytes < best->bytes)) best = block;
    }
    // A frame's blocks differ from the last one's by a little: there is room for that.
    Block block{nullptr, (bytes + bytes / 8 + kLargePageBytes - 1) & ~(kLargePageBytes - 1)};
    if (best != spare_.end()) {
      block = *best;
      spare_.erase(best);
      spare_bytes_ -= block.bytes;
    } else {
      block.memory = allocate_fresh(block.bytes);
    }
    try {
      lent_[block.memory] = block.bytes;
    } catch (const std::bad_alloc&) {
      free_now(block.memory);
      throw;
    }
    lent_bytes_ += block.bytes;
    most_lent_ = std::max(most_lent_, lent_bytes_);
    return block.memory;
  }

  void give_back(void* memory) noexcept {
    const std::lock_guard lock(mutex_);
    const auto lent = lent_.find(memory);
    if (lent == lent_.end()) return free_now(memory);  // from before there was a keeper
    const Block block{memory, lent->second};
    lent_.erase(lent);
    lent_bytes_ -= block.bytes;
    try {
      spare_.push_back(block);
    } catch (const std::bad_alloc&) {
      return free_now(memory);
    }
    spare_bytes_ += block.bytes;
    while (spare_bytes_ > most_lent_) release_oldest();
  }

 private:
  struct Block {
    void* memory;
    std::size_t bytes;
  };

  static void free_now(void* memory) {
    ::operator delete (memory, std::align_val_t{kLargePageBytes});
  }
  void release_oldest() {
    spare_bytes_ -= spare_.front().bytes;
    free_now(spare_.front().memory);
    spare_.erase(spare_.begin());
  }

  std::mutex mutex_;
  int keepers_ = 0;
  std::vector<Block> spare_;  ///< the oldest first
  std::unordered_map<void*, std::size_t> lent_;
  std::size_t spare_bytes_ = 0, lent_bytes_ = 0, most_lent_ = 0;
};

/// Never destroyed: memory is given back until the very end of a program.
SpareBlocks& spare_blocks() {
  static SpareBlocks* const kBlocks = new SpareBlocks;
  return *kBlocks;
}

}  // namespace

LargeMemoryKeeper::LargeMemoryKeeper() {
  spare_blocks().add_keeper();
}
LargeMemoryKeeper::~LargeMemoryKeeper() {
  spare_blocks().remove_keeper();
}

void* allocate_large(std::size_t bytes) {
  return is_large(bytes) ? spare_blocks().take(bytes) : allocate_fresh(bytes);
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (memory == nullptr) return;
  if (is_large(bytes)) return spare_blocks().give_back(memory);
  ::operator delete (memory, std::align_val_t{kCacheLineBytes});
}

}  // namespace raysheaf
