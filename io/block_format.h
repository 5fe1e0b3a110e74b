// The bytes of block files (docs/block-files.md): sections, their packing, the scene part.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "io/file.h"
#include "raysheaf/stream.h"

namespace raysheaf::io {

// Numbers are stored as they lie in this machine's memory.
static_assert(std::endian::native == std::endian::little);

inline constexpr std::uint8_t kBlockMagic[8] = {0x89, 'R', 'S', 'B', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kBlockVersion = 1, kByteOrder = 0x01020304;

/// The first bytes of the file.
struct FileHead {
  std::uint8_t magic[8];
  std::uint32_t version, byte_order;
  std::uint64_t file_bytes, blocks, triangles;
  std::uint64_t index_offset, scene_offset, scene_bytes;
  std::uint64_t index_checksum, scene_checksum;
  std::uint64_t reserved;
  std::uint64_t head_checksum;  ///< of all bytes of the head before this field
};
static_assert(sizeof(FileHead) == 96);

/// The place and size of a section. It is compressed if `stored` is less than `bytes`.
struct SectionPlace {
  std::uint64_t offset;
  std::uint32_t stored, bytes;
  std::uint64_t checksum;  ///< of the stored bytes
};
static_assert(sizeof(SectionPlace) == 24);

/// One block's entry in the index.
struct BlockEntry {
  float min[3], max[3];
  std::uint32_t triangles, vertices;
  SectionPlace geometry, shading;
};
static_assert(sizeof(BlockEntry) == 80);

/// The largest size of a section.
inline constexpr std::uint32_t kMostSectionBytes = 4u << 20;

/// XXH3 with 64 bits and seed 0.
[[nodiscard]] std::uint64_t checksum(std::span<const std::uint8_t> bytes);

/// Zstandard, after splitting each group of four bytes into four planes. Empty if the result would
/// not be smaller.
[[nodiscard]] Bytes compressed(std::span<const std::uint8_t> bytes);
/// `out` already has the decompressed size. False if the stored bytes are damaged.
[[nodiscard]] bool decompress(std::span<const std::uint8_t> stored, Bytes* out);

[[nodiscard]] Bytes encode_geometry(const TriangleBlock& block);
[[nodiscard]] Bytes encode_shading(const BlockShading& shading);
/// These throw `Error` (kInvalidData, without a place) if sizes or counts contradict each other.
/// The contents themselves are not validated.
void decode_geometry(std::span<const std::uint8_t> bytes, TriangleBlock* block);
void decode_shading(std::span<const std::uint8_t> bytes, BlockShading* shading);

/// The scene without its triangles, as JSON followed by PNG images.
[[nodiscard]] Bytes encode_scene(const SceneDescription& scene);
/// Throws `Error` (kInvalidData) whose place is the field.
[[nodiscard]] SceneDescription decode_scene(std::span<const std::uint8_t> bytes);

template <class T>
std::span<const std::uint8_t> bytes_of(const T& object) {
  return {reinterpret_cast<const std::uint8_t*>(&object), sizeof object};
}

}  // namespace raysheaf::io
