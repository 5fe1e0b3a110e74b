// Admits many readers or one writer, without waiting: a call at the wrong time throws. A child of
// fork is also refused, because a reader's thread may not exist there.
#pragma once

#include <atomic>
#include <cstdint>

#include "base/forks.h"
#include "raysheaf/error.h"

namespace raysheaf {

class SceneGate {
 public:
  /// Held during a query or another read access to the scene.
  class Reading {
   public:
    explicit Reading(SceneGate& gate) : gate_(gate) {
      check_not_forked(gate_.made_, "scene");
      std::int32_t state = gate_.state_.load(std::memory_order_relaxed);
      do {
        if (state == kChanging)
          throw Error(ErrorCode::kWrongState, "another thread is changing the scene", "scene");
      } while (!gate_.state_.compare_exchange_weak(state, state + 1, std::memory_order_acquire,
                                                   std::memory_order_relaxed));
    }
    ~Reading() { gate_.state_.fetch_sub(1, std::memory_order_release); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

   private:
    SceneGate& gate_;
  };

  /// Held while the scene changes.
  class Changing {
   public:
    explicit Changing(SceneGate& gate) : gate_(gate) {
      check_not_forked(gate_.made_, "scene");
      std::int32_t state = 0;
      if (gate_.state_.compare_exchange_strong(state, kChanging, std::memory_order_acquire,
                                               std::memory_order_relaxed))
        return;
      throw Error(ErrorCode::kWrongState,
                  state == kChanging ? "another thread is changing the scene"
                                     : "the scene cannot change while a query runs",
                  "scene");
    }
    ~Changing() { gate_.state_.store(0, std::memory_order_release); }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

   private:
    SceneGate& gate_;
  };

 private:
  static constexpr std::int32_t kChanging = -1;
  const std::uint32_t made_ = fork_number();
  std::atomic<std::int32_t> state_{0};  // number of readers, or kChanging
};

}  // namespace raysheaf
