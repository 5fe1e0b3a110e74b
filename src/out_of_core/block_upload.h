// The upload of a block to a device: the layout of its arrays, and how many blocks and rays fit
// into a device's memory.
#pragma once

#include "out_of_core/block_body.h"
#include "out_of_core/block_tracer.h"

namespace raysheaf {

/// The positions of a block's arrays in its upload. Omits sides if both are visible.
class BlockUpload {
 public:
  BlockUpload(const TriangleBlock& block, Facing facing)
      : block_(block), with_sides_(facing != Facing::kBoth) {
    add(kPositions, block.positions.size() * sizeof(Vec3));
    add(kCorners, block.triangles.size() * sizeof block.triangles[0]);
    add(kIds, block.prim_ids.size() * sizeof block.prim_ids[0]);
    add(kParts, block.parts.size() * sizeof(BlockPart));
    add(kSides, side_count());
  }

  [[nodiscard]] std::size_t bytes() const { return end_; }
  /// Writes `bytes()` bytes.
  void pack(std::byte* to) const;
  /// The arrays of a packed block that was copied to `at`.
  [[nodiscard]] BlockView view(const std::byte* at, std::uint32_t number) const;
  /// Empty, one for all, or one for each triangle.
  [[nodiscard]] View<const std::uint8_t> sides(const std::byte* at) const {
    return {reinterpret_cast<const std::uint8_t*>(at + first_[kSides]), side_count()};
  }

 private:
  enum Array { kPositions, kCorners, kIds, kParts, kSides, kArrays };

  [[nodiscard]] std::size_t side_count() const { return with_sides_ ? block_.sides.size() : 0; }
  void add(Array array, std::size_t bytes);

  const TriangleBlock& block_;
  bool with_sides_;
  std::size_t first_[kArrays] = {};
  std::size_t end_ = 0;
};

/// The most bytes for a block of this many triangles.
[[nodiscard]] std::uint64_t most_upload_bytes(std::uint32_t triangles);

/// The most bytes of device memory per ray: while sorting, in addition to the input, and for its
/// hit.
inline constexpr std::uint64_t kDeviceRayBytes = 160;

/// The sizes that fit into a device.
struct BlockBudget {
  std::uint32_t buffers = 0;  ///< at least 2
  std::size_t rays = 0;       ///< at once
};
/// Throws Error (kOutOfMemory) if too little fits.
[[nodiscard]] BlockBudget budget_for(const BlockLimits& limits, std::uint64_t free_bytes);

}  // namespace raysheaf
