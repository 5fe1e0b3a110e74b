#include "dual/stream.h"

#include <algorithm>
#include <cstring>

namespace raysheaf {

void Stream::grow_lists(std::size_t size) {
  if (size <= lists.size()) return;
  Buffer<std::uint32_t> larger;
  larger.resize_uninitialized(std::max(size, 2 * lists.size()));
  std::memcpy(larger.data(), lists.data(), lists.size() * sizeof(std::uint32_t));
  lists = std::move(larger);
}

}  // namespace raysheaf
