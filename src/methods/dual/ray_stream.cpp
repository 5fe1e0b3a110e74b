#include "methods/dual/ray_stream.h"

#include <algorithm>
#include <cstring>

#include "base/bits.h"

namespace raysheaf {

void RayStream::fit(std::uint32_t size) {
  if (size <= rays.size()) return;
  const std::size_t room = div_ceil(size, kBundleWidth) * kBundleWidth;
  rays.resize_uninitialized(room);
  index.resize_uninitialized(room);
  lists.resize_uninitialized(16 * room);
}

void RayStream::grow_lists(std::size_t size) {
  if (size <= lists.size()) return;
  Buffer<std::uint32_t> larger;
  larger.resize_uninitialized(std::max(size, 2 * lists.size()));
  std::memcpy(larger.data(), lists.data(), lists.size() * sizeof(std::uint32_t));
  lists = std::move(larger);
}

}  // namespace raysheaf
