// Shading many fragments at a time gives the bits of shading them one by one, on every SIMD target.
#include "render/rays/point_light.h"

#include <gtest/gtest.h>

#include <cstring>

#include "render/rays/raygen.h"
#include "render/rays/shadow_body.h"
#include "support/pictures.h"
#include "support/random.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

/// Random places and normals; some fragments have no surface or no light, some lie at a light's own
/// place, and some so far away that squared distances overflow.
Fragments some_fragments(std::size_t count, View<const PlacedLight> lights) {
  test::Random random(11);
  Fragments fragments(count);
  for (std::size_t i = 0; i < count; ++i) {
    Fragment& f = fragments[i] = {};
    f.triangle = random.below(9) == 0 ? kInvalidId : 0;
    f.pixel = static_cast<std::uint32_t>(i);
    Surface& s = f.surface;
    s.unlit = random.below(11) == 0;
    s.position = random.in_box(3);
    if (random.below(20) == 0) s.position = lights[random.below(3)].position;
    if (random.below(20) == 0) s.position = s.position * 1e17f;
    s.normal = random.direction();
    s.geometric_normal = random.direction_near(s.normal, 0.3f);
    s.clearance = 1e-6f * random.unit();
  }
  return fragments;
}

std::vector<PlacedLight> all_kinds_of_lights() {
  std::vector<Light> lights(7, test::point_light({0.5f, 2, -1}, 40));
  lights[1].range = 2.5f;
  lights[2].type = Light::Type::kSpot;
  lights[2].direction = normalized({0.2f, -1, 0.1f});
  lights[2].inner_angle = 0.2f, lights[2].outer_angle = 0.9f;
  lights[3] = lights[2];
  lights[3].range = 4;
  lights[3].radius = 0.25f;
  lights[4].type = Light::Type::kDirectional;
  lights[5].type = Light::Type::kRectangle;
  lights[5].direction = {0, -1, 0};
  lights[5].width = lights[5].height = 1;
  lights[6].intensity = {0, 0, 0};
  return placed_lights(lights);
}

void expect_one_by_one(const Executor& executor, const Fragments& fragments,
                       const std::vector<PlacedLight>& lights, SampleOf sample,
                       const char* target) {
  const Box box{{-3, -3, -3}, {3, 3, 3}};
  const auto count = static_cast<std::uint32_t>(lights.size()) - 1;
  const RayBatch batch = make_shadow_rays(executor, fragments, lights, 1, count, box, sample);
  const RayBatch bare =
      make_shadow_rays(executor, fragments, lights, 1, count, box, sample, Keys::kNone);
  EXPECT_TRUE(bare.keys.empty() && bare.places.empty() && bare.lights.empty());
  EXPECT_EQ(bare.slots, batch.slots);
  EXPECT_EQ(bare.light_ends, batch.light_ends);
  ASSERT_EQ(batch.light_ends.size(), count);
  std::size_t next = 0;
  for (std::uint32_t l = 0; l < count; ++l) {
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const LightSample seen = choose_on_light(fragments[i], lights[l + 1], l + 1, sample);
      if (!faces_light(fragments[i], seen)) continue;
      ASSERT_LT(next, batch.rays.size()) << target;
      ASSERT_EQ(batch.slots[next], l * fragments.size() + i) << target;
      const Ray expected = shadow_ray(fragments[i], seen, light_reach(box));
      ASSERT_EQ(std::memcmp(&batch.rays[next], &expected, sizeof expected), 0) << target;
      ASSERT_EQ(std::memcmp(&bare.rays[next], &expected, sizeof expected), 0) << target;
      ASSERT_EQ(batch.lights[next++], l + 1);
    }
    EXPECT_EQ(batch.light_ends[l], next);
  }
  EXPECT_EQ(batch.rays.size(), next);
  if (fragments.size() > 100) {
    EXPECT_GT(next, count * fragments.size() / 8);
  }
}

TEST(PointLights, ShadowRaysAreThoseOfOneFragmentAfterTheOther) {
  const std::vector<PlacedLight> lights = all_kinds_of_lights();
  const Executor executor(3);
  for (const std::size_t size : {1u, 15u, 16u, 257u, 3000u}) {
    const Fragments fragments = some_fragments(size, lights);
    test::for_each_simd_target([&](const char* target) {
      expect_one_by_one(executor, fragments, lights, {}, target);
      expect_one_by_one(executor, fragments, lights, {1, 4}, target);
    });
  }
}

/// Near the horizon, where the test must be right, and far out, where positions are coarse.
TEST(SizedLights, ThatAreTurnedAwayFaceNoSample) {
  std::size_t away = 0, others = 0;
  for (const float far : {0.0f, 1000.0f}) {
    for (std::uint32_t i = 0; i < 4000; ++i) {
      const float tilt = 1e-3f * static_cast<float>(i % 2000) - 1;
      Light light;
      light.type = i % 2 == 0 ? Light::Type::kPoint : Light::Type::kRectangle;
      light.position = {far + 0.3f, far + tilt, far - 0.2f};
      light.direction = {0, 0, 1};
      light.right = {1, 0, 0};
      light.radius = i % 2 == 0 ? 0.25f : 0.0f;
      light.width = light.height = i % 2 == 0 ? 0.0f : 0.5f;
      const PlacedLight placed = placed_light(light);
      Fragment f;
      f.triangle = 0;
      f.surface.position = {far, far, far + 0.1f};
      f.surface.normal = {0, 1, 0};
      const bool turned = turned_away(f.surface, placed);
      ++(turned ? away : others);
      for (std::uint32_t k = 0; turned && k < 16; ++k)
        ASSERT_FALSE(faces_light(f, choose_on_light(f, placed, 0, {k, 16}))) << far << " " << i;
    }
  }
  EXPECT_GT(away, 1000u);
  EXPECT_GT(others, 1000u);
}

TEST(PointLights, NoFragmentsHaveNoRays) {
  const std::vector<PlacedLight> lights = all_kinds_of_lights();
  const RayBatch batch = make_shadow_rays(Executor(1), Fragments{}, lights, 0, 2, {});
  EXPECT_TRUE(batch.rays.empty());
  EXPECT_EQ(batch.light_ends, (std::vector<std::uint32_t>{0, 0}));
}

}  // namespace
}  // namespace raysheaf
