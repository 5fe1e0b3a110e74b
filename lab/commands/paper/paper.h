// The experiment of the paper: measured figures, with the published ones for comparison.
#pragma once

#include <string>
#include <vector>

#include "lab/commands/commands.h"
#include "raysheaf/lab.h"
#include "raysheaf/published.h"

namespace raysheaf::app {

/// One batch, or all bounces of one kind together (`bounce` 0).
struct Measured {
  std::string scene;
  bool builtin = false;  ///< otherwise the paper's scene of that name
  Method method = Method::kBrute;
  BatchStatistics counts;
  bool timed = true;                          ///< false: counted without running
  const PublishedTable* published = nullptr;  ///< the table to compare with
};

/// One setting of the published program's switches, and its counts in every table.
struct Combination {
  Method method = Method::kRah;
  Quirks quirks;
  std::vector<Measured> tables;
  double deviation = 0;  ///< mean of `deviation(table)` over the published tables; 0 without any
};

struct PaperReport {
  std::string words;  ///< of the command
  bool builtin = true, checked = false;
  std::uint32_t width = 0, height = 0, threads = 0;
  std::vector<std::string> scenes;
  std::vector<Method> methods;
  std::vector<Measured> batches;  ///< one per bounce
  std::vector<Measured> tables;   ///< one per kind, over all bounces
  /// for `--as-published`; the defaults of each method come first
  std::vector<Combination> combinations;
  std::vector<Measured> sweep;  ///< the defaults with the depths and branchings of the log
  std::vector<Combination>
      phases;  ///< the defaults with other numbers of omitted rays at the start
};

[[nodiscard]] PaperReport measure_paper(const BenchPaperCommand& command, const Tell& tell);

/// The methods of this build, in the order of the tables.
[[nodiscard]] std::vector<Method> paper_methods();

/// The library's total / the published one, or 0 if that is not known.
[[nodiscard]] double ratio(std::uint64_t ours, const PublishedCount& published);
[[nodiscard]] double total_ratio(const Measured& table);
[[nodiscard]] const PublishedLevel* published_level(const Measured& table, std::uint32_t level);

/// Mean of |ln(library / published)| over the total and the hits of every known level.
[[nodiscard]] double deviation(const Measured& table);

/// All kinds of rays of one scene by one method.
struct SceneTotal {
  std::string scene;
  Method method = Method::kBrute;
  std::uint64_t total = 0, brute_force = 0;
  std::uint64_t published_total = 0, published_brute_force = 0;  ///< 0 if a kind is unpublished
  [[nodiscard]] double relative() const;
  [[nodiscard]] double published_relative() const;
};
[[nodiscard]] std::vector<SceneTotal> scene_totals(const std::vector<Measured>& tables);

/// The figures as JSON (docs/bench.md), and as tables for a terminal.
[[nodiscard]] std::string paper_json(const PaperReport& report);
[[nodiscard]] std::string paper_text(const PaperReport& report);

}  // namespace raysheaf::app
