// Conclusions from the figures of the ablation, over all scenes.
#pragma once

#include <string>
#include <vector>

#include "ablation/pivot.h"

namespace raysheaf::app {

/// One key and bound for the rays of one kind: geometric means over the scenes of the smallest
/// figures over levels, branching and culling.
struct Pairing {
  LabRays rays = LabRays::kShadow;
  MethodSettings settings;  ///< only key, key_bits and bound are used
  double percent = 0;       ///< of the tests of brute force
  double ms = 0;            ///< from keys to hits
};

/// Every pairing that was measured in every scene with such rays.
[[nodiscard]] std::vector<Pairing> pairings(const AblationReport& report, LabRays rays);

/// The smallest pairing for which the predicate holds, or null.
[[nodiscard]] const Pairing* least(const std::vector<Pairing>& all, double Pairing::*figure,
                                   const std::function<bool(const Pairing&)>& passes);

/// The key and bound of method `crsh`, or null if they were not measured.
[[nodiscard]] const Pairing* crsh_pairing(const std::vector<Pairing>& all);

/// Geometric mean, over the keys, of the figure with `bound` divided by the figure with
/// `sphere-cone`; 0 if there is nothing to compare.
[[nodiscard]] double against_sphere_cone(const std::vector<Pairing>& all, BundleBound bound,
                                         double Pairing::*figure);

/// Why a key or a bound does well for such rays, as a clause.
[[nodiscard]] std::string reason(RayKey key);
[[nodiscard]] std::string reason(BundleBound bound);

}  // namespace raysheaf::app
