// The bytes of block files (docs/stream.md): sections of blocks, their packing, the scene part.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "io/file.h"
#include "raysheaf/stream.h"

namespace raysheaf::io {

// What is stored is what this machine has in memory.
static_assert(std::endian::native == std::endian::little);

inline constexpr std::uint8_t kBlockMagic[8] = {0x89, 'R', 'S', 'B', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kBlockVersion = 1, kByteOrder = 0x01020304;

/// At the start of the file.
struct FileHead {
  std::uint8_t magic[8];
  std::uint32_t version, byte_order;
  std::uint64_t file_bytes, blocks, triangles;
  std::uint64_t index_offset, scene_offset, scene_bytes;
  std::uint64_t index_checksum, scene_checksum;
  std::uint64_t reserved;
  std::uint64_t head_checksum;  ///< of all before it
};
static_assert(sizeof(FileHead) == 96);

/// Where a section is, and what it must be. Compressed where `stored` is less than `bytes`.
struct SectionPlace {
  std::uint64_t offset;
  std::uint32_t stored, bytes;
  std::uint64_t checksum;  ///< of what is stored
};
static_assert(sizeof(SectionPlace) == 24);

/// A block in the index.
struct BlockEntry {
  float min[3], max[3];
  std::uint32_t triangles, vertices;
  SectionPlace geometry, shading;
};
static_assert(sizeof(BlockEntry) == 80);

/// No section of any block is longer.
inline constexpr std::uint32_t kMostSectionBytes = 4u << 20;

/// XXH3, 64 bits, seed 0.
[[nodiscard]] std::uint64_t checksum(std::span<const std::uint8_t> bytes);

/// By Zstandard, the bytes of each four in planes of their own; empty where that is no smaller.
[[nodiscard]] Bytes compressed(std::span<const std::uint8_t> bytes);
/// `out` has the size that it must get. False where the bytes are not as they should be.
[[nodiscard]] bool decompress(std::span<const std::uint8_t> stored, Bytes* out);

[[nodiscard]] Bytes encode_geometry(const TriangleBlock& block);
[[nodiscard]] Bytes encode_shading(const BlockShading& shading);
/// Throw `Error` (kInvalidData, no place) for sizes and counts that cannot be. Contents are not
/// looked over.
void decode_geometry(std::span<const std::uint8_t> bytes, TriangleBlock* block);
void decode_shading(std::span<const std::uint8_t> bytes, BlockShading* shading);

/// The scene without triangles, as JSON and PNG.
[[nodiscard]] Bytes encode_scene(const SceneDescription& scene);
/// Throws `Error` (kInvalidData) whose place is the field.
[[nodiscard]] SceneDescription decode_scene(std::span<const std::uint8_t> bytes);

template <class T>
std::span<const std::uint8_t> bytes_of(const T& object) {
  return {reinterpret_cast<const std::uint8_t*>(&object), sizeof object};
}

}  // namespace raysheaf::io
