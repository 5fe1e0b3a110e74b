// `raysheaf bench instances`: many instances of one mesh, which move or stand still, and batches of
// rays, compared with Embree's instances.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "lab/commands/compare/compare.h"

namespace raysheaf::app {

/// One number of rays of a kind in one scene. Times are medians, of a whole frame: the transforms
/// if they move, and the rays.
struct InstancesCase {
  InstancesShape shape;  ///< as measured: of the triangles a mesh of that size has
  InstanceRays kind = InstanceRays::kRandom;
  bool moved = false;
  std::uint32_t rays = 0;
  double update_ms = 0, ours_ms = 0;  ///< by the plan; the update is a part of the frame
  double levels_ms = 0;               ///< where rays always enter instances
  double flat_ms = 0;                 ///< where instances are always placed; 0: not measured
  double flat_ratio = 0;              ///< levels / flat, of processor time; 0: not measured
  double first_ms = 0;                ///< the first answer of a new scene on two levels
  PeerResult peer;                    ///< the fastest version, with the largest ratio
  std::string plan;                   ///< what the library chose: "levels" or "flat"
  std::uint64_t levels_bytes = 0, flat_bytes = 0;
};

/// "50x1024"
[[nodiscard]] std::string to_string(InstancesShape shape);
[[nodiscard]] const char* to_string(InstanceRays kind);

struct InstancesReport {
  BenchInstancesCommand command;
  std::string peer;  ///< "Embree 4.4.0"
  std::uint32_t threads = 0;
  std::vector<InstancesCase> cases;
};

/// Throws `Error` as `open_peers` does.
[[nodiscard]] InstancesReport measure_instances(const BenchInstancesCommand& command,
                                                const Tell& tell);

[[nodiscard]] std::string instances_text(const InstancesReport& report);
/// A line for each case (docs/bench.md).
[[nodiscard]] std::string instances_csv(const InstancesReport& report);

}  // namespace raysheaf::app
