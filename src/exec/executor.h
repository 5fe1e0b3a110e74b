// An executor: a number of threads, and the operations that distribute work over them.
//
// The operations are the same on every device: `for_each`, scans (exec/scan.h), radix sort
// (exec/radix_sort.h). Their results do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace raysheaf {

/// Minimum items per task: `kWorkGrain` for items of tens of nanoseconds or more, `kCopyGrain` for
/// items that are read or written once.
inline constexpr std::size_t kWorkGrain = 1024, kCopyGrain = 4096;

/// A handle: copies share their threads.
class Executor {
 public:
  /// `threads` = 0 uses all cores that the process may use, or as many threads as the system can
  /// start. Throws `Error` (kUnsupported) if it can start fewer than `threads`. In a child of fork
  /// whose parent had threads, the caller does all the work; loops of the parent's executors throw
  /// `Error` (kWrongState) there.
  explicit Executor(std::uint32_t threads = 0);

  /// The caller does all the work: for loops within the body of another loop.
  [[nodiscard]] static Executor serial();

  /// Returns an executor with the same threads, whose loops throw `Error` (kCancelled) soon after
  /// another thread has set `stop`, which must outlive the result, as must the owner of the
  /// threads.
  [[nodiscard]] Executor until(const std::atomic<bool>& stop) const;

  /// Returns an executor with the same threads, whose owner must outlive it. A caller that waits
  /// for the end of its loop does not work on other loops meanwhile: for callers that hold a lock
  /// for which bodies of other loops may wait.
  [[nodiscard]] Executor alone() const;

  /// Throws if the flag of `until` is set.
  void check() const;

  [[nodiscard]] std::uint32_t threads() const { return threads_; }

  /// Calls `body()` on one of the threads, which need not be the caller's. Loops within it do not
  /// wait for a free thread, because the threads may all be waiting for a lock that `body` holds.
  template <class Body>
  void enter(const Body& body) const {
    if (threads_ == 1) return body();
    enter([](const void* of) { (*static_cast<const Body*>(of))(); }, &body);
  }

  /// Calls `body(i)` once for each i in [0, count), in any order, at least `grain` items per task.
  /// An exception from a body ends the loop and is rethrown here.
  template <class Body>
  void for_each(std::size_t count, std::size_t grain, const Body& body) const {
    for_each_block(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  /// Calls `body(begin, end)` for disjoint ranges that cover [0, count), in any order.
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
  struct Pool;  ///< oneTBB's arena; this header does not include oneTBB
  using Block = void(const void* body, std::size_t begin, std::size_t end);
  explicit Executor(std::shared_ptr<Pool> pool);
  /// The same without a share of the threads, which costs no atomic operation.
  [[nodiscard]] Executor borrowed() const;
  void enter(void (*call)(const void* body), const void* body) const;
  void spread(std::size_t count, std::size_t grain, Block* block, const void* body) const;

  std::uint32_t threads_;
  std::shared_ptr<Pool> pool_;  ///< null: serial
  const std::atomic<bool>* stop_ = nullptr;
  bool alone_ = false;
};

}  // namespace raysheaf
