#include "exec/executor.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::uint32_t cores() {
  return static_cast<std::uint32_t>(std::max(1, oneapi::tbb::info::default_concurrency()));
}

}  // namespace

struct Executor::Pool {
  explicit Pool(std::uint32_t count)
      : workers(oneapi::tbb::global_control::max_allowed_parallelism, std::max(count, cores())),
        arena(static_cast<int>(count)) {}

  oneapi::tbb::global_control workers;  // lets there be more than cores, where asked for
  oneapi::tbb::task_arena arena;
};

Executor::Executor(std::uint32_t threads)
    : threads_(threads != 0 ? threads : cores()), pool_(std::make_shared<Pool>(threads_)) {}

Executor::Executor(std::shared_ptr<Pool> pool) : threads_(1), pool_(std::move(pool)) {}

Executor Executor::serial() {
  return Executor(std::shared_ptr<Pool>());
}

Executor Executor::until(const std::atomic<bool>& stop) const {
  Executor same = *this;
  same.stop_ = &stop;
  return same;
}

void Executor::check() const {
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed))
    throw Error(ErrorCode::kCancelled, "the caller asked to stop");
}

void Executor::spread(std::size_t count, std::size_t grain, Block* block, const void* body) const {
  const auto run = [&](std::size_t first, std::size_t last) {
    if (stop_ == nullptr) return block(body, first, last);
    // Ranges may be long.
    for (std::size_t begin = first; begin < last; begin += grain) {
      check();
      block(body, begin, std::min(begin + grain, last));
    }
  };
  if (pool_ == nullptr) return run(0, count);
  pool_->arena.execute([&] {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, count, grain),
                              [&](const Range& r) { run(r.begin(), r.end()); });
  });
}

}  // namespace raysheaf
