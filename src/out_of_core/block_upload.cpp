#include "out_of_core/block_upload.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Devices load whole vectors, which must be aligned.
constexpr std::size_t kArrayAlignment = 256;

constexpr std::uint64_t aligned_up(std::uint64_t bytes) {
  return (bytes + kArrayAlignment - 1) / kArrayAlignment * kArrayAlignment;
}

/// Device memory per triangle in addition to the buffers: corners, flags and the tree
/// (object_tree/linear_tree.h) of one block, and its sort's scratch memory. kDeviceBaseBytes is a
/// constant part.
constexpr std::uint64_t kDeviceTriangleBytes = 36 + 1 + 145 + 16;
constexpr std::uint64_t kDeviceBaseBytes = std::uint64_t{1} << 20;
/// Streaming for fewer rays at once is too slow.
constexpr std::uint64_t kFewestRays = 1024;
constexpr std::uint32_t kFewestBuffers = 2;

std::string mebibytes(std::uint64_t bytes) {
  return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MiB";
}

}  // namespace

void BlockUpload::add(Array array, std::size_t bytes) {
  first_[array] = end_;
  end_ = aligned_up(end_ + bytes);
}

void BlockUpload::pack(std::byte* to) const {
  const auto copy = [&](Array array, const auto& column, std::size_t count) {
    if (count != 0) std::memcpy(to + first_[array], column.data(), count * sizeof column[0]);
  };
  copy(kPositions, block_.positions, block_.positions.size());
  copy(kCorners, block_.triangles, block_.triangles.size());
  copy(kIds, block_.prim_ids, block_.prim_ids.size());
  copy(kParts, block_.parts, block_.parts.size());
  copy(kSides, block_.sides, side_count());
}

BlockView BlockUpload::view(const std::byte* at, std::uint32_t number) const {
  BlockView block;
  block.number = number;
  block.positions = {reinterpret_cast<const Vec3*>(at + first_[kPositions]),
                     block_.positions.size()};
  block.corners = reinterpret_cast<const std::uint32_t*>(at + first_[kCorners]);
  block.prim_ids = {reinterpret_cast<const std::uint32_t*>(at + first_[kIds]),
                    block_.prim_ids.size()};
  block.parts = {reinterpret_cast<const BlockPart*>(at + first_[kParts]), block_.parts.size()};
  return block;
}

std::uint64_t most_upload_bytes(std::uint32_t triangles) {
  return aligned_up(std::uint64_t{kBlockVertices} * sizeof(Vec3)) +
         aligned_up(std::uint64_t{triangles} * 3 * sizeof(std::uint32_t)) +
         aligned_up(std::uint64_t{triangles} * sizeof(std::uint32_t)) +
         aligned_up(std::uint64_t{triangles} * sizeof(BlockPart)) + aligned_up(triangles);
}

BlockBudget budget_for(const BlockLimits& limits, std::uint64_t free_bytes) {
  const std::uint64_t room = std::min(limits.memory_bytes, free_bytes - free_bytes / 16);
  const std::uint64_t buffer = most_upload_bytes(limits.most_triangles);
  const std::uint64_t fixed =
      kDeviceBaseBytes + std::uint64_t{limits.most_triangles} * kDeviceTriangleBytes;
  const std::uint64_t least = fixed + kFewestBuffers * buffer + kFewestRays * kDeviceRayBytes;
  if (room < least)
    throw Error(ErrorCode::kOutOfMemory,
                "blocks of " + std::to_string(limits.most_triangles) + " triangles take at least " +
                    mebibytes(least) + ", but there are " + std::to_string(room >> 20) + " MiB",
                "the device's memory");
  BlockBudget budget;
  budget.buffers = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
      room / 4 / buffer, kFewestBuffers, std::max(limits.most_buffers, kFewestBuffers)));
  const std::uint64_t rays = (room - fixed - budget.buffers * buffer) / kDeviceRayBytes;
  budget.rays = std::min<std::uint64_t>(rays, std::numeric_limits<std::int32_t>::max());
  return budget;
}

}  // namespace raysheaf
