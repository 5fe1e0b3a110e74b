// Who may be at a scene: any number of queries, or one change. Whoever comes at the wrong time
// waits.
#pragma once

#include <chrono>
#include <mutex>
#include <shared_mutex>

namespace raysheaf::python {

/// `Scene` refuses what comes at the wrong time; Python's threads expect to wait instead. A change
/// that waits keeps later queries waiting behind it, so that it has its turn. While anyone waits,
/// their `poll()` is called now and then: what it throws ends the wait.
class Door {
 public:
  class Reading {
   public:
    template <class Poll>
    Reading(Door& door, const Poll& poll) : lock_(door.room_, std::defer_lock) {
      door.wait_for(&lock_, poll);
    }

   private:
    std::shared_lock<std::shared_timed_mutex> lock_;
  };

  class Changing {
   public:
    template <class Poll>
    Changing(Door& door, const Poll& poll) : lock_(door.room_, std::defer_lock) {
      door.wait_for(&lock_, poll);
    }

   private:
    std::unique_lock<std::shared_timed_mutex> lock_;
  };

 private:
  template <class Lock, class Poll>
  void wait_for(Lock* lock, const Poll& poll) {
    constexpr std::chrono::milliseconds kBetweenPolls{50};
    std::unique_lock turn(turnstile_, std::defer_lock);
    while (!turn.try_lock_for(kBetweenPolls)) poll();
    while (!lock->try_lock_for(kBetweenPolls)) poll();
  }

  std::timed_mutex turnstile_;
  std::shared_timed_mutex room_;
};

}  // namespace raysheaf::python
