#include "dual/stream.h"

#include <algorithm>
#include <cstring>
#include <new>

namespace raysheaf {

void Stream::grow_lists(std::size_t size) {
  if (size <= lists.size()) return;
  Buffer<std::uint32_t> larger;
  larger.resize_uninitialized(std::max(size, 2 * lists.size()));
  std::memcpy(larger.data(), lists.data(), lists.size() * sizeof(std::uint32_t));
  lists = std::move(larger);
}

std::unique_ptr<Stream> StreamPool::take() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!free_.empty()) {
      std::unique_ptr<Stream> stream = std::move(free_.back());
      free_.pop_back();
      return stream;
    }
  }
  return std::make_unique<Stream>();
}

void StreamPool::give(std::unique_ptr<Stream> stream) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    free_.push_back(std::move(stream));
  } catch (const std::bad_alloc&) {
    // Destructors give streams back: without room to keep it, it goes.
  }
}

std::size_t StreamPool::bytes() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::size_t sum = 0;
  for (const std::unique_ptr<Stream>& stream : free_) sum += stream->bytes();
  return sum;
}

}  // namespace raysheaf
