// The counts and times that the paper and its authors' logs report, as data: Reis, Costa, Pereira,
// "Coherent Ray-Space Hierarchy via Ray Hashing and Sorting", 2017, arXiv 2312.06538, tables 1 to
// 4, 512x512 pixels, two levels, branching 8.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "raysheaf/method.h"
#include "raysheaf/statistics.h"

namespace raysheaf {

/// Absent if unknown; `rounded` if only three or four digits are known.
struct PublishedCount {
  std::optional<std::uint64_t> value;
  bool rounded = false;
};

struct PublishedLevel {
  std::uint32_t level = 0;
  PublishedCount tests, hits;
};

/// Milliseconds on the authors' GTX TITAN (Kepler); absent if their log is truncated or the method
/// has no such stage.
struct PublishedTimes {
  std::optional<double> raygen, order, hierarchy, traverse, intersect;
};

/// One method's rays of one kind in one scene, all bounces together.
struct PublishedTable {
  std::string_view scene;  ///< office, cornell, sponza
  Method method = Method::kBrute;
  RayKind kind = RayKind::kShadow;
  std::uint32_t bounces = 1;
  std::uint64_t rays = 0, triangles = 0, total = 0;
  std::vector<PublishedLevel> levels;  ///< from the top down; may be empty
  PublishedTimes times_ms;
  std::uint32_t depth = 2, branching = 8;  ///< of the ray hierarchy

  [[nodiscard]] std::uint64_t brute_force_tests() const { return rays * triangles; }
  [[nodiscard]] double relative() const {
    return static_cast<double>(total) / static_cast<double>(brute_force_tests());
  }
};

[[nodiscard]] const std::vector<PublishedTable>& published_tables();

/// Tables from the authors' log: CORNELL's shadow rays with other depths and branchings.
[[nodiscard]] const std::vector<PublishedTable>& published_sweep();

/// Null if nothing was published.
[[nodiscard]] const PublishedTable* published_table(std::string_view scene, Method method,
                                                    RayKind kind);

}  // namespace raysheaf
