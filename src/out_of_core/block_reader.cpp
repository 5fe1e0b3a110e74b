#include "out_of_core/block_reader.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>

#include "base/vec.h"
#include "exec/stopwatch.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// One thread waits for the disk while the other decodes.
constexpr std::size_t kThreads = 2;

bool lies_in(const Box& inner, const Box& outer) {
  return min_component(min(inner.min - outer.min, outer.max - inner.max)) >= 0;
}

}  // namespace

void check_block(const GeometrySource& source, std::size_t number, const TriangleBlock& block) {
  const BlockInfo& info = source.blocks()[number];
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::kInvalidData, sentence, source.place(number));
  };
  try {
    validate(block);
  } catch (const Error& error) {
    refuse(error.place() + ": " + error.sentence());
  }
  if (block.triangles.size() != info.triangles)
    refuse("has " + std::to_string(block.triangles.size()) + " triangles, not " +
           std::to_string(info.triangles) + " as listed for it");
  if (!lies_in(bounds_of(block), info.bounds)) refuse("a vertex lies outside the block's bounds");
}

BlockReader::~BlockReader() {
  next_ = ~std::size_t{0} / 2;  // no more blocks
  for (std::future<void>& thread : threads_) thread.wait();
}

void BlockReader::start(std::vector<std::uint32_t> blocks, std::vector<TriangleBlock>* out) {
  blocks_ = std::move(blocks);
  out_ = out;
  next_ = 0;
  errors_.assign(blocks_.size(), nullptr);
  ms_.assign(blocks_.size(), 0);
  const auto work = [this] { read_some(); };
  try {
    while (threads_.size() < std::min(kThreads, blocks_.size()))
      threads_.push_back(std::async(std::launch::async, work));
  } catch (const std::system_error&) {
    // If no thread can be started, the waiting thread reads.
    if (threads_.empty()) threads_.push_back(std::async(std::launch::deferred, work));
  }
}

void BlockReader::read_some() {
  for (std::size_t i = next_++; i < blocks_.size(); i = next_++) {
    Stopwatch watch;
    try {
      read(i);
    } catch (...) {
      errors_[i] = std::current_exception();
    }
    ms_[i] = watch.lap_ms();
  }
}

void BlockReader::read(std::size_t i) {
  const std::uint32_t number = blocks_[i];
  source_.read(number, &(*out_)[i]);
  check_block(source_, number, (*out_)[i]);
}

double BlockReader::wait() {
  for (std::future<void>& thread : threads_) thread.wait();
  threads_.clear();
  for (const std::exception_ptr& error : errors_) {
    if (error) std::rethrow_exception(error);
  }
  return std::accumulate(ms_.begin(), ms_.end(), 0.0);
}

}  // namespace raysheaf
