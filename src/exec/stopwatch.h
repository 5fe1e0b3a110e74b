// Measures milliseconds between successive laps.
#pragma once

#include <chrono>

namespace raysheaf {

class Stopwatch {
 public:
  Stopwatch() = default;
  /// One that does not run reads no clock, and measures nothing.
  explicit Stopwatch(bool runs) : last_(runs ? std::chrono::steady_clock::now() : Time()) {}

  /// Does not restart the stopwatch.
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - last_)
        .count();
  }
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Time = std::chrono::steady_clock::time_point;
  Time last_ = std::chrono::steady_clock::now();
};

}  // namespace raysheaf
