// Stores the state of a batch of rays that blocks stream past, for a later run.
#pragma once

#include <algorithm>
#include <vector>

#include "raysheaf/block_file.h"

namespace raysheaf {

/// Does nothing if `file` is null. `answers` are the batch's, and change during the run.
class BatchCheckpoint {
 public:
  BatchCheckpoint(const StreamBatch& batch, StreamCheckpoint* file, std::span<std::byte> answers)
      : batch_(batch),
        file_(file),
        answers_(answers),
        done_(file != nullptr ? batch.blocks.size() : 0) {}

  /// Returns whether there were stored answers.
  bool restore() { return file_ != nullptr && file_->restore(batch_, answers_, done_); }
  [[nodiscard]] bool is_done(std::size_t block) const {
    return !done_.empty() && done_[block] != 0;
  }
  [[nodiscard]] bool is_kept() const { return file_ != nullptr; }
  void keep(const std::vector<std::uint32_t>& round, bool last) {
    if (file_ == nullptr) return;
    for (const std::uint32_t block : round) done_[block] = 1;
    if (last) std::fill(done_.begin(), done_.end(), std::uint8_t{1});
    file_->keep(batch_, answers_, done_, last);
  }

 private:
  StreamBatch batch_;
  StreamCheckpoint* file_;
  std::span<std::byte> answers_;
  std::vector<std::uint8_t> done_;  ///< of each block
};

}  // namespace raysheaf
