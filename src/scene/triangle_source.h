// Triangles in world space, by number, without a copy: the input of the object tree.
//
// Numbers run through the meshes' instances in the order (geom_id, inst_id, prim_id), as in
// scene/flat_scene.h, so that comparing two numbers compares the ids that break ties between hits.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/vec.h"
#include "base/view.h"

namespace raysheaf {

/// The triangles of one instance of one mesh.
struct TriangleRun {
  const Vec3* positions = nullptr;  ///< world space
  /// Corners, as indices into `positions`; null: 3i, 3i + 1, 3i + 2.
  const std::array<std::uint32_t, 3>* triangles = nullptr;
  std::uint32_t first = 0, count = 0;  ///< its numbers: [first, first + count)

  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t i) const {
    if (triangles == nullptr) {
      const Vec3* p = positions + std::size_t{3} * i;
      return {p[0], p[1], p[2]};
    }
    const std::array<std::uint32_t, 3>& t = triangles[i];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
};

struct TriangleSource {
  View<const TriangleRun> runs;         ///< ascending and without gaps; none is empty
  std::uint32_t count = 0;              ///< below 2^31
  const std::uint8_t* flags = nullptr;  ///< TriangleFlag, by number; null: none is set

  /// The index in `runs` of a triangle's run. O(log runs).
  [[nodiscard]] std::size_t run_of(std::uint32_t triangle) const {
    const TriangleRun* after =
        std::upper_bound(runs.begin(), runs.end(), triangle,
                         [](std::uint32_t t, const TriangleRun& run) { return t < run.first; });
    return static_cast<std::size_t>(after - runs.begin()) - 1;
  }

  /// Calls `body(run, begin, end)`, with numbers relative to the run, for the parts of the runs
  /// that cover the numbers [begin, end).
  template <class Body>
  void for_each_part(std::uint32_t begin, std::uint32_t end, const Body& body) const {
    for (std::size_t r = begin < end ? run_of(begin) : 0; begin < end; ++r) {
      const TriangleRun& run = runs[r];
      const std::uint32_t stop = std::min(end, run.first + run.count);
      body(run, begin - run.first, stop - run.first);
      begin = stop;
    }
  }
};

}  // namespace raysheaf
