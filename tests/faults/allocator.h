// An operator new for the whole test program that can fail on request.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raysheaf::test {

/// The number of all threads' allocations that have not been freed.
[[nodiscard]] std::int64_t live_allocations();

/// During its lifetime, the `index`th allocation (from 0) fails, once.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::int64_t index);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;
  /// Whether that many allocations happened.
  [[nodiscard]] bool has_failed() const;
};

}  // namespace raysheaf::test
