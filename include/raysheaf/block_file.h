// Scenes in blocks as files: `.rsb` (docs/stream.md describes every byte).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "raysheaf/stream.h"

namespace raysheaf {

/// A block file, opened. Takes memory for the list of blocks, 112 bytes each, and for the scene
/// without its triangles. Blocks are read with one system call each; nothing is mapped, so that
/// memory is what the caller holds.
class BlockFile : public GeometrySource {
 public:
  /// Reads and checks all but the blocks. Throws `Error` whose place is the file: kNotFound, kIo,
  /// kUnsupported for a newer version, kInvalidData for anything else.
  explicit BlockFile(const std::string& path);
  ~BlockFile() override;

  [[nodiscard]] std::span<const BlockInfo> blocks() const override;
  /// Throw `Error`: kIo where the file cannot be read or has become shorter, kInvalidData where
  /// bytes have changed; the place is the file and the block.
  void read(std::size_t block, TriangleBlock* out) const override;
  void read_shading(std::size_t block, BlockShading* out) const override;
  [[nodiscard]] const SceneDescription& scene() const override;
  [[nodiscard]] std::string place(std::size_t block) const override;

  [[nodiscard]] std::uint64_t triangle_count() const;
  [[nodiscard]] std::uint64_t file_bytes() const;
  [[nodiscard]] bool compressed() const;  ///< any block of it

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct BlockFileOptions {
  bool compress = false;  ///< by Zstandard, where that makes a block smaller
};

/// Whether this build reads and writes compressed blocks.
[[nodiscard]] bool can_compress_blocks();

/// Writes a block file as blocks come, beside its name; `finish` renames it. Without `finish`
/// nothing is left behind. Memory: a block, and 80 bytes for each that was written.
class BlockFileWriter : public BlockSink {
 public:
  /// Throws `Error`: kIo where nothing can be written there, kUnsupported for compression in a
  /// build without it.
  explicit BlockFileWriter(const std::string& path, const BlockFileOptions& options = {});
  ~BlockFileWriter() override;

  /// From one thread at a time. Throws `Error`: kInvalidData for a block that is not as
  /// `TriangleBlock` and `BlockShading` say, kIo.
  void add(const TriangleBlock& block, const BlockShading& shading) override;
  /// `scene`: what `GeometrySource::scene` shall give. Throws `Error` as `validate`
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
