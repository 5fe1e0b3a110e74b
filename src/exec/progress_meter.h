// Reports the progress of a long stage to the caller, and forwards the caller's request to stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "raysheaf/context.h"

namespace raysheaf {

/// Stages call `begin` once and `advance` from any thread. The caller's function runs on one thread
/// at a time, at most a hundred times per stage. Throws `Error` (kCancelled) once it has returned
/// false.
class ProgressMeter {
 public:
  ProgressMeter() = default;
  explicit ProgressMeter(std::function<bool(const Progress&)> report)
      : report_(std::move(report)) {}

  void begin(std::string stage, std::uint64_t total);
  void advance(std::uint64_t steps);

 private:
  void tell(std::uint64_t done);

  std::function<bool(const Progress&)> report_;
  std::string stage_;
  std::uint64_t total_ = 0;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> next_{0};  // report when `done_` reaches this
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
};

}  // namespace raysheaf
