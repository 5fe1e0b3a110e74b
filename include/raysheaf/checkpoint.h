// Checkpoints: streamed frames that continue after an interruption (docs/stream.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "raysheaf/stream.h"

namespace raysheaf {

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

}  // namespace raysheaf
