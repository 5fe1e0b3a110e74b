#include "exec/executor.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <exception>
#include <latch>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/forks.h"
#include "exec/cancelled.h"

namespace raysheaf {
namespace {

std::uint32_t cores() {
  return static_cast<std::uint32_t>(std::max(1, oneapi::tbb::info::default_concurrency()));
}

/// How many threads the system can start, at most `wanted`. This must be known before oneTBB is
/// used: its workers start one another, and if one cannot be started, the process is terminated.
std::uint32_t startable(std::uint32_t wanted) {
  static std::mutex mutex;
  static const bool holds = (hold_over_forks(&mutex), true);
  static_cast<void>(holds);
  static std::uint32_t known = 1;
  const std::lock_guard lock(mutex);
  if (wanted <= known) return wanted;
  std::vector<std::thread> threads;
  threads.reserve(wanted);
  std::latch end(1);
  try {
    while (threads.size() + 1 < wanted) threads.emplace_back([&] { end.wait(); });
  } catch (const std::exception&) {
    // The system's limit is reached; the threads started so far count.
  }
  end.count_down();
  for (std::thread& thread : threads) thread.join();
  known = std::max(known, static_cast<std::uint32_t>(threads.size() + 1));
  return static_cast<std::uint32_t>(threads.size() + 1);
}

/// Returns `asked` if the system can start that many threads; for 0, up to the number of cores.
std::uint32_t thread_count(std::uint32_t asked) {
  const std::uint32_t count = startable(asked != 0 ? asked : cores());
  if (count < asked)
    throw Error(
        ErrorCode::kUnsupported,
        "the system starts no more than " + std::to_string(count) + " of " + std::to_string(asked),
        "threads");
  return count;
}

}  // namespace

namespace {

/// How many threads oneTBB may have. It obeys the least of several limits, so that a limit for each
/// pool would let a small one take the workers of a large one: there is one, which only grows.
class WorkerLimit {
 public:
  void raise(std::uint32_t threads) {
    if (threads <= threads_) return;
    // oneTBB makes room for workers once, at its first use.
    if (threads_ == 0) {
      const Control most(Control::max_allowed_parallelism, kMostThreads);
      oneapi::tbb::task_arena(2).initialize();
    }
    control_ = std::make_unique<Control>(Control::max_allowed_parallelism, threads);
    threads_ = threads;
  }

 private:
  using Control = oneapi::tbb::global_control;
  static constexpr std::size_t kMostThreads = 1024;  ///< ContextOptions::threads

  std::unique_ptr<Control> control_;
  std::uint32_t threads_ = 0;
};

}  // namespace

struct Executor::Pool {
  explicit Pool(std::uint32_t count) : arena(static_cast<int>(count)) {}

  oneapi::tbb::task_arena arena;
  const std::uint32_t made = fork_number();

  /// Returns null in a child of fork whose parent had a pool: oneTBB counts on workers that do not
  /// exist there.
  static std::shared_ptr<Pool> take(std::uint32_t count);
};

/// Takes a pool that no executor uses, or makes a new one. oneTBB 2021.8 keeps some memory of every
/// arena until the process ends, so arenas are reused: for each size there are as many as were ever
/// in use at once.
std::shared_ptr<Executor::Pool> Executor::Pool::take(std::uint32_t count) {
  struct Spares {
    std::mutex mutex;
    std::map<std::uint32_t, std::vector<std::unique_ptr<Pool>>> of_size;
    WorkerLimit limit;
    const std::uint32_t made = fork_number();
    Spares() { hold_over_forks(&mutex); }
  };
  static Spares* const spares = new Spares;  // outlives executors that are destroyed at exit
  if (spares->made != fork_number()) return nullptr;
  std::unique_ptr<Pool> pool;
  {
    const std::lock_guard lock(spares->mutex);
    spares->limit.raise(std::max(count, startable(cores())));
    std::vector<std::unique_ptr<Pool>>& unused = spares->of_size[count];
    if (!unused.empty()) {
      pool = std::move(unused.back());
      unused.pop_back();
    } else {
      unused.reserve(unused.capacity() + 1);  // so that returning a pool does not throw
    }
  }
  if (pool == nullptr) pool = std::make_unique<Pool>(count);
  const auto give_back = [count](Pool* given) {
    if (given->made != fork_number())
      return;  // leaked, because its workers exist only in the
               // parent
    const std::lock_guard lock(spares->mutex);
    spares->of_size[count].emplace_back(given);
  };
  return {pool.release(), give_back};
}

Executor::Executor(std::uint32_t threads)
    : threads_(thread_count(threads)), pool_(Pool::take(threads_)) {
  if (pool_ == nullptr) threads_ = 1;
}

Executor::Executor(std::shared_ptr<Pool> pool) : threads_(1), pool_(std::move(pool)) {}

Executor Executor::serial() {
  return Executor(std::shared_ptr<Pool>());
}

Executor Executor::borrowed() const {
  Executor same(std::shared_ptr<Pool>(std::shared_ptr<Pool>(), pool_.get()));
  same.threads_ = threads_;
  same.stop_ = stop_;
  same.alone_ = alone_;
  return same;
}

Executor Executor::until(const std::atomic<bool>& stop) const {
  Executor same = borrowed();
  same.stop_ = &stop;
  return same;
}

Executor Executor::alone() const {
  Executor same = borrowed();
  same.alone_ = true;
  return same;
}

void Executor::check() const {
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) throw cancelled();
}

void Executor::enter(void (*call)(const void* body), const void* body) const {
  if (pool_ == nullptr) return call(body);
  check_not_forked(pool_->made, "context");
  pool_->arena.execute([&] { call(body); });
}

void Executor::spread(std::size_t count, std::size_t grain, Block* block, const void* body) const {
  assert(grain > 0);  // otherwise a loop that can be stopped would not end
  const auto run = [&](std::size_t first, std::size_t last) {
    if (stop_ == nullptr) return block(body, first, last);
    // The range of a task may be long: check for cancellation after every `grain` items.
    for (std::size_t begin = first; begin < last; begin += grain) {
      check();
      block(body, begin, std::min(begin + grain, last));
    }
  };
  if (pool_ == nullptr) return run(0, count);
  check_not_forked(pool_->made, "context");
  const auto loop = [&] {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, count, grain),
                              [&](const Range& r) { run(r.begin(), r.end()); });
  };
  pool_->arena.execute([&] { alone_ ? oneapi::tbb::this_task_arena::isolate(loop) : loop(); });
}

}  // namespace raysheaf
