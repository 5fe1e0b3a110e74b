// What a query reports of itself, whatever method and machine answered it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "methods/dual/dual.h"

namespace raysheaf {

/// What becomes of the object tree before the rays go through it.
enum class TreeWork : std::uint8_t { kKeep, kRefit, kRebuild, kRebuildFinely };

/// What a query did, and why. Counts are the same with any number of threads.
struct QueryReport {
  std::uint64_t bound_tests = 0;      ///< bound with bound: bundles and cells with boxes, triangles
  std::uint64_t ray_bound_tests = 0;  ///< ray with box
  std::uint64_t triangle_tests = 0;   ///< ray with triangle
  bool used_tree = false;             ///< false: a fan needs none
  TreeWork tree = TreeWork::kKeep;    ///< what became of the tree
  double take_ms = 0;                 ///< what a `RaySource` did
  double order_ms = 0, hierarchy_ms = 0, trace_ms = 0, total_ms = 0;
  std::vector<std::string> plan;  ///< a sentence a choice, with the figures that decided it

  void add(const DualCounts& counts) {
    bound_tests += counts.beam_box_tests;
    ray_bound_tests += counts.ray_box_tests;
    triangle_tests += counts.triangle_tests;
  }
  [[nodiscard]] std::uint64_t tests() const {
    return bound_tests + ray_bound_tests + triangle_tests;
  }
};

}  // namespace raysheaf
