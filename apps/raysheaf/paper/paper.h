// The paper's experiment: what was measured, and beside it what was published.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "options.h"
#include "raysheaf/lab.h"
#include "raysheaf/published.h"

namespace raysheaf::app {

/// One batch, or the bounces of one kind together (`bounce` 0).
struct Measured {
  std::string scene;
  bool builtin = false;  ///< or the paper's of that name
  Method method = Method::kBrute;
  BatchStatistics counts;
  bool timed = true;                          ///< false: counted without running
  const PublishedTable* published = nullptr;  ///< what it compares with
};

/// One setting of the published program's switches, and what it counts in every table.
struct Combination {
  Method method = Method::kRah;
  Quirks quirks;
  std::vector<Measured> tables;
  double deviation = 0;  ///< mean of `deviation(table)` over the published ones; 0 without any
};

struct PaperReport {
  bool builtin = true, checked = false;
  std::uint32_t width = 0, height = 0, threads = 0;
  std::vector<std::string> scenes;
  std::vector<Method> methods;
  std::vector<Measured> batches;          ///< a bounce each
  std::vector<Measured> tables;           ///< a kind each, all bounces
  std::vector<Combination> combinations;  ///< `--as-published`; the defaults first of each method
  std::vector<Measured> sweep;  ///< the defaults with the depths and branchings of the log
  std::vector<Combination>
      phases;  ///< the defaults with other numbers of rays left out at the start
};

/// Told before each measurement: how many there were, how many there will be. May throw.
using Tell = std::function<void(std::uint64_t done, std::uint64_t total)>;

[[nodiscard]] PaperReport measure_paper(const BenchPaperCommand& command, const Tell& tell);

/// Methods that this build knows, in the order of the tables.
[[nodiscard]] std::vector<Method> paper_methods();

/// Of one method: the one with the least deviation, or null.
[[nodiscard]] const Combination* nearest(const PaperReport& report, Method method);

/// ours / published, or 0 where that is not known.
[[nodiscard]] double ratio(std::uint64_t ours, const PublishedCount& published);
[[nodiscard]] double total_ratio(const Measured& table);
[[nodiscard]] const PublishedLevel* published_level(const Measured& table, std::uint32_t level);

/// Mean of |ln(ours / published)| over the total and the hits of every level that is known.
[[nodiscard]] double deviation(const Measured& table);

}  // namespace raysheaf::app
