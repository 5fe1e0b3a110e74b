// Reads, decodes and validates blocks while others are traced.
#pragma once

#include <atomic>
#include <exception>
#include <future>
#include <vector>

#include "raysheaf/stream.h"

namespace raysheaf {

class BlockReader {
 public:
  explicit BlockReader(const GeometrySource& source) : source_(source) {}
  ~BlockReader();
  BlockReader(const BlockReader&) = delete;
  BlockReader& operator=(const BlockReader&) = delete;

  /// Starts reading `blocks` into the first elements of `out`, which must have at least as many,
  /// and must exist until `wait` returns or this object is destroyed. No other read may be in
  /// progress.
  void start(std::vector<std::uint32_t> blocks, std::vector<TriangleBlock>* out);
  /// Waits until all of them are read. Throws the error of the first that failed. Returns the
  /// milliseconds that the reading threads worked.
  double wait();

 private:
  void read_some();
  void read(std::size_t i);

  const GeometrySource& source_;
  std::vector<std::uint32_t> blocks_;
  std::vector<TriangleBlock>* out_ = nullptr;
  std::atomic<std::size_t> next_{0};
  std::vector<std::exception_ptr> errors_;  ///< one for each block
  std::vector<double> ms_;                  ///< one for each block
  std::vector<std::future<void>> threads_;
};

/// Throws `Error` (kInvalidData) with the block's place if it violates the rules of
/// `GeometrySource`.
void check_block(const GeometrySource& source, std::size_t number, const TriangleBlock& block);

}  // namespace raysheaf
