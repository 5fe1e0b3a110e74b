// Every way of querying gives the hits of exact arithmetic: for rays through corners, edges and
// interiors of meshes with integer coordinates, and exact fractions next to them; and for difficult
// soups at any scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "api/scene/context_impl.h"
#include "dual/dual_support.h"
#include "intersect/exact.h"
#include "lab/verify/compare.h"
#include "lab/verify/simd_target.h"
#include "out_of_core/stream_support.h"

namespace raysheaf::checks {
namespace {

constexpr std::uint64_t kProblems = 40;
constexpr std::uint32_t kMostTriangles = 200;
constexpr std::size_t kRays = 1000;

const Subject& the_library() {
  static const Subject subject(2);
  return subject;
}

/// Calls `answer(problem, random, tally)` for one problem after another until one fails. The
/// failure is one line with the ray, the triangle, and the expected and actual results.
template <class Answer>
void for_each_problem(const Answer& answer) {
  PromiseReport report;
  Tally tally(&report);
  std::uint64_t hits = 0;
  for (std::uint64_t seed = 1; seed <= kProblems && report.failures == 0; ++seed) {
    Random random(seed);
    tally.begin_round(seed);
    Problem problem;
    make_exact_problem(kMostTriangles, kRays, &random, &problem);
    solve_exactly(the_library(), &problem, &tally);
    hits += problem.rows.hits.size();
    answer(problem, &random, &tally);
  }
  for (const VerifyFailure& failure : report.first_failures)
    ADD_FAILURE() << "problem " << failure.seed << ": " << failure.what;
  EXPECT_GT(hits, report.failures == 0 ? kProblems * kRays : 0);
}

/// Runs on every SIMD target.
template <class Answer>
void on_every_target(const Answer& answer) {
  for_each_problem([&](const Problem& problem, Random* random, Tally* tally) {
    for (const std::int64_t target : the_library().targets) {
      const OnSimdTarget on(target);
      answer(problem, target, random, tally);
    }
  });
}

test::Soup soup_of(const Problem& problem) {
  test::Soup soup;
  for (const std::vector<Vec3>& mesh : problem.soup.meshes)
    soup.positions.insert(soup.positions.end(), mesh.begin(), mesh.end());
  return soup;
}

Hit hit_of(const Problem& problem, const IndexedHit& hit) {
  return problem.hit_of(hit.triangle, hit.t, hit.u, hit.v);
}

void compare(const Problem& problem, const std::string& name, std::int64_t target,
             const test::Answers& answers, Tally* tally) {
  std::vector<Hit> closest;
  HitRows rows;
  rows.offsets.push_back(0);
  for (const IndexedHit& hit : answers.closest) closest.push_back(hit_of(problem, hit));
  for (const auto& row : answers.all) {
    for (const IndexedHit& hit : row) rows.hits.push_back(hit_of(problem, hit));
    rows.offsets.push_back(rows.hits.size());
  }
  Comparison comparison(problem, way(name, target, 1), tally);
  comparison.closest(closest);
  comparison.any(answers.any);
  comparison.all(rows);
}

/// `brute` and `dual` of the library; brute, rah and crsh with all their bounds, gl10 and dual of
/// the renderer.
TEST(ExactQueries, EveryMethod) {
  for_each_problem([](const Problem& problem, Random* random, Tally* tally) {
    compare_every_way(the_library(), problem, ThreadCounts::kMost, random, tally);
  });
}

/// The kinds of trees alternate.
TEST(ExactQueries, EveryTreeAndBundle) {
  std::size_t turn = 0;
  on_every_target([&](const Problem& problem, std::int64_t target, Random* random, Tally* tally) {
    test::Soup soup = soup_of(problem);
    constexpr const char* kTrees[] = {"curve", "coarse", "fine", "refitted"};
    constexpr test::Tree kHow[] = {test::Tree::kCurve, test::Tree::kCoarse, test::Tree::kFine,
                                   test::Tree::kRefitted};
    constexpr const char* kBundles[] = {"streams", "long streams"};
    const std::size_t how = turn++ % std::size(kHow);
    ObjectTree tree;
    test::make_tree(&soup, kHow[how], &tree);
    for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
      DualScene scene;
      scene.tree = &tree;
      scene.bundle = bundle;
      const auto sorting = random->one_in(2) ? test::Sorting::kCurve : test::Sorting::kByQuarter;
      const std::string name = std::string(kBundles[static_cast<std::size_t>(bundle)]) +
                               " through a tree of kind " + kTrees[how];
      compare(problem, name, target, test::ask(test::one_thread(), scene, problem.rays, sorting),
              tally);
    }
  });
}

TEST(ExactQueries, OneOrigin) {
  std::uint64_t solved = 0;
  on_every_target([&](const Problem& problem, std::int64_t target, Random*, Tally* tally) {
    const Vec3 origin = problem.rays.front().origin;
    Problem fan;
    fan.soup = problem.soup;
    for (const Ray& ray : problem.rays) {
      fan.rays.push_back(ray);
      fan.rays.back().origin = origin;
    }
    const bool is_one = std::all_of(problem.rays.begin(), problem.rays.end(), [&](const Ray& ray) {
      return std::memcmp(&ray.origin, &origin, 12) == 0;
    });
    if (is_one)
      fan.rows = problem.rows;
    else
      solve_exactly(the_library(), &fan, tally);
    solved += is_one ? 1 : 0;
    test::Soup soup = soup_of(problem);
    ObjectTree tree;
    test::make_tree(&soup, test::Tree::kCurve, &tree);
    DualScene scene;
    scene.tree = &tree;
    compare(fan, "streams of one origin", target,
            test::ask(test::one_thread(), scene, fan.rays, test::Sorting::kByQuarter), tally);
  });
  EXPECT_GT(solved, 0u);
}

TEST(ExactQueries, StreamedBlocks) {
  on_every_target([](const Problem& problem, std::int64_t target, Random* random, Tally* tally) {
    BlockList blocks;
    static_cast<void>(cut_into_blocks(problem.soup.description(), &blocks, 1 + random->below(60)));
    StreamOptions options;
    options.threads = 2;
    const test::Said said(blocks, problem.rays, options);
    Comparison comparison(problem, way("streamed blocks", target, 2), tally);
    comparison.closest(said.hits);
    comparison.any(said.occluded);
  });
}

TEST(ExactQueries, EmulatedDevice) {
  const test::EmulatedMachine machine;
  for_each_problem([&](const Problem& problem, Random* random, Tally* tally) {
    Scene scene(machine.context);
    problem.soup.add_to(&scene);
    for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute}) {
      const bool brute = method == QueryMethod::kBrute;
      Comparison comparison(problem, brute ? "brute on a device" : "dual on a device", tally);
      const QueryOptions options{.method = method};
      comparison.closest(closest_hit(scene, problem.rays, options));
      comparison.any(any_hit(scene, problem.rays, options));
      comparison.all(all_hits(scene, problem.rays, options));
    }
    BlockList blocks;
    static_cast<void>(cut_into_blocks(problem.soup.description(), &blocks, 1 + random->below(60)));
    StreamOptions options;
    options.context = &machine.context;
    const test::Said said(blocks, problem.rays, options);
    Comparison comparison(problem, "streamed blocks on a device", tally);
    comparison.closest(said.hits);
    comparison.any(said.occluded);
  });
}

/// A triangle has an area although differences and products in binary64 lose it.
TEST(ExactQueries, TheThinnestTriangles) {
  const std::vector<Vec3> corners{{0x1p-60f, 0, 0}, {1, 1, 0}, {2, 2, 0}};
  const std::vector<Ray> rays{{{0x1p-60f, 0, 1}, 0, {0, 0, -1}, 9},
                              {{1, 1, 1}, 0, {0, 0, -1}, 9},
                              {{1.5f, 1.5f, 1}, 0, {0, 0, -1}, 9},
                              {{0.5f, 0.5f, 1}, 0, {0, 0, -1}, 9}};
  Problem problem;
  problem.soup.meshes = {corners};
  problem.rays = rays;
  PromiseReport report;
  Tally tally(&report);
  solve_exactly(the_library(), &problem, &tally);
  const std::vector<std::uint64_t> expected{0, 1, 2, 3, 3};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), problem.rows.offsets.begin(),
                         problem.rows.offsets.end()));
  Random random(1);
  compare_every_way(the_library(), problem, ThreadCounts::kMost, &random, &tally);
  for (const VerifyFailure& failure : report.first_failures) ADD_FAILURE() << failure.what;
}

}  // namespace
}  // namespace raysheaf::checks
