#include "render/rays/raygen.h"

#include <gtest/gtest.h>

#include <cstring>

#include "render/frame/brute_force.h"
#include "render/frame/primary.h"
#include "render/rays/hash_body.h"
#include "render/rays/scatter_body.h"
#include "render/rays/shadow_body.h"
#include "support/pictures.h"
#include "support/random.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

/// A prepared scene with the fragments of its first camera.
struct Seen {
  explicit Seen(SceneDescription description) : scene(std::move(description)), textures(scene) {
    flat = flatten(executor, scene, mesh_bounds(executor, scene));
    BatchStatistics statistics;
    ProgressMeter meter;
    const MethodSettings method = method_settings(Method::kCrsh);
    const CameraFrame frame = make_camera_frame(scene.cameras[0], 64, 64);
    const auto triangles = trace_primary(executor, flat, frame, method, &statistics, {}, &meter);
    fragments = fetch_fragments(executor, flat, textures, frame, triangles);
  }

  [[nodiscard]] RayBatch shadow_rays() const {
    return make_shadow_rays(executor, fragments, placed_lights(scene.lights), 0,
                            static_cast<std::uint32_t>(scene.lights.size()), flat.bounds);
  }
  [[nodiscard]] std::vector<RayHit> closest(View<const Ray> rays) const {
    std::vector<RayHit> hits(rays.size);
    ProgressMeter meter;
    intersect_brute_force(executor, flat.source(), rays, Facing::kBoth, hits, &meter);
    return hits;
  }

  Executor executor{2};
  SceneDescription scene;
  TextureSet textures;
  FlatScene flat;
  Fragments fragments;
};

/// Scales the scene about the origin, including lights and camera.
SceneDescription scaled(SceneDescription scene, float factor) {
  for (Mesh& mesh : scene.meshes)
    for (Vec3& p : mesh.positions) p *= factor;
  for (Light& light : scene.lights) light.position *= factor;
  for (Camera& camera : scene.cameras) {
    for (auto& row : camera.to_world.m) row[3] *= factor;
    camera.z_near *= factor;
  }
  return scene;
}

TEST(ShadowRays, StandWhereTheShadingNormalFacesTheLightAndKnowTheirSlots) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights.push_back(test::point_light({-4, 3, 1}, 50));
  Light sun;
  sun.type = Light::Type::kDirectional;
  sun.direction = normalized({-1, -2, -0.5f});
  scene.lights.push_back(sun);
  const Seen seen(scene);
  const RayBatch batch = seen.shadow_rays();
  std::size_t expected = 0, next = 0;
  for (std::size_t slot = 0; slot < 3 * seen.fragments.size(); ++slot) {
    const Fragment& f = seen.fragments[slot % seen.fragments.size()];
    const Light& light = scene.lights[slot / seen.fragments.size()];
    if (f.triangle == kInvalidId) continue;
    const Vec3 to_light = light.type == Light::Type::kDirectional
                              ? -light.direction
                              : light.position - f.surface.position;
    if (!(dot(f.surface.normal, to_light) > 0)) continue;
    ++expected;
    ASSERT_EQ(batch.slots[next], slot);
    const Ray& ray = batch.rays[next++];
    EXPECT_EQ(ray.t_min, 0);
    EXPECT_EQ(ray.t_max, 1);
    EXPECT_LT(length(ray.origin + ray.direction - f.surface.position), 1e-3f);
    if (light.type == Light::Type::kPoint) {
      EXPECT_EQ(ray.origin, light.position);
    } else {
      const Vec3 below = ray.origin - seen.flat.bounds.min,
                 above = seen.flat.bounds.max - ray.origin;
      EXPECT_LT(min_component(min(below, above)), 0);
    }
  }
  EXPECT_EQ(batch.rays.size(), expected);
  EXPECT_EQ(batch.keys.size(), expected);
  EXPECT_GT(expected, 1000u);
}

TEST(ShadowRays, EndJustBeforeTheFragmentAtEveryScale) {
  // The lit side of a convex body cannot shadow itself: any hit would be the surface's own.
  for (const float scale : {1e-3f, 1.0f, 1e3f}) {
    SceneDescription scene;
    test::add_mesh(&scene, test::ball(40, 1, {3, 0, 0}));
    scene.lights.push_back(test::point_light({3, 5, 5}, 10));
    scene.cameras.push_back(test::camera_at({3, 2, 5}, {3, 0, 0}));
    const Seen seen(scaled(scene, scale));
    const RayBatch batch = seen.shadow_rays();
    const std::vector<RayHit> hits = seen.closest(batch.rays);
    int occluded = 0, facing = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const Surface& s = seen.fragments[batch.slots[i]].surface;
      if (dot(s.geometric_normal, seen.scene.lights[0].position - s.position) <= 0) continue;
      ++facing;
      occluded += hits[i].found() ? 1 : 0;
    }
    EXPECT_EQ(occluded, 0) << "scale " << scale;
    EXPECT_GT(facing, 200);
  }
}

TEST(ShadowRays, ReachTheFloorUnlessTheBallStandsBetween) {
  const Seen seen(test::ball_on_floor());
  const RayBatch batch = seen.shadow_rays();
  const std::vector<RayHit> hits = seen.closest(batch.rays);
  const Vec3 light = seen.scene.lights[0].position, center{0, 1, 0};
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Vec3 p = seen.fragments[batch.slots[i]].surface.position;
    if (p.y > 1e-3f) continue;
    const Vec3 along = normalized(p - light);
    const float distance = length(cross(center - light, along));
    if (distance > 1.001f) {
      EXPECT_FALSE(hits[i].found()) << i;
    }
    if (distance < 0.97f) {
      EXPECT_TRUE(hits[i].found()) << i;
    }
  }
}

TEST(ShadowRays, SpotsAndRangesLimitThem) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights[0].range = 0.5f;
  EXPECT_TRUE(Seen(scene).shadow_rays().rays.empty());
  scene.lights[0].range = std::numeric_limits<float>::infinity();
  scene.lights[0].type = Light::Type::kSpot;
  scene.lights[0].direction = normalized(Vec3{0, 1, 0} - scene.lights[0].position);
  scene.lights[0].outer_angle = 0.1f;
  const std::size_t narrow = Seen(scene).shadow_rays().rays.size();
  scene.lights[0].outer_angle = 1.2f;
  EXPECT_GT(narrow, 0u);
  EXPECT_LT(narrow, Seen(scene).shadow_rays().rays.size());
}

TEST(BounceRays, MirrorsReflectAboutTheNormalAndDoNotMeetThemselves) {
  for (const float scale : {1e-3f, 1.0f, 1e3f}) {
    Material mirror;
    mirror.metallic = 1;
    mirror.roughness = 0;
    const Seen seen(scaled(test::ball_on_floor(mirror), scale));
    const RayBatch batch =
        make_bounce_rays(seen.executor, seen.fragments, RayKind::kReflection, seen.flat.bounds);
    ASSERT_GT(batch.rays.size(), 200u);
    const std::vector<RayHit> hits = seen.closest(batch.rays);
    for (std::size_t i = 0; i < batch.rays.size(); ++i) {
      const Fragment& f = seen.fragments[batch.slots[i]];
      const Vec3 d = batch.rays[i].direction;
      EXPECT_NEAR(length(d), 1, 1e-5f);
      EXPECT_GT(dot(d, f.surface.geometric_normal), 0);
      // A convex sphere never hits its own mirror rays.
      if (hits[i].found()) {
        EXPECT_NE(seen.flat.mesh_of_triangle[hits[i].triangle], 0u) << i;
      }
    }
  }
}

TEST(BounceRays, RoughAndUnlitSurfacesHaveNone) {
  Material rough;
  rough.roughness = 0.5f;
  const Seen seen(test::ball_on_floor(rough));
  for (const RayKind kind : {RayKind::kReflection, RayKind::kRefraction})
    EXPECT_TRUE(
        make_bounce_rays(seen.executor, seen.fragments, kind, seen.flat.bounds).rays.empty());
}

Fragment glass_fragment(Vec3 incoming, bool front) {
  Fragment f;
  f.incoming = normalized(incoming);
  f.triangle = 0;
  f.surface.geometric_normal = f.surface.normal = {0, 1, 0};
  f.surface.transmission = 1;
  f.surface.transmission_color = {1, 1, 1};
  f.surface.ior = 1.5f;
  f.surface.specular = f.surface.coat = {0.04f, 0.04f, 0.04f};
  f.surface.front = front;
  return f;
}

TEST(Scatter, RefractionObeysSnell) {
  for (const float angle : {0.1f, 0.5f, 1.0f, 1.4f}) {
    const Fragment f = glass_fragment({std::sin(angle), -std::cos(angle), 0}, true);
    const Scattering s = scatter(f);
    EXPECT_NEAR(s.refraction.x, std::sin(angle) / 1.5f, 1e-5f);
    EXPECT_LT(s.refraction.y, 0);
    EXPECT_NEAR(s.reflection.x, std::sin(angle), 1e-5f);
    EXPECT_GT(s.reflection.y, 0);
    EXPECT_NEAR(s.reflected_part.x + s.refracted_part.x, 1, 1e-6f);
  }
}

TEST(Scatter, AThinSheetLetsLightStraightThroughFromEitherSide) {
  for (const float angle : {0.0f, 0.5f, 0.8f, 1.4f}) {
    Fragment f = glass_fragment({std::sin(angle), -std::cos(angle), 0}, true);
    f.surface.transmission_color = {0.25f, 0.5f, 1};
    const Scattering solid = scatter(f);
    f.surface.thin = true;
    for (const bool front : {true, false}) {
      f.surface.front = front;
      const Scattering s = scatter(f);
      EXPECT_EQ(s.refraction, f.incoming) << angle << front;
      EXPECT_EQ(s.reflection, solid.reflection);
      EXPECT_EQ(s.reflected_part, solid.reflected_part) << "Fresnel's, from outside";
      EXPECT_EQ(s.refracted_part, solid.refracted_part) << "tinted";
    }
  }
}

TEST(Scatter, BeyondTheCriticalAngleEverythingIsReflected) {
  const Fragment f = glass_fragment({std::sin(0.8f), -std::cos(0.8f), 0}, false);
  const Scattering s = scatter(f);
  EXPECT_EQ(s.reflected_part.x, 1);
  EXPECT_EQ(s.refracted_part.x, 0);
}

TEST(Scatter, FresnelAtNormalIncidenceIsTheTextbookValue) {
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(fresnel_dielectric(1, 1 / 1.5f), 0.04f, 1e-6f);
  EXPECT_EQ(fresnel_dielectric(0, 1.5f), 1);
}

TEST(Scatter, PartsNeverExceedTheWhole) {
  test::Random random(6);
  for (int i = 0; i < 20000; ++i) {
    Fragment f = glass_fragment(random.direction(), random.below(2) == 0);
    if (f.incoming.y > 0) f.incoming = -f.incoming;
    f.surface.normal = random.direction_near({0, 1, 0}, 0.5f);
    f.surface.transmission = random.below(2) == 0 ? 0 : random.unit();
    f.surface.thin = random.below(2) == 0;
    f.surface.diffuse = Vec3{1, 1, 1} * (1 - f.surface.transmission);
    const float f0 = random.unit();
    f.surface.specular = f.surface.coat = {f0, f0, f0};
    f.surface.specular_edge = f.surface.coat_edge = f0 + (1 - f0) * random.unit();
    const Scattering s = scatter(f);
    const float whole =
        s.reflected_part.x + s.refracted_part.x + s.diffuse_part.x * f.surface.diffuse.x;
    EXPECT_LE(whole, 1 + 1e-5f);
    EXPECT_GE(min_component(s.refracted_part), 0);
  }
}

/// Random mirrors and glass; the normal of some leans behind the ray, and some have no direction.
Fragments some_bouncing(std::size_t count) {
  test::Random random(12);
  Fragments fragments(count);
  for (std::size_t i = 0; i < count; ++i) {
    Fragment& f = fragments[i] = {};
    if (random.below(9) == 0) continue;
    f.triangle = 0;
    f.pixel = static_cast<std::uint32_t>(i);
    f.incoming = random.direction();
    f.weight = random.in_box(0.5f) + Vec3{0.5f, 0.5f, 0.5f};
    Surface& s = f.surface;
    s.position = random.in_box(3);
    s.clearance = 1e-6f * random.unit();
    s.normal = random.direction();
    s.geometric_normal = random.direction_near(s.normal, 0.3f);
    if (dot(s.geometric_normal, f.incoming) > 0) s.geometric_normal = -s.geometric_normal;
    if (random.below(30) == 0) f.incoming = s.normal = s.geometric_normal = {0, 0, 0};
    s.specular = random.in_box(0.5f) + Vec3{0.5f, 0.5f, 0.5f};
    s.specular_edge = random.unit();
    s.coat_edge = random.unit();
    s.roughness = 0.05f * random.unit();
    if (random.below(3) == 0) s.transmission = random.unit();
    s.front = random.below(2) == 0;
    s.thin = random.below(3) == 0;
  }
  return fragments;
}

TEST(Bounces, OfManyFragmentsEqualThoseOfOneAfterTheOther) {
  const Box box{{-3, -3, -3}, {3, 3, 3}};
  for (const std::size_t size : {1u, 15u, 16u, 257u, 3000u}) {
    const Fragments fragments = some_bouncing(size);
    for (const RayKind kind : {RayKind::kReflection, RayKind::kRefraction}) {
      const bool mirrors = kind == RayKind::kReflection;
      test::for_each_simd_target([&](const char* target) {
        const RayBatch batch = make_bounce_rays(Executor(3), fragments, kind, box, Keys::kMade, {});
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < size; ++i) {
          const Fragment& f = fragments[i];
          if (f.triangle == kInvalidId) continue;
          const Scattering s = scatter(f);
          if ((rays_of(f, s) & (mirrors ? kReflects : kRefracts)) == 0) continue;
          ASSERT_LT(next, batch.rays.size()) << target;
          ASSERT_EQ(batch.slots[next], i) << target;
          const Vec3 direction = mirrors ? s.reflection : s.refraction;
          const Ray ray{offset_point(f.surface, direction, 0), 0, direction};
          const Vec3 weight = f.weight * (mirrors ? s.reflected_part : s.refracted_part);
          ASSERT_EQ(std::memcmp(&batch.rays[next], &ray, sizeof ray), 0) << target << " " << i;
          ASSERT_EQ(std::memcmp(&batch.weights[next], &weight, sizeof weight), 0) << target;
          ASSERT_EQ(batch.pixels[next], f.pixel);
          ASSERT_EQ(batch.keys[next++], bounce_key(box, ray.origin, direction));
        }
        EXPECT_EQ(batch.rays.size(), next);
      });
    }
  }
}

}  // namespace
}  // namespace raysheaf
