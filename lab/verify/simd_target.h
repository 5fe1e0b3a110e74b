// The SIMD targets of this machine, and how to run on one of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::checks {

/// Highway's bits, the narrowest target first.
[[nodiscard]] std::vector<std::int64_t> simd_targets();
[[nodiscard]] std::string name_of(std::int64_t simd_target);

/// During its lifetime, all kernels of the process run on that target.
class OnSimdTarget {
 public:
  explicit OnSimdTarget(std::int64_t target);
  ~OnSimdTarget();
  OnSimdTarget(const OnSimdTarget&) = delete;
  OnSimdTarget& operator=(const OnSimdTarget&) = delete;
};

}  // namespace raysheaf::checks
