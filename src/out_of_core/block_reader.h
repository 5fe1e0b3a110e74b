// Blocks read, decoded and looked over while others are traced.
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

  /// Begins to read `blocks` into the first of `out`, which has as many at least, and must stay
  /// until `wait` or as long as this does. Nothing else may be under way.
  void start(std::vector<std::uint32_t> blocks, std::vector<TriangleBlock>* out);
  /// Until all of them are there. Throws what the first of them that failed did. Gives the
  /// milliseconds that the reading threads worked.
  double wait();

 private:
  void read_some();
  void read(std::size_t i);

  const GeometrySource& source_;
  std::vector<std::uint32_t> blocks_;
  std::vector<TriangleBlock>* out_ = nullptr;
  std::atomic<std::size_t> next_{0};
  std::vector<std::exception_ptr> errors_;  ///< a block each
  std::vector<double> ms_;                  ///< a block each
  std::vector<std::future<void>> threads_;
};

/// Throws `Error` (kInvalidData) with the block's place where it is not as `GeometrySource` says.
void check_block(const GeometrySource& source, std::size_t number, const TriangleBlock& block);

}  // namespace raysheaf
