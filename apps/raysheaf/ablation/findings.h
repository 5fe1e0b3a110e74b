// What the ablation's figures come to, over all scenes.
#pragma once

#include <string>
#include <vector>

#include "ablation/pivot.h"

namespace raysheaf::app {

/// One key and bound on the rays of one kind: geometric means over the scenes, each scene's least
/// over levels, branching and culling.
struct Pairing {
  LabRays rays = LabRays::kShadow;
  MethodSettings settings;  ///< key, key_bits and bound count
  double percent = 0;       ///< of brute force's tests
  double ms = 0;            ///< from keys to hits
};

/// Every pairing that was measured in every scene that has such rays.
[[nodiscard]] std::vector<Pairing> pairings(const AblationReport& report, LabRays rays);

/// The least of those that pass, or null.
[[nodiscard]] const Pairing* least(const std::vector<Pairing>& all, double Pairing::*figure,
                                   const std::function<bool(const Pairing&)>& passes);

/// Method `crsh`'s key and bound, or null where they were not measured.
[[nodiscard]] const Pairing* crsh_pairing(const std::vector<Pairing>& all);

/// Geometric mean, over the keys, of figure with `bound` / figure with `sphere-cone`; 0 where there
/// is nothing to compare.
[[nodiscard]] double against_sphere_cone(const std::vector<Pairing>& all, BundleBound bound,
                                         double Pairing::*figure);

/// Why a key, or a bound, does well on such rays: a clause.
[[nodiscard]] std::string reason(RayKey key);
[[nodiscard]] std::string reason(BundleBound bound);

}  // namespace raysheaf::app
