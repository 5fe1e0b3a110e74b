// A fair readers-writer lock for a scene: any number of queries, or one change.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>

#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf::python {

/// Another number in every child of fork. The system's number of the process would take longer to
/// ask for than a ray.
inline std::uint32_t forks_before() {
  static std::atomic<std::uint32_t> forks{0};
  [[maybe_unused]] static const bool kWatches =
      (system::watch_forks(nullptr, nullptr, [] { ++forks; }), true);
  return forks.load(std::memory_order_relaxed);
}

/// `Scene` refuses concurrent changes; Python's threads expect to wait for them instead, in order
/// of arrival. A waiting thread calls its `poll()` regularly; an exception from it ends the wait.
/// Meanwhile the thread has no place in the queue, so that Python code that runs inside (a signal
/// handler, a finalizer) may lock the same door.
class Door {
 public:
  class Reading {
   public:
    template <class Poll>
    Reading(Door& door, const Poll& poll) : door_(door) {
      door_.enter(Visit::kReading, poll);
    }
    ~Reading() { door_.leave(Visit::kReading); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    Door& door_;
  };

  class Changing {
   public:
    template <class Poll>
    Changing(Door& door, const Poll& poll) : door_(door) {
      door_.enter(Visit::kChanging, poll);
    }
    ~Changing() { door_.leave(Visit::kChanging); }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

   private:
    Door& door_;
  };

 private:
  enum class Visit { kReading, kChanging };
  using Number = std::uint64_t;

  /// Whether the visitor with `number` may enter: a change when all earlier visitors have left, a
  /// query when all earlier changes have.
  bool may_enter(Visit visit, Number number) const {
    if (is_changing_) return false;
    const auto end = waiting_.lower_bound(number);
    if (visit == Visit::kChanging) return readers_ == 0 && waiting_.begin() == end;
    return std::none_of(waiting_.begin(), end,
                        [](const auto& one) { return one.second == Visit::kChanging; });
  }

  template <class Poll>
  void enter(Visit visit, const Poll& poll) {
    if (made_ != forks_before())
      throw Error(ErrorCode::kWrongState,
                  "it was made before this process was forked, and its threads are not here: make "
                  "another one, or start processes by \"spawn\"",
                  "scene");
    constexpr std::chrono::milliseconds kBetweenPolls{50};
    std::unique_lock lock(mutex_);
    const Number number = next_++;
    while (!may_enter(visit, number)) {
      waiting_[number] = visit;
      const bool may =
          left_.wait_for(lock, kBetweenPolls, [&] { return may_enter(visit, number); });
      waiting_.erase(number);
      if (may) break;
      lock.unlock();
      poll();
      lock.lock();
    }
    if (visit == Visit::kReading)
      ++readers_;
    else
      is_changing_ = true;
  }

  void leave(Visit visit) {
    const std::lock_guard lock(mutex_);
    if (visit == Visit::kReading)
      --readers_;
    else
      is_changing_ = false;
    if (readers_ == 0) left_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable left_;  ///< signalled when a visitor leaves
  std::map<Number, Visit> waiting_;
  Number next_ = 0;
  std::uint32_t readers_ = 0;
  bool is_changing_ = false;
  const std::uint32_t made_ = forks_before();
};

}  // namespace raysheaf::python
