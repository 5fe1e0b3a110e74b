// Scenes in blocks as files: `.rsb` (docs/block-files.md describes every byte).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "raysheaf/stream.h"

namespace raysheaf {

/// An open block file. Memory: 112 bytes for each block, and the scene without its triangles. Each
/// block is read with one system call; nothing is memory-mapped, so only the caller's buffers hold
/// triangles.
class BlockFile : public GeometrySource {
 public:
  /// Reads and validates everything except the blocks. Throws `Error` whose place is the file:
  /// kNotFound, kIo, kUnsupported for a newer version, kInvalidData for anything else.
  explicit BlockFile(const std::string& path);
  ~BlockFile() override;

  [[nodiscard]] std::span<const BlockInfo> blocks() const override;
  /// Throw `Error` whose place is the file and the block: kIo if the file cannot be read or has
  /// been truncated, kInvalidData if its bytes have changed.
  void read(std::size_t block, TriangleBlock* out) const override;
  void read_shading(std::size_t block, BlockShading* out) const override;
  [[nodiscard]] const SceneDescription& scene() const override;
  [[nodiscard]] std::string place(std::size_t block) const override;

  [[nodiscard]] std::uint64_t triangle_count() const;
  [[nodiscard]] std::uint64_t file_bytes() const;
  [[nodiscard]] bool compressed() const;  ///< whether any block is compressed

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct BlockFileOptions {
  bool compress = false;  ///< by Zstandard, for each block that this makes smaller
};

/// Whether this build reads and writes compressed blocks.
[[nodiscard]] bool can_compress_blocks();

/// Writes blocks to a temporary file in the same folder, which `finish` renames. Without `finish`
/// no file remains. Memory: one block, and 80 bytes for each block written.
class BlockFileWriter : public BlockSink {
 public:
  /// Throws `Error`: kIo if the file cannot be created, kUnsupported for compression in a build
  /// without it.
  explicit BlockFileWriter(const std::string& path, const BlockFileOptions& options = {});
  ~BlockFileWriter() override;

  /// Call it from one thread at a time. Throws `Error`: kInvalidData for a block that violates the
  /// rules of `TriangleBlock` and `BlockShading`, kIo.
  void add(const TriangleBlock& block, const BlockShading& shading) override;
  /// `scene`: the scene that `GeometrySource::scene` will return. Throws `Error` as `validate`
  /// does, kUnsupported for an environment, and kIo.
  void finish(const SceneDescription& scene);

  [[nodiscard]] std::uint64_t triangle_count() const;
  [[nodiscard]] std::uint64_t block_count() const;
  [[nodiscard]] std::uint64_t written_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
