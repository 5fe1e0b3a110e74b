// Measures time that is printed.
#pragma once

#include <chrono>

namespace raysheaf::app {

class Timer {
 public:
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  [[nodiscard]] double seconds() const { return ms() / 1000; }
  /// Returns `ms()` and starts again.
  double lap_ms() {
    const double elapsed = ms();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace raysheaf::app
