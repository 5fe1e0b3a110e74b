// Measures whether `dual` chooses well: every way in which a query could have been answered runs on
// the same triangles and rays, alternating with the way that its plan chooses.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf {

/// The arrays that change from one query to the next.
enum class PlanMode : std::uint8_t {
  kRebuild,  ///< vertices and indices
  kRefit,    ///< vertices
  kStatic,   ///< nothing
};

/// A mesh in world space.
struct PlanMesh {
  std::span<const Vec3> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

struct PlanFrame {
  std::vector<PlanMesh> meshes;
  std::span<const Ray> rays;  ///< of one kind; valid
};

/// One way to answer. Times are medians over the rounds.
struct PlanWay {
  std::string name;
  double ms = 0;    ///< from the changed triangles to the last hit
  double loss = 0;  ///< the plan's time / this way's
};

struct PlanTrial {
  std::vector<std::string> plan;  ///< sentences of the last round
  double ms = 0;                  ///< of the plan
  std::vector<PlanWay> ways;      ///< at least one

  /// The way with the largest loss of the plan.
  [[nodiscard]] const PlanWay& best() const;
};

/// `frames` alternate: at least one, and with `kStatic` only the first is used. `any`: any-hit
/// queries, otherwise closest hits. `threads`: 0 uses all cores. Throws `Error`: kInvalidArgument
/// without frames, rays or runs, kInternal if two ways have different answers.
[[nodiscard]] PlanTrial try_plans(std::span<const PlanFrame> frames, PlanMode mode, bool any,
                                  std::uint32_t threads, std::uint32_t runs);

}  // namespace raysheaf
