// Where stages run: a number of threads, and the verbs that spread work over them.
//
// The verbs are the same on every device: `for_each`, scans (exec/scan.h), radix sort
// (exec/radix_sort.h). Nothing that goes through them depends on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace raysheaf {

/// Items a task: where each takes tens of nanoseconds or more, and where each is read or written
/// once.
inline constexpr std::size_t kWorkGrain = 1024, kCopyGrain = 4096;

/// A handle: copies share their threads.
class Executor {
 public:
  /// `threads` = 0 takes all cores that the process may use, as far as the system starts threads.
  /// Throws `Error` (kUnsupported) where it starts fewer than `threads`. In a child of fork whose
  /// parent had threads, the caller does all the work; loops of the parent's executors throw
  /// `Error` (kWrongState) there.
  explicit Executor(std::uint32_t threads = 0);

  /// Whoever calls does all the work: for loops within the body of another's.
  [[nodiscard]] static Executor serial();

  /// The same threads. Loops throw `Error` (kCancelled) soon after another thread has set `stop`,
  /// which must outlive what is returned.
  [[nodiscard]] Executor until(const std::atomic<bool>& stop) const;

  /// The same threads. Who waits for the end of a loop takes no part in others: for callers that
  /// hold what bodies of others may wait for.
  [[nodiscard]] Executor alone() const;

  /// Throws where `until`'s flag is set.
  void check() const;

  [[nodiscard]] std::uint32_t threads() const { return threads_; }

  /// Calls `body()` as one of the threads, which need not be the caller's. Loops within it wait for
  /// no place among them: whoever has one may wait for what `body` holds.
  template <class Body>
  void enter(const Body& body) const {
    if (threads_ == 1) return body();
    enter([](const void* of) { (*static_cast<const Body*>(of))(); }, &body);
  }

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
    if (count <= grain || (threads_ == 1 && stop_ == nullptr)) return body(std::size_t{0}, count);
    spread(
        count, grain,
        [](const void* of, std::size_t begin, std::size_t end) {
          (*static_cast<const Body*>(of))(begin, end);
        },
        &body);
  }

 private:
  struct Pool;  ///< oneTBB's, which is seen by executor.cpp alone
  using Block = void(const void* body, std::size_t begin, std::size_t end);
  explicit Executor(std::shared_ptr<Pool> pool);
  void enter(void (*call)(const void* body), const void* body) const;
  void spread(std::size_t count, std::size_t grain, Block* block, const void* body) const;

  std::uint32_t threads_;
  std::shared_ptr<Pool> pool_;  ///< null: serial
  const std::atomic<bool>* stop_ = nullptr;
  bool alone_ = false;
};

}  // namespace raysheaf
