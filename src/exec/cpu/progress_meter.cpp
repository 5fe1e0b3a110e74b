#include "exec/progress_meter.h"

#include <algorithm>

#include "exec/cancelled.h"

namespace raysheaf {

void ProgressMeter::begin(std::string stage, std::uint64_t total) {
  stage_ = std::move(stage);
  total_ = total;
  done_ = 0;
  next_ = 0;
  tell(0);
}

void ProgressMeter::advance(std::uint64_t steps) {
  const std::uint64_t done = done_.fetch_add(steps, std::memory_order_relaxed) + steps;
  if (cancelled_.load(std::memory_order_relaxed) ||
      (report_ && (done >= total_ || done >= next_.load(std::memory_order_relaxed))))
    tell(done);
}

void ProgressMeter::tell(std::uint64_t done) {
  if (!report_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && !cancelled_) {
    next_ = done + std::max<std::uint64_t>(1, total_ / 100);
    if (!report_({stage_, std::min(done, total_), total_})) cancelled_ = true;
  }
  if (cancelled_) throw cancelled();
}

}  // namespace raysheaf
