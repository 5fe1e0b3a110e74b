#include "lab/verify/simd_target.h"

#include <hwy/highway.h>

#include <algorithm>

namespace raysheaf::checks {

std::vector<std::int64_t> simd_targets() {
  std::vector<std::int64_t> all;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1)
    all.push_back(rest & -rest);
  std::reverse(all.begin(), all.end());  // Highway gives better targets lower bits
  return all;
}

std::string name_of(std::int64_t simd_target) {
  return hwy::TargetName(simd_target);
}

OnSimdTarget::OnSimdTarget(std::int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

OnSimdTarget::~OnSimdTarget() {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace raysheaf::checks
