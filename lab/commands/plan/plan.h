// `raysheaf bench plan`: the plan of `dual` against its other choices, in the scenes of `bench
// compare`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "raysheaf/plan_bench.h"

namespace raysheaf::app {

/// A plan that is slower than the best choice by more than this factor fails `--check`.
inline constexpr double kMostPlanLoss = 1.1;

/// One kind of rays in one scene and mode.
struct PlanCase {
  std::string scene;
  CompareKind kind = CompareKind::kShadow;
  CompareMode mode = CompareMode::kRebuild;
  std::uint64_t triangles = 0, rays = 0;  ///< `rays` are those of the first frame
  PlanTrial trial;

  [[nodiscard]] bool loses() const { return trial.best().loss > kMostPlanLoss; }
};

struct PlanReport {
  BenchPlanCommand command;
  std::uint32_t threads = 0;
  std::vector<PlanCase> cases;
  std::vector<std::string> notes;  ///< sentences about what was omitted

  /// How many plans lose.
  [[nodiscard]] std::uint64_t losing() const;
};

[[nodiscard]] PlanReport measure_plans(const BenchPlanCommand& command, const Tell& tell);

[[nodiscard]] std::string plan_text(const PlanReport& report);
[[nodiscard]] std::string plan_json(const PlanReport& report);

}  // namespace raysheaf::app
