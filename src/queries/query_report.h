// The report of a query, from any method and any machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "methods/dual/dual.h"

namespace raysheaf {

/// How the object tree is prepared for the rays, the most expensive last.
enum class TreeWork : std::uint8_t { kKeep, kRefit, kRebuildCoarsely, kRebuild, kRebuildFinely };

/// In the plan of a query that tests every triangle.
inline constexpr const char* kByBruteForce = "brute force, as requested";

/// The work of a query, and the reasons for it. Counts are the same with any number of threads.
struct QueryReport {
  std::uint64_t bound_tests = 0;      ///< bundles with boxes
  std::uint64_t ray_bound_tests = 0;  ///< rays with boxes
  std::uint64_t triangle_tests = 0;   ///< rays with triangles
  bool used_tree = false;             ///< false for brute force
  TreeWork tree = TreeWork::kKeep;    ///< how the tree was prepared
  double take_ms = 0;                 ///< time of the `RaySource`
  double order_ms = 0, hierarchy_ms = 0, trace_ms = 0, total_ms = 0;
  std::vector<std::string> plan;  ///< a sentence for each choice, with the numbers that decided it

  void add(const DualCounts& counts) {
    bound_tests += counts.beam_box_tests;
    ray_bound_tests += counts.ray_box_tests;
    triangle_tests += counts.triangle_tests;
  }
  /// Adds the milliseconds of one stage, to the total as well.
  void lap(double QueryReport::*stage, double ms) {
    this->*stage += ms;
    total_ms += ms;
  }
  [[nodiscard]] std::uint64_t tests() const {
    return bound_tests + ray_bound_tests + triangle_tests;
  }
};

}  // namespace raysheaf
