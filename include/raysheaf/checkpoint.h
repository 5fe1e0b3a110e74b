// Streamed frames that were stopped, and go on (docs/stream.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "raysheaf/stream.h"

namespace raysheaf {

/// A batch of rays on its way past the blocks. The same batch has the same answers.
struct StreamBatch {
  std::uint32_t number = 0;    ///< in the frame, from 0
  std::uint32_t question = 0;  ///< which hits are asked for
  std::uint32_t part = 0, parts = 1;
  std::span<const Ray> rays;
  std::span<const BlockInfo> blocks;
};

/// Keeps what the batches of a frame have found. `StreamOptions::checkpoint`.
class StreamCheckpoint {
 public:
  StreamCheckpoint() = default;
  StreamCheckpoint(const StreamCheckpoint&) = delete;
  StreamCheckpoint& operator=(const StreamCheckpoint&) = delete;
  virtual ~StreamCheckpoint() = default;

  /// What was kept of this very batch: its answers after the blocks that are `done`, where it is 1.
  /// False, and nothing changed, where nothing was.
  [[nodiscard]] virtual bool restore(const StreamBatch& batch, std::span<std::byte> answers,
                                     std::span<std::uint8_t> done) = 0;
  /// Called after every few blocks, and `whole` after the last one.
  virtual void keep(const StreamBatch& batch, std::span<const std::byte> answers,
                    std::span<const std::uint8_t> done, bool whole) = 0;
};

/// One in a file, which grows by what each batch has found: 84 bytes a ray, or 1 a shadow ray.
/// What was written last and is not whole, or does not fit the batch, is passed over.
class CheckpointFile : public StreamCheckpoint {
 public:
  /// Reads what is there. `subject`: what the frame is of, beyond its rays and its blocks' bounds,
  /// such as the date of its file; what was kept under another one is passed over. Writes where
  /// the last time is `seconds` ago, or 50 times as long as that took. Throws `Error` (kIo).
  CheckpointFile(std::string path, std::string subject, double seconds = 1);
  ~CheckpointFile() override;

  [[nodiscard]] bool restore(const StreamBatch& batch, std::span<std::byte> answers,
                             std::span<std::uint8_t> done) override;
  void keep(const StreamBatch& batch, std::span<const std::byte> answers,
            std::span<const std::uint8_t> done, bool whole) override;
  /// The frame is done: the file goes.
  void remove();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
