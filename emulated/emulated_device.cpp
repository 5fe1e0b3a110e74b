#include "emulated/emulated_device.h"

#include <algorithm>
#include <memory>
#include <new>
#include <numeric>

#include "base/aligned.h"

namespace raysheaf {
namespace {

/// The alignment of CUDA's allocations: devices load whole vectors, and the threads of a warp load
/// from one aligned segment.
constexpr std::align_val_t kAlignment{256};

template <class Key>
Key bits_of(Key key, BitRange bits) {
  if (bits.begin >= bits.end) return 0;
  const std::uint32_t width = bits.end - bits.begin;
  const Key low = key >> bits.begin;
  return width >= std::numeric_limits<Key>::digits ? low : low & ((Key{1} << width) - 1);
}

}  // namespace

void* HostAllocator::allocate(const char* stage, std::size_t bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (bytes > free_) throw Error(ErrorCode::kOutOfMemory, "there is not enough memory", stage);
  try {
    const auto give = [&](void* memory) { give_back(memory, bytes); };
    std::unique_ptr<void, decltype(give)> memory(take(bytes), give);
    sizes_.emplace(static_cast<const std::uint8_t*>(memory.get()), bytes);
    free_ -= bytes;
    return memory.release();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory", stage);
  }
}

void HostAllocator::free(void* memory) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto at = sizes_.find(static_cast<const std::uint8_t*>(memory));
  free_ += at->second;
  give_back(memory, at->second);
  sizes_.erase(at);
}

void* HostAllocator::take(std::size_t bytes) {
  return ::operator new(bytes, kAlignment);
}
void HostAllocator::give_back(void* memory, std::size_t /*bytes*/) noexcept {
  ::operator delete(memory, kAlignment);
}

std::uint64_t HostAllocator::free_bytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return free_;
}

bool HostAllocator::owns(const void* pointer) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto* const at = static_cast<const std::uint8_t*>(pointer);
  auto after = sizes_.upper_bound(at);
  if (after == sizes_.begin()) return false;
  --after;
  return at < after->first + after->second;
}

void EmulatedDevice::exclusive_scan(const char* stage, View<const std::uint32_t> in,
                                    View<std::uint64_t> out) {
  const Lap lap(*this, stage);
  check_item_count(stage, out.size);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < in.size; ++i) {
    out[i] = sum;
    sum += in[i];
  }
  out[in.size] = sum;
}

std::uint32_t EmulatedDevice::select(const char* stage, View<const std::uint8_t> flags,
                                     View<std::uint32_t> out) {
  const Lap lap(*this, stage);
  check_item_count(stage, flags.size);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < flags.size; ++i)
    if (flags[i] != 0) out[count++] = static_cast<std::uint32_t>(i);
  return count;
}

/// Sorts into the spare columns and then swaps them, as CUB does, so that code that reads the wrong
/// column gets wrong numbers here, too.
template <class Key>
void EmulatedDevice::sort(const char* stage, SortColumns<Key>* columns, BitRange bits) {
  const Lap lap(*this, stage);
  const std::size_t count = columns->keys.size();
  check_item_count(stage, count);
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  const Key* keys = columns->keys.data();
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return bits_of(keys[a], bits) < bits_of(keys[b], bits);
  });
  const bool with_values = columns->values.size() != 0;
  for (std::size_t i = 0; i < count; ++i) {
    columns->spare_keys.data()[i] = keys[order[i]];
    if (with_values) columns->spare_values.data()[i] = columns->values.data()[order[i]];
  }
  columns->keys.swap(columns->spare_keys);
  columns->values.swap(columns->spare_values);
}

void EmulatedDevice::sort_pairs(const char* stage, SortColumns<std::uint32_t>* columns,
                                BitRange bits) {
  sort(stage, columns, bits);
}
void EmulatedDevice::sort_pairs(const char* stage, SortColumns<std::uint64_t>* columns,
                                BitRange bits) {
  sort(stage, columns, bits);
}
void EmulatedDevice::sort_keys(const char* stage, SortColumns<std::uint64_t>* columns,
                               BitRange bits) {
  sort(stage, columns, bits);
}

std::uint32_t EmulatedDevice::run_lengths(const char* stage, View<const std::uint32_t> keys,
                                          RunColumns out) {
  const Lap lap(*this, stage);
  check_item_count(stage, keys.size);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < keys.size; ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) {
      out.keys[count] = keys[i];
      out.lengths[count++] = 0;
    }
    ++out.lengths[count - 1];
  }
  return count;
}

}  // namespace raysheaf
