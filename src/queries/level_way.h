// Whether rays go through two levels together (levels/trace_levels.h).
#pragma once

#include "levels/trace_levels.h"
#include "queries/plan.h"

namespace raysheaf {

/// In streams if enough of them are coherent with their neighbours, as through one tree; few go one
/// by one.
[[nodiscard]] inline LevelWay plan_level_way(const RaySource& rays) {
  constexpr std::size_t kFew = 256;
  if (rays.size() <= kFew) return {};
  const RayPlan plan = plan_rays(rays);
  return plan.bundle == Bundle::kStream ? LevelWay{plan.bundle, plan.row} : LevelWay{};
}

}  // namespace raysheaf
