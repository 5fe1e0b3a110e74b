// The plan's choices for different rays and scenes.
#include "queries/plan.h"

#include <functional>

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

/// As many rays as an image has, row by row, from nearly one point.
std::vector<Ray> picture(std::uint32_t side) {
  std::vector<Ray> rays;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side);
      const float v = static_cast<float>(y) / static_cast<float>(side);
      rays.push_back({{u, v, 0}, 0, {u - 0.5f, v - 0.5f, 1}, kInfinity});
    }
  return rays;
}

std::vector<Ray> disorder(std::size_t count, Random& random) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({random.in_box(5), 0, random.direction(), kInfinity});
  return rays;
}

/// Origins along rows, random directions: ambient occlusion.
std::vector<Ray> scattered(std::uint32_t side, Random& random) {
  std::vector<Ray> rays = picture(side);
  for (Ray& ray : rays) ray.direction = random.direction();
  return rays;
}

RayPlan plan_of(const std::vector<Ray>& rays) {
  return plan_rays(RaysInPlace(rays));
}

TEST(Plan, BundlesByCoherence) {
  Random random(2);
  const RayPlan camera = plan_of(picture(128));
  EXPECT_EQ(camera.bundle, Bundle::kStream);
  EXPECT_TRUE(camera.found.alike());
  EXPECT_EQ(camera.row, 128u);
  for (const auto& rays : {disorder(10000, random), scattered(128, random)}) {
    const RayPlan plan = plan_of(rays);
    EXPECT_EQ(plan.bundle, Bundle::kLongStream);
    EXPECT_FALSE(plan.found.alike());
    EXPECT_EQ(plan.row, 0u);
  }
}

TEST(Plan, StagesByCoherence) {
  Random random(5);
  const auto stages = [](const std::vector<Ray>& rays, bool any) {
    return make_plan(SceneHistory(), RaysInPlace(rays), any).stages;
  };
  EXPECT_EQ(stages(picture(128), true), Stages::kTiles);
  EXPECT_EQ(stages(scattered(128, random), false), Stages::kCopies);
  EXPECT_EQ(stages(disorder(20000, random), false), Stages::kCopies);
  EXPECT_EQ(stages(disorder(20000, random), true), Stages::kWhole);
  EXPECT_EQ(stages(disorder(300000, random), true), Stages::kCopies);
}

/// One of eight blocks of columns has scattered rays. No single block shows both kinds.
TEST(Plan, SamplesAllColumnsOfAnImage) {
  Random random(4);
  for (const std::size_t bad : {0u, 3u}) {
    std::vector<Ray> rays = picture(512);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (i / 64 % 8 == bad) rays[i].direction = random.direction();
    const Coherence found = sample_coherence(RaysInPlace(rays));
    EXPECT_GT(found.direction, 0.7);
    EXPECT_LT(found.direction, 1);
  }
}

TEST(Plan, GivenChoicesReplaceThoseOfThePlan) {
  const std::vector<Ray> rays = picture(128);
  const RaysInPlace source{View<const Ray>(rays)};
  const GivenChoices given{{}, Bundle::kLongStream, false, TreeWork::kRebuildFinely};
  const Plan plan = make_plan(SceneHistory(), source, false, given);
  EXPECT_EQ(plan.rays.bundle, Bundle::kLongStream);
  EXPECT_EQ(plan.stages, Stages::kCopies);
  EXPECT_EQ(plan.tree.work, TreeWork::kRebuildFinely);
}

TEST(Plan, CoherenceOfOrders) {
  Random random(3);
  const std::vector<Ray> rays = disorder(50000, random);
  const auto in_order = [&](const auto& part) {
    const auto place = [&](const Ray& ray) {
      return ray_place(part(ray), {{-5, -5, -5}, {5, 5, 5}}, 9);
    };
    std::vector<Ray> ordered = rays;
    std::sort(ordered.begin(), ordered.end(),
              [&](const Ray& a, const Ray& b) { return place(a) < place(b); });
    return sample_coherence(RaysInPlace(View<const Ray>(ordered)));
  };
  const Coherence before = sample_coherence(RaysInPlace(View<const Ray>(rays)));
  EXPECT_GT(before.origin, 0.5);
  EXPECT_EQ(before.direction, 0);
  const auto by_origin = [](const Ray& ray) { return Ray{ray.origin, 0, {1, 0, 0}, kInfinity}; };
  EXPECT_LT(in_order(by_origin).origin, 0.5 * before.origin);
  const auto by_direction = [](const Ray& ray) {
    return Ray{{0, 0, 0}, 0, ray.direction, kInfinity};
  };
  EXPECT_GT(in_order(by_direction).direction, 0.5);
  EXPECT_EQ(sample_coherence(RaysInPlace({})).origin, 0);
  for (const std::size_t few : {1, 15, 16, 17, 1023})
    EXPECT_LE(sample_coherence(RaysInPlace({rays.data(), few})).direction, 1);
}

SceneHistory history(std::uint32_t triangles, Joining joining = Joining::kNone) {
  SceneHistory scene;
  scene.replaced(triangles, joining);
  return scene;
}

/// With a tree.
SceneHistory built(std::uint32_t triangles, Joining joining = Joining::kNone,
                   TreeWork work = TreeWork::kRebuild) {
  SceneHistory scene = history(triangles, joining);
  scene.tree_was(work, 1);
  return scene;
}

/// The same, whose triangles have moved, and rays came, as often as makes a fine tree worth a try.
SceneHistory moving(std::uint32_t triangles, std::uint64_t rays, Joining joining = Joining::kNone) {
  SceneHistory scene = built(triangles, joining);
  for (int i = 0; i < 2; ++i) {
    scene.tree_was(TreeWork::kRefit, 1);
    scene.traced({rays, false});
    scene.moved();
  }
  return scene;
}

void expect_plan(const SceneHistory& scene, const TreeRays& rays, TreeWork work, TreeReason reason,
                 bool finely = false) {
  const TreePlan plan = scene.plan(rays);
  EXPECT_EQ(plan.work, work);
  EXPECT_EQ(plan.reason, reason);
  EXPECT_EQ(plan.finely, finely);
  EXPECT_GT(scene.slice(rays), 0);
}

constexpr TreeRays kFew{4000, false}, kMany{1000000000, false};

TEST(Plan, TreeOfUnmovedTriangles) {
  SceneHistory scene = history(5000);
  expect_plan(scene, kFew, TreeWork::kRebuild, TreeReason::kNew);
  scene.tree_was(TreeWork::kRebuild, 1);
  expect_plan(scene, kFew, TreeWork::kKeep, TreeReason::kUnmoved);
  scene.traced(kMany);
  expect_plan(scene, kFew, TreeWork::kKeep, TreeReason::kUnmoved, true);
  scene.tree_was(TreeWork::kRebuildFinely, 1);
  expect_plan(scene, kFew, TreeWork::kKeep, TreeReason::kUnmoved);
  scene.tree_changes();  // and was not completed
  expect_plan(scene, kFew, TreeWork::kRebuild, TreeReason::kNew);
  scene.replaced(5000, Joining::kNone);
  expect_plan(scene, kFew, TreeWork::kRebuild, TreeReason::kNew);
}

TEST(Plan, TreeOfMovingTriangles) {
  SceneHistory scene = built(5000);
  scene.traced({5000, false});
  scene.moved();
  expect_plan(scene, kFew, TreeWork::kRefit, TreeReason::kMoved);
  expect_plan(moving(5000, 0), kFew, TreeWork::kRefit, TreeReason::kMoved);
  expect_plan(moving(5000, 5000), kFew, TreeWork::kRefit, TreeReason::kMoved, true);
  // A fine tree takes longer to refit, for which few rays do not pay.
  expect_plan(moving(5000, 2500), kFew, TreeWork::kRefit, TreeReason::kMoved);
  expect_plan(moving(5000, 50000, Joining::kLeaves), kFew, TreeWork::kRefit, TreeReason::kMoved);
  scene = moving(5000, 5000);
  scene.tree_was(TreeWork::kRebuildFinely, 1);
  scene.traced(kFew);
  scene.moved();
  expect_plan(scene, kFew, TreeWork::kRefit, TreeReason::kMoved);
  scene.tree_was(TreeWork::kRefit, 1.6f);
  expect_plan(scene, kFew, TreeWork::kRebuild, TreeReason::kDegraded);
  scene.traced(kMany);
  scene.moved();
  expect_plan(scene, kFew, TreeWork::kRebuild, TreeReason::kDegraded);
  scene.tree_was(TreeWork::kRebuild, 1);  // after which it has small leaves again
  scene.traced(kMany);
  expect_plan(scene, kFew, TreeWork::kKeep, TreeReason::kUnmoved, true);
  scene.moved();
  expect_plan(scene, kFew, TreeWork::kRefit, TreeReason::kMoved);  // not at once
}

TEST(Plan, CoarseTreeForFewRays) {
  const TreeRays rays{10000, false};
  SceneHistory scene = history(100000);
  expect_plan(scene, rays, TreeWork::kRebuildCoarsely, TreeReason::kNew);
  expect_plan(history(40000), rays, TreeWork::kRebuildCoarsely, TreeReason::kNew);
  // Nodes of strips are a smaller part of the build.
  expect_plan(history(40000, Joining::kStrips), rays, TreeWork::kRebuild, TreeReason::kNew);
  EXPECT_EQ(scene.plan({}).work, TreeWork::kRebuild);
  scene.traced({100000, false});
  scene.replaced(100000, Joining::kNone);  // so many came for the former triangles
  expect_plan(scene, rays, TreeWork::kRebuild, TreeReason::kNew);
  scene = built(100000, Joining::kNone, TreeWork::kRebuildCoarsely);
  scene.traced(rays);
  expect_plan(scene, rays, TreeWork::kKeep, TreeReason::kUnmoved);
  for (int i = 0; i < 4; ++i) scene.traced(rays);
  // Few rays do not wait for a whole build, only for a slice of a fine one.
  expect_plan(scene, rays, TreeWork::kKeep, TreeReason::kUnmoved, true);
  expect_plan(scene, kMany, TreeWork::kRebuild, TreeReason::kOutgrown);
  EXPECT_EQ(scene.plan({}).reason, TreeReason::kOutgrown);
  SceneHistory joined = built(100000, Joining::kLeaves, TreeWork::kRebuildCoarsely);
  for (int i = 0; i < 5; ++i) joined.traced(rays);
  expect_plan(joined, rays, TreeWork::kRebuild, TreeReason::kOutgrown);
  scene.moved();
  expect_plan(scene, rays, TreeWork::kRebuild, TreeReason::kOutgrown);
  scene.tree_was(TreeWork::kRefit, 1);  // which saved time
  scene.moved();
  expect_plan(scene, rays, TreeWork::kRefit, TreeReason::kMoved);
  scene.tree_was(TreeWork::kRefit, 2);
  expect_plan(scene, rays, TreeWork::kRebuildCoarsely, TreeReason::kDegraded);
}

/// Coherent any-hit rays lose less in large leaves.
TEST(Plan, CoarseTreeForShadows) {
  const std::vector<Ray> rays = picture(256);
  const auto work = [&](std::uint32_t triangles, bool any) {
    return make_plan(history(triangles), RaysInPlace(rays), any).tree.work;
  };
  EXPECT_EQ(work(30000, true), TreeWork::kRebuildCoarsely);
  EXPECT_EQ(work(30000, false), TreeWork::kRebuild);
  EXPECT_EQ(work(10000, true), TreeWork::kRebuild);
}

/// The refits of a coarse tree save what its rays lose.
TEST(Plan, CoarseTreeStaysWhereTrianglesMoveBetweenShadows) {
  const auto stays = [](bool together) {
    SceneHistory scene = built(200000, Joining::kNone, TreeWork::kRebuildCoarsely);
    const TreeRays rays{100000, together};
    for (int i = 0; i < 20; ++i) {
      scene.traced(rays);
      scene.moved();
      const TreePlan plan = scene.plan(rays);
      if (plan.work != TreeWork::kRefit || plan.finely) return false;
      scene.tree_was(TreeWork::kRefit, 1);
    }
    return true;
  };
  EXPECT_TRUE(stays(true));
  EXPECT_FALSE(stays(false));
}

TEST(Plan, WaitsLongerAfterEveryFineTreeInVain) {
  SceneHistory scene = built(1000);
  std::uint32_t last = 0;
  for (int attempt = 0; attempt < 8; ++attempt) {
    std::uint32_t moves = 0;
    do {
      scene.tree_was(TreeWork::kRefit, 1);
      scene.traced(kMany);
      scene.moved();
      ++moves;
    } while (!scene.plan(kFew).finely);
    EXPECT_GT(moves, last);
    last = moves;
    scene.fine_tree_was_given_up();
  }
  for (int i = 0; i < 40; ++i) scene.fine_tree_was_given_up();
  EXPECT_FALSE(scene.plan(kFew).finely);  // the number of moves does not overflow
}

/// The work on the tree in some frames, of which each has the same rays.
std::vector<TreeWork> works(const Costs& costs, std::uint32_t triangles, Joining joining,
                            const TreeRays& rays, bool moves) {
  std::vector<TreeWork> all;
  SceneHistory scene(costs);
  scene.replaced(triangles, joining);
  for (int frame = 0; frame < 40; ++frame) {
    const TreePlan plan = scene.plan(rays);
    all.push_back(plan.finely ? TreeWork::kRebuildFinely : plan.work);
    scene.tree_was(all.back(), 1);
    scene.traced(rays);
    if (moves) scene.moved();
  }
  return all;
}

/// Half or twice of each cost changes the plan of some scenes and rays.
TEST(Plan, EveryCostDecidesSomething) {
  using Table = Costs::ByJoining;
  std::vector<std::pair<const char*, std::function<void(Costs&, double)>>> costs;
  const auto number = [&](const char* name, double Costs::*cost) {
    costs.emplace_back(name, [cost](Costs& all, double factor) { all.*cost *= factor; });
  };
  const auto table = [&](const char* name, Table Costs::*cost) {
    costs.emplace_back(name, [cost](Costs& all, double factor) {
      for (double& one : all.*cost) one *= factor;
    });
  };
  number("build", &Costs::build);
  table("coarse_build_saves", &Costs::coarse_build_saves);
  table("coarse_refit_saves", &Costs::coarse_refit_saves);
  number("fine_build", &Costs::fine_build);
  number("fine_refit_adds", &Costs::fine_refit_adds);
  number("ray_level", &Costs::ray_level);
  table("fine_saves", &Costs::fine_saves);
  number("coarse_ray", &Costs::coarse_ray);
  number("coarse_ray_together", &Costs::coarse_ray_together);
  for (const auto& [name, scale] : costs)
    for (const double factor : {0.5, 2.0}) {
      Costs changed;
      scale(changed, factor);
      bool differs = false;
      for (std::uint32_t triangles = 1 << 10; triangles < 1 << 24; triangles *= 4)
        for (std::uint64_t rays = 1 << 12; rays < 1 << 22; rays *= 4)
          for (int way = 0; way < 12; ++way) {
            const auto joining = static_cast<Joining>(way % 3);
            const TreeRays some{rays, way / 3 % 2 != 0};
            differs |= works({}, triangles, joining, some, way >= 6) !=
                       works(changed, triangles, joining, some, way >= 6);
          }
      EXPECT_TRUE(differs) << name << " times " << factor;
    }
}

TEST(Plan, ExplainsItsChoices) {
  using Sentences = std::vector<std::string>;
  const auto tree = [](TreeWork work, TreeReason reason, bool finely = false, bool gained = false) {
    return explain(TreePlan{work, reason, finely, {}, gained});
  };
  EXPECT_EQ(tree(TreeWork::kRebuild, TreeReason::kNew),
            Sentences{"object tree: built, because these triangles are new"});
  EXPECT_EQ(tree(TreeWork::kRebuildCoarsely, TreeReason::kDegraded),
            Sentences{"object tree: built again, because moves have degraded it; with large "
                      "leaves, because they are many for these rays"});
  EXPECT_EQ(tree(TreeWork::kRebuild, TreeReason::kOutgrown),
            Sentences{"object tree: built again with small leaves, because so many rays have met "
                      "these triangles"});
  EXPECT_EQ(tree(TreeWork::kKeep, TreeReason::kUnmoved, true),
            (Sentences{"fine object tree: a slice of it is built at each query, because so many "
                       "rays have met triangles that do not move",
                       "object tree: kept, because no triangle has moved"}));
  EXPECT_EQ(tree(TreeWork::kRefit, TreeReason::kMoved, true, true),
            (Sentences{"fine object tree: a slice of it is built at each query, because the same "
                       "triangles keep moving",
                       "object tree: refitted, because the same triangles have moved",
                       "object tree: built again after all, because triangles without area have "
                       "gained an area"}));
  EXPECT_EQ(tree(TreeWork::kRebuildFinely, TreeReason::kMoved, true),
            Sentences{"object tree: built finely, in slices"});
  const std::vector<Ray> rays = picture(128);
  EXPECT_EQ(explain(make_plan(built(1000), RaysInPlace(rays), false)),
            (Sentences{"object tree: kept, because no triangle has moved",
                       "rays: sixteen in a row start within 12 % of the batch's extent",
                       "bundles: streams, because 80 % of neighbours are coherent",
                       "order: tiles of four by four, because rows of 128 rays are adjacent",
                       "stages: one after the other for tiles of 8192 rays, because neighbours are "
                       "coherent"}));
  EXPECT_EQ(explain(RayPlan{{0.5, 0.9}, false, Bundle::kLongStream}),
            (Sentences{"rays: sixteen in a row start 50 % of the scene's extent apart",
                       "bundles: long streams, because only 0 % of neighbours are coherent"}));
}

/// Directions and origins at the limits of binary32 must not make any figure NaN.
TEST(Plan, ExtremeRays) {
  Random random(6);
  for (const float scale : {1e-44f, 1e-20f, 1e20f, 3e38f}) {
    std::vector<Ray> rays = disorder(500, random);
    for (Ray& ray : rays) {
      ray.origin = ray.origin * (0.2f * scale);
      ray.direction = ray.direction * scale;
      if (!(max_component(abs(ray.direction)) > 0)) ray.direction = {0, 0, 1e-45f};
    }
    for (const std::string& reason : explain(plan_of(rays))) {
      EXPECT_EQ(reason.find("nan"), std::string::npos) << reason;
      EXPECT_EQ(reason.find("inf"), std::string::npos) << reason;
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
