// Where stages run: a number of threads, and the verbs that spread work over them.
//
// The verbs are the same on every device: `for_each`, scans (exec/scan.h), radix sort
// (exec/radix_sort.h). Nothing that goes through them depends on the number of threads.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <cstdint>

namespace raysheaf {

/// Items a task: where each takes tens of nanoseconds or more, and where each is read or written
/// once.
inline constexpr std::size_t kWorkGrain = 1024, kCopyGrain = 4096;

class Executor {
 public:
  /// `threads` = 0 takes all cores that the process may use.
  explicit Executor(std::uint32_t threads = 0);

  [[nodiscard]] std::uint32_t threads() const { return threads_; }

  /// Calls `body(i)` once for each i in [0, count), in any order, `grain` or more of them a task.
  /// An exception from a body ends the loop and is thrown here.
  template <class Body>
  void for_each(std::size_t count, std::size_t grain, const Body& body) const {
    for_each_block(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  /// Calls `body(begin, end)` for disjoint ranges that make up [0, count), in any order.
  template <class Body>
  void for_each_block(std::size_t count, std::size_t grain, const Body& body) const {
    if (count == 0) return;
    if (count <= grain || threads_ == 1) return body(std::size_t{0}, count);
    arena_.execute([&] {
      using Range = oneapi::tbb::blocked_range<std::size_t>;
      oneapi::tbb::parallel_for(Range(0, count, grain),
                                [&](const Range& r) { body(r.begin(), r.end()); });
    });
  }

 private:
  std::uint32_t threads_;
  oneapi::tbb::global_control workers_;  // lets there be more threads than cores, where asked for
  mutable oneapi::tbb::task_arena arena_;
};

}  // namespace raysheaf
