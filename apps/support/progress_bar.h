// One line on a terminal that shows the progress of a frame:
//
//   shadow rays, bounce 1  [######......]  50 %  1.2 M of 2.4 M  310 k/s  4 s left
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace raysheaf::app {

/// The line, at most `columns` wide; `elapsed_s` counts from the start of the stage. Rate and
/// remaining time appear once they can be estimated.
[[nodiscard]] std::string progress_line(std::string_view stage, std::uint64_t done,
                                        std::uint64_t total, double elapsed_s, std::size_t columns);

class ProgressBar {
 public:
  /// Draws on `stream` if that is a terminal and `wanted`.
  ProgressBar(std::FILE* stream, bool wanted);
  ~ProgressBar() { wipe(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Clears the line, so that others may write to it until the next update.
  void wipe();
  void update(std::string_view stage, std::uint64_t done, std::uint64_t total);

 private:
  using Clock = std::chrono::steady_clock;

  std::FILE* stream_;
  bool active_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point stage_start_, last_draw_;
};

}  // namespace raysheaf::app
