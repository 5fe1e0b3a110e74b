#include "base/large.h"

#include "raysheaf/large_vector.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <mutex>
#include <new>
#include <unordered_map>
#include <vector>

#include "base/aligned.h"
#include "base/forks.h"
#include "system/process.h"

namespace raysheaf {
namespace {

constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;
constexpr std::size_t kFewestKeptBytes = std::size_t{64} << 10;
/// Small enough that twice the number, rounded up to a power of two, still is a std::size_t.
constexpr std::size_t kMostBytes = std::numeric_limits<std::size_t>::max() / 4;

bool is_large(std::size_t bytes) {
  return bytes >= kLargePageBytes;
}
bool is_kept(std::size_t bytes) {
  return bytes >= kFewestKeptBytes;
}

std::align_val_t alignment_of(std::size_t bytes) {
  return std::align_val_t{is_large(bytes) ? kLargePageBytes : kCacheLineBytes};
}

void* allocate_fresh(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment_of(bytes));
  if (is_large(bytes)) system::advise_large_pages(memory, bytes);
  return memory;
}
void free_now(void* memory, std::size_t bytes) noexcept {
  ::operator delete(memory, alignment_of(bytes));
}

/// Unused blocks of memory, kept for the next allocation.
class SpareBlocks {
 public:
  SpareBlocks() { hold_over_forks(&mutex_); }

  void add_keeper() {
    const std::lock_guard lock(mutex_);
    ++keepers_;
  }
  void remove_keeper() {
    const std::lock_guard lock(mutex_);
    while (!spare_.empty()) release_oldest();
    if (--keepers_ == 0) {
      std::vector<Block>().swap(spare_);
      std::unordered_map<void*, Block>().swap(lent_);
      lent_bytes_ = 0;
    }
    most_lent_ = lent_bytes_;
  }

  [[nodiscard]] void* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (keepers_ == 0) return allocate_fresh(bytes);
    auto best = spare_.end();
    for (auto block = spare_.begin(); block != spare_.end(); ++block)
      if (has_room(*block, bytes) && (best == spare_.end() || suits_better(*block, *best, bytes)))
        best = block;
    Block block;
    if (best != spare_.end()) {
      block = *best;
      spare_.erase(best);
      spare_bytes_ -= block.used;
    } else {
      block = fresh_block(bytes);
    }
    block.used = std::max(block.used, bytes);
    try {
      lent_[block.memory] = block;
    } catch (const std::bad_alloc&) {
      free_now(block.memory, block.room);
      throw;
    }
    lent_bytes_ += block.used;
    most_lent_ = std::max(most_lent_, lent_bytes_);
    return block.memory;
  }

  void give_back(void* memory, std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    const auto lent = lent_.find(memory);
    if (lent == lent_.end()) return free_now(memory, bytes);  // allocated before a keeper existed
    const Block block = lent->second;
    lent_.erase(lent);
    lent_bytes_ -= block.used;
    try {
      spare_.push_back(block);
    } catch (const std::bad_alloc&) {
      return free_now(memory, block.room);
    }
    spare_bytes_ += block.used;
    while (spare_bytes_ > most_lent_) release_oldest();
  }

 private:
  /// Pages cost time when they are first touched, not when they are allocated.
  struct Block {
    void* memory = nullptr;
    std::size_t room = 0;
    std::size_t used = 0;  ///< bytes from the beginning that any owner has touched
  };

  /// A large block replaces only large ones, because `give_back` receives the number of bytes
  /// requested, which must yield the alignment with which the block was allocated.
  static bool has_room(const Block& block, std::size_t bytes) {
    return block.room >= bytes && is_large(block.room) == is_large(bytes);
  }
  /// Prefers the smallest block that needs no new pages, or else the one that needs the fewest.
  static bool suits_better(const Block& a, const Block& b, std::size_t bytes) {
    const bool a_is_warm = a.used >= bytes, b_is_warm = b.used >= bytes;
    if (a_is_warm != b_is_warm) return a_is_warm;
    return a_is_warm ? a.used < b.used : a.used > b.used;
  }
  /// Allocates room for growth: a frame that needs more memory than the previous one then touches
  /// new pages only for the difference.
  static Block fresh_block(std::size_t bytes) {
    const std::size_t twice = std::bit_ceil(2 * bytes);
    const std::size_t room = is_large(bytes) ? twice : std::min(twice, kLargePageBytes - 1);
    try {
      return {allocate_fresh(room), room, 0};
    } catch (const std::bad_alloc&) {
      return {allocate_fresh(bytes), bytes, 0};  // the address space may be limited
    }
  }
  void release_oldest() {
    spare_bytes_ -= spare_.front().used;
    free_now(spare_.front().memory, spare_.front().room);
    spare_.erase(spare_.begin());
  }

  std::mutex mutex_;
  int keepers_ = 0;
  std::vector<Block> spare_;  ///< oldest first
  std::unordered_map<void*, Block> lent_;
  std::size_t spare_bytes_ = 0, lent_bytes_ = 0, most_lent_ = 0;
};

/// Never destroyed: memory may be freed until the very end of the program.
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
  if (bytes > kMostBytes) throw std::bad_alloc();
  return is_kept(bytes) ? spare_blocks().take(bytes) : allocate_fresh(bytes);
}

void free_large(void* memory, std::size_t bytes) noexcept {
  if (memory == nullptr) return;
  if (is_kept(bytes)) return spare_blocks().give_back(memory, bytes);
  free_now(memory, bytes);
}

}  // namespace raysheaf
