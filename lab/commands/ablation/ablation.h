// The ablation: every chosen combination of key, bound, levels, branching and mesh culling, counted
// and timed on every chosen batch of rays.
#pragma once

#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "raysheaf/lab.h"

namespace raysheaf::app {

[[nodiscard]] std::vector<LabRays> all_lab_rays();
[[nodiscard]] std::vector<RayKey> all_keys();
[[nodiscard]] std::vector<BundleBound> all_bounds();

/// "shadow", "reflection1", "reflection2", "ao".
[[nodiscard]] const char* to_string(LabRays rays);
/// Throws `Error` (kInvalidArgument), which lists the valid names.
[[nodiscard]] LabRays lab_rays_from_string(const std::string& name);

/// Whether `MethodSettings::key_bits` changes this key.
[[nodiscard]] bool comes_in_both_widths(RayKey key);

/// Text about a key: its family, and the reason for its results.
struct KeyWords {
  const char* family;
  const char* reason;
};
[[nodiscard]] KeyWords words_of(RayKey key);
/// The reason for a bound's results.
[[nodiscard]] const char* reason_of(BundleBound bound);

/// One combination on one batch. The times are medians over the repetitions.
struct AblationRow {
  std::string scene;
  LabRays rays = LabRays::kShadow;
  MethodSettings settings;
  BatchStatistics counts;

  [[nodiscard]] bool is_of(const std::string& of_scene, LabRays of_rays) const {
    return scene == of_scene && rays == of_rays;
  }
  /// Total tests as a percentage of brute force.
  [[nodiscard]] double percent() const { return 100 * counts.relative(); }
  /// Nodes and triangles: both stages run in one sweep.
  [[nodiscard]] double trace_ms() const;
  /// Order, hierarchy and trace.
  [[nodiscard]] double total_ms() const;
};

struct AblationReport {
  BenchAblationCommand command;
  std::vector<std::string> scenes;
  std::vector<AblationRow> rows;  ///< without batches that have no rays
};

[[nodiscard]] AblationReport measure_ablation(const BenchAblationCommand& command,
                                              const Tell& tell);

/// The row of one batch with the fewest tests (the first of equals), or null if it has no rays.
[[nodiscard]] const AblationRow* fewest_tests(const AblationReport& report,
                                              const std::string& scene, LabRays rays);
/// The row of one batch with the least time from keys to hits, or null.
[[nodiscard]] const AblationRow* least_time(const AblationReport& report, const std::string& scene,
                                            LabRays rays);

/// The figures for other programs (docs/bench.md).
[[nodiscard]] std::string ablation_json(const AblationReport& report);
[[nodiscard]] std::string ablation_csv(const AblationReport& report);
/// A table for each batch, for a terminal.
[[nodiscard]] std::string ablation_text(const AblationReport& report);

}  // namespace raysheaf::app
