// The statistics of bundles: sizes are correct, and bounds contain their rays.
#include "paper/bundle_samples.h"

#include <gtest/gtest.h>

#include "paper/base/flat_arrays.h"
#include "paper/bounds/bounds.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/render.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

RenderResult rendered(Method method, std::uint32_t samples, std::uint32_t threads = 0) {
  RenderOptions options = test::small_options(40);
  options.method = method;
  options.bundle_samples = samples;
  options.threads = threads;
  return render(builtin_scene("cornell"), options);
}

std::vector<BundleSample> all_bundles(const RenderResult& result) {
  std::vector<BundleSample> all;
  for (const BatchStatistics& batch : result.statistics.batches)
    all.insert(all.end(), batch.bundles.begin(), batch.bundles.end());
  return all;
}

TEST(Bundles, BoundsThatReadSpheresMeetAllThatIsNeeded) {
  for (const Method method : {Method::kRah, Method::kCrsh}) {
    const std::vector<BundleSample> bundles = all_bundles(rendered(method, 20));
    ASSERT_FALSE(bundles.empty());
    for (const BundleSample& bundle : bundles) {
      ASSERT_TRUE(bundle.level == 1 || bundle.level == 2);
      EXPECT_GE(bundle.rays, 1u);
      EXPECT_LE(bundle.rays, bundle.level == 1 ? 8u : 64u);
      EXPECT_GE(bundle.needed, 1u) << "the sphere that the rays leave from";
      EXPECT_GE(bundle.accepted, bundle.needed);
      EXPECT_GE(bundle.looseness(), 1);
      EXPECT_GE(bundle.origin_spread, 0);
      EXPECT_LE(bundle.origin_spread, 1.0001f);
      EXPECT_GE(bundle.direction_spread, 0);
      EXPECT_LE(bundle.direction_spread, 180);
    }
  }
}

TEST(Bundles, PacketsAreMeasuredToo) {
  const std::vector<BundleSample> bundles = all_bundles(rendered(Method::kGl10, 20));
  ASSERT_FALSE(bundles.empty());
  for (const BundleSample& bundle : bundles) {
    EXPECT_EQ(bundle.level, 1u);
    EXPECT_GE(bundle.rays, 1u);
    EXPECT_LE(bundle.rays, kPacketRays);
    EXPECT_GE(bundle.accepted, 1u) << "the triangle that the rays leave from";
    EXPECT_GE(bundle.needed, 1u);
  }
}

TEST(Bundles, MeasuringChangesNothingAndIsTheSameWithAnyThreads) {
  for (const Method method : {Method::kRah, Method::kGl10, Method::kBrute, Method::kDual}) {
    const RenderResult without = rendered(method, 0), with = rendered(method, 7, 1),
                       threads = rendered(method, 7, 3);
    EXPECT_TRUE(all_bundles(without).empty());
    EXPECT_TRUE(test::same_bits(without.beauty, with.beauty));
    for (std::size_t i = 0; i < with.statistics.batches.size(); ++i) {
      EXPECT_EQ(without.statistics.batches[i].total_tests(),
                with.statistics.batches[i].total_tests());
      EXPECT_LE(with.statistics.batches[i].bundles.size(), 14u) << "seven a level";
    }
    const std::vector<BundleSample> one = all_bundles(with), three = all_bundles(threads);
    ASSERT_EQ(one.size(), three.size());
    EXPECT_EQ(one.empty(), method == Method::kBrute || method == Method::kDual);
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].accepted, three[i].accepted);
      EXPECT_EQ(one[i].needed, three[i].needed);
      EXPECT_EQ(one[i].direction_spread, three[i].direction_spread);
    }
  }
}

// Two rays with distance 1, one of them turned by 90 degrees, and a distant square that neither
// hits.
TEST(Bundles, SpreadsAreWhatTheyAreCalled) {
  SceneDescription scene;
  scene.meshes = {test::floor_square(10, 0), test::floor_square(10, 7)};
  scene.instances = {{}, {}};
  scene.instances[1].mesh = 1;
  scene.materials.resize(1);
  const Executor executor(1);
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  const float diagonal = std::sqrt(20.f * 20 + 20 * 20 + 7 * 7);
  const std::vector<Ray> rays = {{{0, 1, 0}, 0, {0, 0, 2}, 0.25f}, {{1, 1, 0}, 0, {1, 0, 0}, 1}};
  const auto tree = build_hierarchy<Shaft>(executor, rays, flat.bounds, 2, 1);
  std::vector<BundleSample> samples;
  sample_bundles(executor, FlatArrays(executor, flat).view(), tree, View<const Ray>(rays), 5,
                 &samples);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].rays, 2u);
  EXPECT_NEAR(samples[0].origin_spread, 1 / diagonal, 1e-6f);
  EXPECT_NEAR(samples[0].direction_spread, 45, 1e-3f);
  EXPECT_EQ(samples[0].accepted, 0u) << "the shaft stays between the squares";
  EXPECT_EQ(samples[0].needed, 4u) << "but inside the spheres of their triangles";
}

}  // namespace
}  // namespace raysheaf
