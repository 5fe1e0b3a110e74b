// Files of streamed rendering: scenes in blocks, `.rsb` (docs/block-files.md describes every byte),
// cut from files without holding them in memory, and checkpoints, from which interrupted frames
// continue (docs/stream.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "raysheaf/cameras.h"
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

/// Identifies a batch of rays that the blocks stream past. The same batch has the same answers.
struct StreamBatch {
  std::uint32_t number = 0;    ///< its number in the frame, from 0
  std::uint32_t question = 0;  ///< which kind of hits the rays ask for
  std::uint32_t part = 0, parts = 1;
  std::span<const Ray> rays;
  std::span<const BlockInfo> blocks;
};

/// Stores the intermediate answers of a frame's batches. See `StreamOptions::checkpoint`.
class StreamCheckpoint {
 public:
  StreamCheckpoint() = default;
  StreamCheckpoint(const StreamCheckpoint&) = delete;
  StreamCheckpoint& operator=(const StreamCheckpoint&) = delete;
  virtual ~StreamCheckpoint() = default;

  /// Restores the answers of exactly this batch, after the blocks whose `done` is 1. Returns false
  /// and changes nothing if none are stored.
  [[nodiscard]] virtual bool restore(const StreamBatch& batch, std::span<std::byte> answers,
                                     std::span<std::uint8_t> done) = 0;
  /// Called after every few blocks, and with `whole` after the last one.
  virtual void keep(const StreamBatch& batch, std::span<const std::byte> answers,
                    std::span<const std::uint8_t> done, bool whole) = 0;
};

/// A checkpoint in a file, which grows by the answers of each batch: 84 bytes per ray, 1 per shadow
/// ray. Reading skips an incomplete last entry and entries that do not fit the batch.
class CheckpointFile : public StreamCheckpoint {
 public:
  /// Reads the existing file, if any. `subject` identifies the frame beyond its rays and its
  /// blocks' bounds, for example by the date of the scene's file; entries of a different subject
  /// are skipped. Writes when the last write was `seconds` ago, or 50 times as long ago as that
  /// write took, whichever is later. Throws `Error` (kIo).
  CheckpointFile(std::string path, std::string subject, double seconds = 1);
  ~CheckpointFile() override;

  [[nodiscard]] bool restore(const StreamBatch& batch, std::span<std::byte> answers,
                             std::span<std::uint8_t> done) override;
  void keep(const StreamBatch& batch, std::span<const std::byte> answers,
            std::span<const std::uint8_t> done, bool whole) override;
  /// Deletes the file when the frame is complete.
  void remove();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct PackOptions {
  std::uint32_t triangles_a_block = kBlockTriangles;  ///< 1 to `kBlockTriangles`
  /// Triangles held in memory at once, about 250 bytes each, but at least `triangles_a_block`. The
  /// blocks do not depend on it.
  std::uint32_t triangles_at_once = 1u << 19;
  /// Temporary files are created without a name in the folder of this file; docs/stream.md states
  /// their size.
  std::string beside;
  bool allow_external = false;  ///< as `LoadOptions::allow_external`
  bool add_light = true;        ///< if the scene has none
  /// The added camera: if the scene has none or, with `add_camera`, after its own cameras.
  Viewpoint viewpoint = {};
  bool add_camera = false;
};

/// Produces the same blocks and the same scene as `cut_into_blocks` of the result of `load_scene`,
/// in memory that does not grow with the meshes. Supports binary STL with more than
/// `triangles_at_once` triangles, and binary PLY and glTF (with its buffers) of more than 16 bytes
/// for each of those. Images, materials, nodes and JSON are held in memory. Returns nothing for all
/// other files and for files that must be read as a whole (docs/stream.md); in this case nothing
/// was added to `sink`. Throws `Error`: as `load_scene` does, kIo for temporary files, and the
/// sink's errors.
[[nodiscard]] std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf
