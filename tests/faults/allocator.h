// An operator new that can be told to fail, for the whole test program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raysheaf::test {

/// Of all threads.
[[nodiscard]] std::int64_t live_allocations();

/// While it lives, the `index`th allocation (from 0) fails: once.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::int64_t index);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;
  /// Whether there were as many allocations.
  [[nodiscard]] bool has_failed() const;
};

}  // namespace raysheaf::test
