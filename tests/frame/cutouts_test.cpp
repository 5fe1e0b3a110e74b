// Surfaces that alpha cuts out are invisible to primary rays, shadows, mirrors and lenses, with
// every method.
#include "render/frame/cutouts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "geom/surface_body.h"
#include "intersect/triangle_body.h"
#include "raysheaf/render.h"
#include "render/geometry/resident_geometry.h"
#include "support/pictures.h"
#include "support/random.h"

namespace raysheaf {
namespace {

/// A sphere on a mirror behind three curtains, one of which coincides with another.
SceneDescription curtains() {
  SceneDescription scene = test::ball_on_floor();
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  scene.materials.push_back(mirror);
  scene.meshes[1].materials = {1};
  test::add_curtain(&scene, 1.5f, 1);
  test::add_curtain(&scene, 2, 2);
  test::add_curtain(&scene, 2.5f, 3);
  test::add_curtain(&scene, 2, 4);
  scene.materials[3].alpha_blend = true;
  return scene;
}

/// Tests every triangle from near to far and returns the first one that is not cut out.
struct Truth {
  const FlatScene& flat;
  const TextureSet& textures;

  [[nodiscard]] bool is_there(const Ray& ray, std::uint32_t triangle) const {
    const FlatMesh& placed = flat.meshes[flat.mesh_of_triangle[triangle]];
    const Mesh& mesh = flat.description->meshes[placed.geom_id];
    if (mesh.materials.empty() || mesh.uvs.empty()) return true;
    const Material& material = flat.description->materials[mesh.materials[0]];
    const auto& corners = mesh.triangles[triangle - placed.first_triangle];
    const auto [a, b, c] = flat.corners(triangle);
    const Vec2 at = clamped_barycentrics(ray, a, b, c);
    const Vec2 uv[3] = {mesh.uvs[corners[0]], mesh.uvs[corners[1]], mesh.uvs[corners[2]]};
    return textures.numbers(material.base_color_texture, mixed(uv, at.x, at.y)).w >=
           material.alpha_cutoff;
  }
  [[nodiscard]] RayHit hit(const Ray& ray) const {
    std::vector<RayHit> all;
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i) {
      TriangleHit met;
      const auto [a, b, c] = flat.corners(i);
      if (intersect_triangle(make_ray_setup(ray), a, b, c, &met)) all.push_back({met.t, i});
    }
    std::sort(all.begin(), all.end(), [](const RayHit& a, const RayHit& b) {
      return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0 && all[i].t == all[i - 1].t) continue;
      if (is_there(ray, all[i].triangle)) return all[i];
    }
    return {};
  }
};

class Cut : public testing::TestWithParam<Method> {
 protected:
  RayBatch batch(RayKind kind, std::uint32_t count) const {
    RayBatch made;
    made.kind = kind;
    made.key_bits = 30;
    test::Random random(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 from = random.in_box(3) + Vec3{0, 1, 3}, to = random.in_box(1) + Vec3{0, 1, 0};
      made.rays.push_back({from, 0, to - from, i % 3 == 0 ? 0.7f : 1e9f});
      made.keys.push_back(random.below(1u << 30));
      made.slots.push_back(i);
      made.pixels.push_back(i);
      made.lights.push_back(0);
      made.places.push_back({0, 0});
    }
    return made;
  }

  const Executor executor_{2};
  const SceneDescription scene_ = curtains();
  const FlatScene flat_ = flatten(executor_, scene_, mesh_bounds(executor_, scene_));
  const TextureSet textures_{scene_};
  const Truth truth_{flat_, textures_};
  ProgressMeter meter_;
};

TEST_P(Cut, RaysHitTheFirstSurfaceThatIsNotCutOut) {
  RenderOptions options;
  options.method = GetParam();
  ResidentGeometry geometry(executor_, flat_, textures_, options);
  const RayBatch rays = batch(RayKind::kReflection, 3000);
  BatchStatistics statistics;
  std::vector<float> tests(rays.rays.size());
  const std::vector<RayHit> hits = geometry.trace(rays, &statistics, tests, &meter_);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const RayHit truth = truth_.hit(rays.rays[i]);
    ASSERT_EQ(hits[i].triangle, truth.triangle) << "ray " << i;
    ASSERT_EQ(float_bits(hits[i].t), float_bits(truth.t)) << "ray " << i;
  }
  EXPECT_GT(statistics.rays, rays.rays.size() + 500) << "those that went on count again";
  // Hierarchies over rays count their last nodes as if these were full.
  const auto all = static_cast<double>(statistics.total_tests());
  EXPECT_NEAR(std::accumulate(tests.begin(), tests.end(), 0.0), all, 0.01 * all);
}

TEST_P(Cut, OnlySurfacesThatAreNotCutOutCastShadows) {
  RenderOptions options;
  options.method = GetParam();
  ResidentGeometry geometry(executor_, flat_, textures_, options);
  RayBatch rays = batch(RayKind::kShadow, 3000);
  rays.light_ends = {3000};
  for (const bool early_out : {false, true}) {
    BatchStatistics statistics;
    std::vector<std::uint8_t> occluded(rays.rays.size());
    geometry.find_occluded(rays, early_out, &statistics, {}, &meter_, occluded);
    std::uint32_t lit = 0;
    for (std::size_t i = 0; i < occluded.size(); ++i) {
      ASSERT_EQ(occluded[i] != 0, truth_.hit(rays.rays[i]).found()) << "ray " << i;
      lit += occluded[i] == 0 ? 1 : 0;
    }
    EXPECT_GT(lit, 100u);
    EXPECT_LT(lit, 2700u);
  }
}

TEST_P(Cut, PicturesAreThoseOfBruteForce) {
  RenderOptions options = test::small_options(40);
  options.method = Method::kBrute;
  options.bounces = 2;
  options.count_pixel_tests = true;
  for (const std::uint32_t samples : {1u, 2u}) {
    SceneDescription scene = scene_;
    if (samples == 2) scene.cameras[0].aperture = 0.2f;
    options.samples = samples;
    options.primary = Primary::kTrace;
    options.method = Method::kBrute;
    const RenderResult brute = render(scene, options);
    options.method = GetParam();
    for (const Primary primary : {Primary::kTrace, Primary::kRaster}) {
      options.primary = primary;
      const RenderResult result = render(scene, options);
      EXPECT_TRUE(test::same_bits(result.beauty, brute.beauty));
      EXPECT_TRUE(test::same_bits(result.position, brute.position));
      EXPECT_EQ(result.shadow, brute.shadow);
      const double pixels = std::accumulate(result.tests.begin(), result.tests.end(), 0.0);
      double batches = 0;
      for (const BatchStatistics& b : result.statistics.batches)
        batches += static_cast<double>(b.total_tests());
      const bool pads = GetParam() == Method::kRah || GetParam() == Method::kCrsh;
      EXPECT_LE(pixels, batches * (1 + 1e-6));
      EXPECT_GE(pixels, batches * (pads ? 0.9 : 1 - 1e-6)) << "last nodes, as above";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cutouts, Cut,
                         testing::Values(Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10,
                                         Method::kDual),
                         [](const auto& method) { return to_string(method.param); });

/// The bright fraction of the image of a camera in the dark that looks at bright walls with this
/// alpha, one behind the other.
float brightness(float alpha, int walls, std::uint32_t samples, bool shadows) {
  SceneDescription scene;
  Material bright;
  bright.unlit = !shadows;
  bright.double_sided = true;
  bright.base_color = {1, 1, 1, alpha};
  bright.alpha_blend = true;
  scene.materials = {bright, {}};
  for (int i = 0; i < walls; ++i) {
    Mesh wall = test::floor_square(8, -1 - static_cast<float>(i));
    wall.materials = {0};
    test::add_mesh(&scene, std::move(wall));
  }
  Mesh ground = test::floor_square(8, -9);
  ground.materials = {1};
  if (shadows) test::add_mesh(&scene, std::move(ground));
  Light sun = test::point_light({0, 0, 0}, 3.14159265f);
  sun.type = Light::Type::kDirectional;
  sun.direction = {0, -1, 0};
  scene.lights.push_back(sun);
  Camera camera;
  // The camera is above the walls; for shadows, below them.
  camera.to_world = look_at({0, shadows ? -8.0f : 0.0f, 0}, {0, -20, 0}, {0, 0, 1});
  scene.cameras.push_back(camera);
  RenderOptions options = test::small_options(24);
  options.samples = samples;
  options.ambient = Vec3{0, 0, 0};
  double sum = 0;
  const RenderResult result = render(scene, options);
  for (const Vec3 c : result.beauty) sum += double{c.x};
  return static_cast<float>(sum / static_cast<double>(result.beauty.size()));
}

TEST(Blended, SamplesBlendByRandomAlpha) {
  for (const float alpha : {0.0f, 0.3f, 0.8f, 1.0f}) {
    // 24 x 24 pixels with 16 samples: a standard deviation of at most 0.0052.
    EXPECT_NEAR(brightness(alpha, 1, 16, false), alpha, 0.02f);
    EXPECT_NEAR(brightness(alpha, 2, 16, false), 1 - (1 - alpha) * (1 - alpha), 0.02f);
  }
  EXPECT_EQ(brightness(0.3f, 1, 1, false), 1) << "whole with one sample and no texture";
  for (const std::uint32_t samples : {1u, 16u}) {
    EXPECT_EQ(brightness(0, 1, samples, false), 0) << samples << ": invisible, not by chance";
    EXPECT_EQ(brightness(1, 1, samples, false), 1) << samples << ": opaque, not by chance";
  }
}

TEST(Blended, LightPassesByRandomAlpha) {
  const float whole = brightness(0, 1, 16, true);
  EXPECT_GT(whole, 0.1f);
  for (const float alpha : {0.3f, 0.8f})
    EXPECT_NEAR(brightness(alpha, 1, 16, true), (1 - alpha) * whole, 0.02f * whole + 0.01f);
}

TEST(Cutouts, WithoutATextureSurfacesAreWholeOrInvisible) {
  SceneDescription scene = test::ball_on_floor();
  const RenderOptions options = test::small_options(24);
  const RenderResult whole = render(scene, options);
  scene.materials[0].base_color.w = 0.5f;
  scene.materials[0].alpha_cutoff = 0.5f;
  EXPECT_TRUE(test::same_bits(render(scene, options).beauty, whole.beauty));
  scene.materials[0].alpha_cutoff = 0.6f;
  SceneDescription without = scene;
  without.meshes[0].triangles.clear();
  EXPECT_EQ(render(scene, options).shadow, render(without, options).shadow);
  scene.materials[0].base_color.w = 1;
  scene.materials[0].alpha_cutoff = 2;
  EXPECT_EQ(render(scene, options).shadow, render(without, options).shadow);
}

}  // namespace
}  // namespace raysheaf
