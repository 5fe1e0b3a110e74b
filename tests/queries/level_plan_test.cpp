// The choice between two levels and placed instances never costs more than about twice the better.
#include "queries/level_plan.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/random.h"

namespace raysheaf::test {
namespace {

double ns_of_placing(const LevelWork& work) {
  const LevelCosts costs;
  return costs.moved_triangle * static_cast<double>(work.moved_triangles) +
         costs.new_triangle * static_cast<double>(work.new_triangles);
}
double ns_of_entering(const LevelWork& work) {
  const LevelCosts costs;
  return costs.mesh_triangle * static_cast<double>(work.missing_triangles) +
         costs.instance * static_cast<double>(work.instances) +
         costs.ray * static_cast<double>(work.rays);
}

TEST(LevelPlan, FewRaysEnterAndManyDoNot) {
  LevelPlan plan;
  const auto enters = [&](const LevelWork& work) { return plan.enters(work, plan.spent_ns()); };
  EXPECT_TRUE(enters({.moved_triangles = 100000, .instances = 50, .rays = 10}));
  EXPECT_FALSE(enters({.moved_triangles = 100000, .instances = 50, .rays = 100000}));
  EXPECT_FALSE(enters({.moved_triangles = 12, .instances = 1, .rays = 1}));
  // A pass that most rays leave soon costs less.
  LevelWork some{.moved_triangles = 10000, .instances = 10, .rays = 2000};
  EXPECT_FALSE(enters(some));
  some.in_part = true;
  EXPECT_TRUE(enters(some));
}

/// A scene that moves once, and then is asked for long.
TEST(LevelPlan, PlacesAStillSceneAfterEnoughRays) {
  Random random(1);
  for (int n = 0; n < 300; ++n) {
    LevelPlan plan;
    LevelWork work{.moved_triangles = 1 + random.below(1u << random.below(24)),
                   .missing_triangles = random.below(2) == 0 ? 0u : random.below(1000),
                   .instances = 1 + random.below(1000)};
    const double place = ns_of_placing(work);
    double spent = 0, without_levels = place, without_placing = ns_of_entering(work);
    bool is_placed = false;
    for (int query = 0; query < 2000 && !is_placed; ++query) {
      work.rays = 1 + random.below(5000);
      is_placed = !plan.enters(work, 0);
      spent += is_placed ? place : ns_of_entering(work);
      without_placing += LevelCosts().ray * static_cast<double>(work.rays);
      if (!is_placed) work.missing_triangles = work.instances = 0;
    }
    EXPECT_LE(spent,
              2.01 * std::min(without_levels, without_placing) + LevelCosts().mesh_triangle * 1000);
  }
}

TEST(LevelPlan, RaysDoNotPayForPlacingManyTrianglesOfSharedMeshes) {
  LevelPlan plan;
  LevelWork work{.new_triangles = 8'000'000,
                 .missing_triangles = 20'000,
                 .instances = 400,
                 .rays = 1'000'000,
                 .placed_triangles = 8'000'000,
                 .mesh_triangles = 20'000};
  EXPECT_TRUE(plan.enters(work, 0));
  work.missing_triangles = work.instances = 0;
  for (int query = 0; query < 100; ++query) EXPECT_TRUE(plan.enters(work, 0));
  work.new_triangles = 0;  // placed for another query
  EXPECT_FALSE(plan.enters(work, 0));
}

/// Instances that come to rest one after the other are placed in this order.
TEST(LevelPlan, PlacesWhatHasStoodForLong) {
  LevelPlan plan;
  const LevelWork work{.moved_triangles = 100000, .instances = 10, .rays = 1000, .in_part = true};
  const double first = plan.spent_ns();
  for (int query = 0; query < 20; ++query) EXPECT_TRUE(plan.enters(work, plan.spent_ns()));
  const double second = plan.spent_ns();
  EXPECT_GT(first, plan.paid_since(work));
  while (first > plan.paid_since(work)) EXPECT_TRUE(plan.enters(work, second));
  EXPECT_GT(second, plan.paid_since(work));
  EXPECT_NEAR(plan.spent_ns(), ns_of_placing(work), 1e5);
}

/// A scene that moves in every frame, whose meshes have no trees yet: they are built once placing
/// has cost as much.
TEST(LevelPlan, BuildsTreesOfMeshesWhenTheyWouldHavePaid) {
  LevelPlan plan;
  const LevelWork work{
      .moved_triangles = 10000, .missing_triangles = 80000, .instances = 10, .rays = 10};
  int placed = 0;
  while (!plan.enters(work, plan.spent_ns())) ++placed;
  const double saves = ns_of_placing(work) - LevelCosts().instance * 10 - LevelCosts().ray * 10;
  EXPECT_NEAR(placed, LevelCosts().mesh_triangle * 80000 / saves, 1);
}

}  // namespace
}  // namespace raysheaf::test
