// Lights with a size, lenses and environments in complete images: the values to which they
// converge, and equal bits for all methods and numbers of threads.
#include <gtest/gtest.h>

#include <cmath>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "support/lambert.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

constexpr double kPi = 3.14159265358979;

Material lambertian(float reflectance) {
  Material m;
  m.base_color = {reflectance, reflectance, reflectance, 1};
  m.specular = 0;
  m.double_sided = true;
  return m;
}

Environment uniform_sky(float radiance) {
  Environment sky;
  sky.width = 8;
  sky.height = 4;
  sky.radiance.assign(32, {radiance, radiance, radiance});
  return sky;
}

Light lamp(Vec3 center, float width, float height) {
  Light light;
  light.type = Light::Type::kRectangle;
  light.position = center;
  light.direction = {0, -1, 0};
  light.width = width;
  light.height = height;
  light.intensity = {10, 10, 10};
  return light;
}

/// A matte floor at y = 0, seen by an orthographic camera just above it: each pixel is a point.
SceneDescription floor_from_above(float eye_height, float x = 0, float half_height = 2) {
  SceneDescription scene;
  scene.materials = {lambertian(0.5f)};
  Mesh floor = test::floor_square(30, 0);
  floor.materials = {0};
  test::add_mesh(&scene, std::move(floor));
  Camera camera;
  camera.to_world = look_at({x, eye_height, 0}, {x, 0, 0}, {0, 0, -1});
  camera.orthographic = true;
  camera.y_mag = half_height;
  camera.z_near = 1e-3f;
  scene.cameras = {camera};
  return scene;
}

RenderOptions soft_options(std::uint32_t samples, std::uint32_t size) {
  RenderOptions options = test::small_options(size);
  options.samples = samples;
  options.ambient = Vec3{0, 0, 0};
  options.bounces = 0;
  return options;
}

double mean_of(const std::vector<Vec3>& pixels) {
  double sum = 0;
  for (const Vec3& pixel : pixels) sum += static_cast<double>(pixel.x);
  return sum / static_cast<double>(pixels.size());
}

TEST(SoftLight, AFloorUnderALampIsLambertsFormula) {
  for (const float at : {-2.0f, 0.5f, 1.1f}) {
    SceneDescription scene = floor_from_above(1, at, 0.1f);
    scene.lights = {lamp({0.5f, 2, 0}, 1.5f, 1)};
    const RenderResult result = render(scene, soft_options(64, 4));
    for (std::size_t i = 0; i < 16; ++i) {
      const double expected =
          0.5 / kPi * test::lambert(scene.lights[0], result.position[i], {0, 1, 0});
      EXPECT_NEAR(result.beauty[i].x, expected, 0.02 * expected) << at;
    }
  }
}

TEST(SoftLight, PenumbrasConvergeToThePartOfTheLampThatIsSeen) {
  // A shutter at half height covers x < 0: a point at x sees the part of the lamp beyond -x.
  SceneDescription scene = floor_from_above(0.5f);
  scene.lights = {lamp({0, 2, 0}, 2, 2)};
  Mesh shutter;
  shutter.positions = {{-60, 1, -60}, {0, 1, -60}, {0, 1, 60}, {-60, 1, 60}};
  shutter.triangles = {{0, 1, 2}, {0, 2, 3}};
  shutter.materials = {0};
  test::add_mesh(&scene, std::move(shutter));
  const RenderResult result = render(scene, soft_options(256, 16));
  for (std::uint32_t x = 0; x < 16; ++x) {
    const Vec3 p = result.position[8 * 16 + x];
    const double from = std::fmax(-1.0, -static_cast<double>(p.x)), width = 1 - from;
    double expected = 0;
    if (width > 0) {
      Light seen = lamp({static_cast<float>((1 + from) / 2), 2, 0}, static_cast<float>(width), 2);
      seen.intensity = seen.intensity * static_cast<float>(width / 2);  // the same radiance
      expected = 0.5 / kPi * test::lambert(seen, p, {0, 1, 0});
    }
    EXPECT_NEAR(result.beauty[8 * 16 + x].x, expected, 0.012) << p.x;
  }
}

TEST(SoftLight, ABallOverAFloorIsAPointWhereItCastsNoShadow) {
  SceneDescription scene = floor_from_above(1);
  scene.lights = {test::point_light({0.5f, 3, 0.2f}, 20)};
  const RenderResult point = render(scene, soft_options(1, 8));
  scene.lights[0].radius = 0.8f;
  const RenderResult ball = render(scene, soft_options(64, 8));
  EXPECT_NEAR(mean_of(ball.beauty), mean_of(point.beauty), 0.01 * mean_of(point.beauty));
}

TEST(SoftLight, OneSampleIsThePictureOfPointsAndAPinhole) {
  SceneDescription scene = builtin_scene("office");
  RenderOptions options = test::small_options();
  const RenderResult plain = render(scene, options);
  for (Light& light : scene.lights) {
    if (light.type == Light::Type::kPoint) light.radius = 0.2f;
  }
  options.samples = 1;
  options.aperture = 0.1f;
  EXPECT_TRUE(test::same_bits(render(scene, options).beauty, plain.beauty));
  options.samples = 2;
  EXPECT_FALSE(test::same_bits(render(scene, options).beauty, plain.beauty));
}

/// Everything at once: a sphere, a lamp, a spot light with a size, a sky, a lens, glass and a
/// mirror.
SceneDescription everything(Material material) {
  SceneDescription scene = test::ball_on_floor(std::move(material));
  scene.lights[0].radius = 0.4f;
  scene.lights.push_back(lamp({-2, 3, 1}, 1, 2));
  Light spot = test::point_light({3, 4, -1}, 50);
  spot.type = Light::Type::kSpot;
  spot.direction = normalized({-3, -4, 1});
  spot.radius = 0.2f;
  scene.lights.push_back(spot);
  scene.environment = uniform_sky(0.2f);
  scene.environment.radiance[10] = {9, 8, 7};
  scene.environment.rotation = 0.5f;
  scene.cameras[0].aperture = 0.2f;
  return scene;
}

TEST(SoftLight, GivesTheSameBitsByEveryMethodAndOnEveryNumberOfThreads) {
  Material glass;
  glass.transmission = 0.8f;
  glass.roughness = 0;
  Material metal;
  metal.metallic = 1;
  metal.roughness = 0.3f;
  for (const Material& material : {glass, metal}) {
    const SceneDescription scene = everything(material);
    RenderOptions options = test::small_options(20);
    options.samples = 3;
    options.method = Method::kBrute;
    options.threads = 1;
    const RenderResult brute = render(scene, options);
    for (const Method method : {Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual}) {
      options.method = method;
      for (const std::uint32_t threads : {1u, 3u}) {
        options.threads = threads;
        EXPECT_TRUE(test::same_bits(render(scene, options).beauty, brute.beauty))
            << to_string(method) << " " << threads;
      }
    }
  }
}

TEST(Lens, WhatIsInFocusStaysSharpAndTheRestIsADisc) {
  // An edge at depth 5 across the middle of the image; 16 pixels are 2 wide at that depth.
  SceneDescription scene;
  Material white;
  white.unlit = true;
  white.emission = {1, 1, 1};
  scene.materials = {white};
  Mesh half;
  half.positions = {{0, -90, 0}, {90, -90, 0}, {90, 90, 0}, {0, 90, 0}};
  half.triangles = {{0, 1, 2}, {0, 2, 3}};
  half.materials = {0};
  test::add_mesh(&scene, std::move(half));
  scene.cameras = {test::camera_at({0, 0, 5}, {0, 0, 0})};
  scene.cameras[0].y_fov = 2 * std::atan(0.2f);
  RenderOptions options = soft_options(512, 16);
  options.aperture = 0.8f;
  options.focus = 5.0f;
  const RenderResult sharp = render(scene, options);
  options.focus = 2.5f;
  const RenderResult blurred = render(scene, options);
  EXPECT_EQ(blurred.statistics.primary, "trace");
  for (std::uint32_t x = 0; x < 16; ++x) {
    const double at = (static_cast<double>(x) - 7.5) / 8;  // in the edge's plane
    const double pixel = std::sqrt(2.0) * 0.5 / 8;
    EXPECT_NEAR(sharp.beauty[8 * 16 + x].x, 0.5 * std::erfc(-at / pixel), 0.02) << x;
    // The radius of the disc at that depth is the lens's times |5 - 2.5| / 2.5.
    const double r = std::clamp(at / 0.4, -1.0, 1.0);
    const double disc = 0.5 + (r * std::sqrt(1 - r * r) + std::asin(r)) / kPi;
    EXPECT_NEAR(blurred.beauty[8 * 16 + x].x, disc, 0.03) << x;
  }
}

TEST(Lens, FocusesByItselfOnWhatTheMiddleShows) {
  SceneDescription scene = test::ball_on_floor();
  RenderOptions options = test::small_options(24);
  options.samples = 4;
  options.aperture = 0.3f;
  const RenderResult by_itself = render(scene, options);
  // An odd size, so that one pixel is in the middle.
  RenderOptions pinhole = test::small_options(25);
  const RenderResult seen = render(scene, pinhole);
  const Vec3 eye = column(scene.cameras[0].to_world, 3);
  const Vec3 forward = -normalized(column(scene.cameras[0].to_world, 2));
  options.focus = dot(seen.position[12 * 25 + 12] - eye, forward);
  const RenderResult told = render(scene, options);
  double difference = 0;
  for (std::size_t i = 0; i < told.beauty.size(); ++i)
    difference += std::fabs(static_cast<double>(told.beauty[i].x - by_itself.beauty[i].x));
  EXPECT_LT(difference, 1e-3 * mean_of(told.beauty) * static_cast<double>(told.beauty.size()));
}

TEST(Lens, NeedsRaysAndReportsIt) {
  RenderOptions options = test::small_options(8);
  options.primary = Primary::kRaster;
  options.aperture = 0.1f;
  // Must not need OpenGL either.
  const RenderResult result = render(test::ball_on_floor(), options);
  EXPECT_EQ(result.statistics.primary, "trace: a lens needs rays");
  EXPECT_EQ(result.samples, 16u);
}

TEST(Sky, AWhiteFurnaceStaysWhite) {
  struct Case {
    Material material;
    double least;  ///< the energy that is lost where glossy lobes point into the surface
  };
  Material white = lambertian(1), plastic, mirror, glass, rough_metal;
  plastic.roughness = 0.5f;
  mirror.metallic = 1;
  mirror.roughness = 0;
  glass.transmission = 1;
  glass.roughness = 0;
  rough_metal.metallic = 1;
  rough_metal.roughness = 0.4f;
  for (const Case& c : {Case{white, 0.999}, Case{plastic, 0.97}, Case{mirror, 0.999},
                        Case{glass, 0.999}, Case{rough_metal, 0.9}}) {
    SceneDescription scene;
    scene.materials = {c.material};
    Mesh sphere = test::ball(32, 1);
    sphere.materials = {0};
    test::add_mesh(&scene, std::move(sphere));
    scene.cameras = {test::camera_at({0, 0, 4}, {0, 0, 0})};
    scene.environment = uniform_sky(1);
    RenderOptions options = test::small_options(16);
    options.samples = 64;
    options.bounces = 4;
    const RenderResult result = render(scene, options);
    EXPECT_GT(mean_of(result.beauty), c.least - 0.003);
    EXPECT_LT(mean_of(result.beauty), 1.003);
    if (c.least < 0.99) continue;
    for (const Vec3& pixel : result.beauty) EXPECT_NEAR(pixel.x, 1, 0.1);
  }
}

TEST(Sky, IsWhatRaysSeeThatMiss) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights.clear();
  Environment sky = uniform_sky(0);
  for (std::uint32_t y = 0; y < 4; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x)
      sky.radiance[y * 8 + x] = {static_cast<float>(x), static_cast<float>(y), 1};
  }
  scene.environment = sky;
  scene.cameras = {test::camera_at({0, 50, 0}, {0, 50, -1})};
  scene.cameras[0].z_near = 1;
  RenderOptions options = test::small_options(9);
  options.samples = 1;
  const RenderResult ahead = render(scene, options);
  EXPECT_NEAR(ahead.beauty[4 * 9 + 4].x, 3.5f, 1e-3f);
  EXPECT_NEAR(ahead.beauty[4 * 9 + 4].y, 1.5f, 1e-3f);
  EXPECT_GT(ahead.beauty[4 * 9 + 8].x, ahead.beauty[4 * 9].x);  // columns go to the right
  EXPECT_GT(ahead.beauty[8 * 9 + 4].y, ahead.beauty[4].y);      // rows go down
}

TEST(Sky, OccludersCastShadows) {
  // Under a roof that hides the upper half of the sky except for a strip, the floor is dark.
  SceneDescription scene = floor_from_above(0.5f);
  scene.environment = uniform_sky(1);
  const double open = mean_of(render(scene, soft_options(32, 8)).beauty);
  EXPECT_NEAR(open, 0.5, 0.01);
  Mesh roof = test::floor_square(30, 1);
  roof.materials = {0};
  test::add_mesh(&scene, std::move(roof));
  EXPECT_LT(mean_of(render(scene, soft_options(32, 8)).beauty), 0.02);
}

TEST(SoftLight, RefusesWhatCannotBeLitBy) {
  const auto sentence_of = [](const SceneDescription& scene) -> std::string {
    try {
      (void)render(scene, test::small_options(8));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
      return error.what();
    }
    return "";
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  SceneDescription scene = test::ball_on_floor();
  scene.lights[0].radius = -1;
  EXPECT_TRUE(has(sentence_of(scene), "lights[0].radius"));
  scene = test::ball_on_floor();
  scene.lights.push_back(lamp({0, 5, 0}, 0, 1));
  EXPECT_TRUE(has(sentence_of(scene), "lights[1].width"));
  scene.lights[1] = lamp({0, 5, 0}, 1, 1);
  scene.lights[1].right = {0, 1, 0};
  EXPECT_TRUE(has(sentence_of(scene), "lights[1].right"));
  scene = test::ball_on_floor();
  scene.cameras[0].aperture = std::nanf("");
  EXPECT_TRUE(has(sentence_of(scene), "cameras[0].aperture"));
  scene = test::ball_on_floor();
  scene.environment = uniform_sky(1);
  scene.environment.radiance[9].y = std::nanf("");
  EXPECT_TRUE(has(sentence_of(scene), "pixel (1, 1) of 8x4 is not finite"));
  scene.environment = uniform_sky(1);
  scene.environment.radiance.pop_back();
  EXPECT_TRUE(has(sentence_of(scene), "32 pixels") || has(sentence_of(scene), "31 values"));
  scene.environment = uniform_sky(-1);
  EXPECT_TRUE(has(sentence_of(scene), "is negative"));
}

}  // namespace
}  // namespace raysheaf
