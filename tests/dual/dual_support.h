// Triangles, brute force answers, and the answers of `dual`.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "methods/dual/dual.h"
#include "rays/ray_place_body.h"

namespace raysheaf::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Three corners per triangle. Runs alternate between indexed and unindexed ones.
struct Soup {
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> flags;
  std::vector<std::array<std::uint32_t, 3>> indices;
  std::vector<TriangleRun> runs;

  void add(Vec3 a, Vec3 b, Vec3 c) { positions.insert(positions.end(), {a, b, c}); }
  [[nodiscard]] std::uint32_t count() const {
    return static_cast<std::uint32_t>(positions.size() / 3);
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t i) const {
    return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
  }

  TriangleSource source(std::uint32_t longest = 41) {
    indices.clear();
    runs.clear();
    for (std::uint32_t i = 0; i < count(); ++i) indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (std::uint32_t first = 0; first < count(); first += longest) {
      const std::uint32_t n = std::min(longest, count() - first);
      if (runs.size() % 2 == 0)
        runs.push_back({positions.data(), indices.data() + first, first, n});
      else
        runs.push_back({positions.data() + std::size_t{3} * first, nullptr, first, n});
    }
    return {View<const TriangleRun>(runs), count(), flags.empty() ? nullptr : flags.data()};
  }
};

/// Hits by ray, sorted by (t, triangle).
using HitRows = std::vector<std::vector<IndexedHit>>;

inline bool precedes(const IndexedHit& a, const IndexedHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

inline HitRows brute_force(const Soup& soup, const std::vector<Ray>& rays,
                           Facing facing = Facing::kBoth) {
  HitRows rows(rays.size());
  std::vector<RaySetup> setups;
  for (const Ray& ray : rays) setups.push_back(make_ray_setup(ray));
  for (std::uint32_t i = 0; i < soup.count(); ++i) {
    const auto [a, b, c] = soup.corners(i);
    for (std::size_t r = 0; r < rays.size(); ++r) {
      TriangleHit hit;
      if (!intersect_triangle(setups[r], a, b, c, &hit)) continue;
      if (!soup.flags.empty() && !shows(facing, soup.flags[i], hit.front)) continue;
      rows[r].push_back({hit.t, hit.u, hit.v, i});
    }
  }
  for (std::vector<IndexedHit>& row : rows) std::sort(row.begin(), row.end(), precedes);
  return rows;
}

inline std::size_t hit_count(const HitRows& rows) {
  std::size_t count = 0;
  for (const auto& row : rows) count += row.size();
  return count;
}

inline bool same_bits(const IndexedHit& a, const IndexedHit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

inline bool operator==(const DualCounts& a, const DualCounts& b) {
  return a.beam_box_tests == b.beam_box_tests && a.ray_box_tests == b.ray_box_tests &&
         a.triangle_tests == b.triangle_tests;
}

/// The answers of the three queries, in the caller's order.
struct Answers {
  std::vector<IndexedHit> closest;
  std::vector<std::uint8_t> any;
  HitRows all;
  std::array<DualCounts, 3> counts;
  std::array<std::vector<float>, 3> ray_tests;
};

/// The order of a quarter's rays: the caller's, or along a curve, so that bundles are coherent.
enum class Sorting : std::uint8_t { kByQuarter, kCurve };

inline RayOrder order_of(const Executor& executor, View<const Ray> rays, Sorting sorting) {
  RayOrder order;
  order_rays(executor, rays, &order);
  if (sorting == Sorting::kByQuarter) return order;
  order.one_start = false;  // the rays are traced as if they had many
  Box box;
  for (const Ray& ray : rays) {
    box.min = min(box.min, ray.origin);
    box.max = max(box.max, ray.origin);
  }
  for (std::uint32_t q = 0; q < kQuarters; ++q)
    std::sort(order.rays.data() + order.starts[q], order.rays.data() + order.starts[q + 1],
              [&](std::uint32_t a, std::uint32_t b) {
                const auto place = [&](std::uint32_t i) { return ray_place(rays[i], box, 9); };
                return std::pair(place(a), a) < std::pair(place(b), b);
              });
  return order;
}

inline Answers ask(const Executor& executor, const DualScene& scene, std::vector<Ray> rays,
                   Sorting sorting) {
  const View<const Ray> view(rays);
  const RayOrder order = order_of(executor, view, sorting);
  Answers a;
  a.closest.assign(rays.size(), {-1, -1, -1, 7});
  a.any.assign(rays.size(), 7);
  for (auto& tests : a.ray_tests) tests.assign(rays.size(), 0);
  trace_rays(executor, scene, view, order, {.hits = a.closest, .ray_tests = a.ray_tests[0]},
             &a.counts[0]);
  trace_rays(executor, scene, view, order, {.occluded = a.any, .ray_tests = a.ray_tests[1]},
             &a.counts[1]);
  RowLists lists;
  trace_rays(executor, scene, view, order, {.rows = &lists, .ray_tests = a.ray_tests[2]},
             &a.counts[2]);
  a.all.resize(rays.size());
  for (const RowList& list : lists)
    for (std::size_t i = 0; i < list.ends.size(); ++i) {
      const View<const IndexedHit> row = list.row(i);
      a.all[order.rays[list.first + i]].assign(row.begin(), row.end());
    }
  return a;
}

inline std::string words(const Ray& r) {
  char text[240];
  std::snprintf(text, sizeof text, "(%a %a %a) -> (%a %a %a), t %a to %a", r.origin.x, r.origin.y,
                r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.t_min, r.t_max);
  return text;
}

/// Whether `a` equals `rows` bit for bit; names the first ray with a difference.
inline testing::AssertionResult right(const HitRows& rows, const Answers& a,
                                      const std::vector<Ray>& rays) {
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const auto& row = rows[r];
    const IndexedHit least = row.empty() ? IndexedHit{} : row.front();
    const auto fail = [&](const char* what) {
      auto failure = testing::AssertionFailure();
      failure << what << ", ray " << r << ": " << words(rays[r]) << "; " << row.size() << " hits";
      return failure << ", first " << least.t << " of " << least.triangle;
    };
    if (!same_bits(a.closest[r], least))
      return fail("closest") << ", not " << a.closest[r].t << " of " << a.closest[r].triangle;
    if (a.any[r] != (row.empty() ? 0 : 1)) return fail("any") << ", not " << int{a.any[r]};
    if (a.all[r].size() != row.size()) return fail("all") << ", not " << a.all[r].size();
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!same_bits(a.all[r][i], row[i])) return fail("all") << ", at " << i;
  }
  return testing::AssertionSuccess();
}

inline testing::AssertionResult same(const Answers& a, const Answers& b) {
  for (std::size_t q = 0; q < 3; ++q) {
    if (!(a.counts[q] == b.counts[q])) return testing::AssertionFailure() << "counts of " << q;
    if (a.ray_tests[q] != b.ray_tests[q]) return testing::AssertionFailure() << "shares of " << q;
  }
  if (a.any != b.any) return testing::AssertionFailure() << "any";
  for (std::size_t r = 0; r < a.closest.size(); ++r) {
    if (!same_bits(a.closest[r], b.closest[r])) return testing::AssertionFailure() << "closest";
    if (a.all[r].size() != b.all[r].size() ||
        !std::equal(a.all[r].begin(), a.all[r].end(), b.all[r].begin(), same_bits))
      return testing::AssertionFailure() << "all";
  }
  return testing::AssertionSuccess();
}

enum class Tree { kCurve, kCoarse, kJoined, kFine, kRefitted };

inline const Executor& one_thread() {
  static const Executor executor(1);
  return executor;
}
inline const Executor& two_threads() {
  static const Executor executor(2);
  return executor;
}

inline void make_tree(Soup* soup, Tree how, ObjectTree* tree) {
  const Executor& executor = one_thread();
  if (how == Tree::kCurve) return build_object_tree(executor, soup->source(), tree);
  if (how == Tree::kCoarse)
    return build_object_tree(executor, soup->source(), tree, {kCoarseTriangles});
  if (how == Tree::kJoined)
    return build_object_tree(executor, soup->source(), tree, {kCoarseTriangles, Joining::kLeaves});
  if (how == Tree::kFine) return build_fine_object_tree(executor, soup->source(), tree);
  // Scaling by powers of two keeps degenerate triangles degenerate.
  Soup former = *soup;
  for (Vec3& p : former.positions) p = p * Vec3{-0.5f, 0.25f, 0.125f};
  build_object_tree(executor, former.source(), tree);
  ASSERT_TRUE(refit_object_tree(executor, soup->source(), MovedTriangles::everything(), tree));
}

/// Compares every kind of tree and bundle with brute force. Returns the number of hits.
inline std::size_t expect_right(Soup soup, const std::vector<Ray>& rays,
                                Facing facing = Facing::kBoth) {
  const HitRows rows = brute_force(soup, rays, facing);
  for (const Tree how :
       {Tree::kCurve, Tree::kCoarse, Tree::kJoined, Tree::kFine, Tree::kRefitted}) {
    ObjectTree tree;
    make_tree(&soup, how, &tree);
    for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
      const DualScene scene{&tree, soup.flags.empty() ? nullptr : soup.flags.data(), facing,
                            bundle};
      const bool sorted = (how == Tree::kFine) == (bundle == Bundle::kLongStream);
      const Answers a =
          ask(one_thread(), scene, rays, sorted ? Sorting::kCurve : Sorting::kByQuarter);
      EXPECT_TRUE(right(rows, a, rays))
          << "tree " << static_cast<int>(how) << " bundle " << static_cast<int>(bundle);
    }
  }
  return hit_count(rows);
}

}  // namespace raysheaf::test
