// Who may be at a scene: any number of queries, or one change. Whoever comes at the wrong time
// waits.
#pragma once

#include <mutex>
#include <shared_mutex>

namespace raysheaf::python {

/// `Scene` refuses what comes at the wrong time; Python's threads expect to wait instead. A change
/// that waits keeps later queries waiting behind it, so that it has its turn.
class Door {
 public:
  class Reading {
   public:
    explicit Reading(Door& door) : lock_(door.room_, std::defer_lock) {
      const std::lock_guard turn(door.turnstile_);
      lock_.lock();
    }

   private:
    std::shared_lock<std::shared_mutex> lock_;
  };

  class Changing {
   public:
    explicit Changing(Door& door) : lock_(door.room_, std::defer_lock) {
      const std::lock_guard turn(door.turnstile_);
      lock_.lock();
    }

   private:
    std::unique_lock<std::shared_mutex> lock_;
  };

 private:
  std::mutex turnstile_;
  std::shared_mutex room_;
};

}  // namespace raysheaf::python
