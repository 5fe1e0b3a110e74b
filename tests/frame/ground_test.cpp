// The ground that catches a shadow: it lies where rays say, and nothing else of the image changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/animation.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/render.h"
#include "raysheaf/stream.h"
#include "render/rays/camera_rays.h"
#include "support/guarded_memory.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

Light sun(Vec3 direction) {
  Light light;
  light.type = Light::Type::kDirectional;
  light.direction = normalized(direction);
  light.intensity = {3, 3, 3};
  return light;
}

SceneDescription sphere_alone() {
  SceneDescription scene;
  test::add_mesh(&scene, test::ball(12, 1, {0.3f, 1.5f, 0.2f}));
  scene.lights.push_back(sun({-1, -2, -1}));
  scene.cameras.push_back(test::camera_at({0, 3, 7}, {0, 1, 0}));
  return scene;
}

RenderOptions with_ground(RenderOptions options = test::small_options()) {
  options.ground = Ground{};
  return options;
}

float most_of(const std::vector<float>& values) {
  return *std::max_element(values.begin(), values.end());
}

TEST(Ground, LeavesTheRestOfTheImageItsBits) {
  for (const std::uint32_t samples : {1u, 5u}) {
    SceneDescription scene = sphere_alone();
    scene.lights.push_back(test::point_light({2, 4, 1}, 20));
    RenderOptions options = test::small_options();
    options.samples = samples;
    const RenderResult plain = render(scene, options);
    EXPECT_TRUE(plain.ground.empty());
    const RenderResult caught = render(scene, with_ground(options));
    EXPECT_TRUE(test::same_bits(caught.normal, plain.normal));
    EXPECT_TRUE(test::same_bits(caught.position, plain.position));
    EXPECT_TRUE(test::same_bits(caught.albedo, plain.albedo));
    EXPECT_EQ(caught.shadow, plain.shadow);
    EXPECT_EQ(caught.exposure, plain.exposure);
    std::size_t darker = 0;
    for (std::size_t i = 0; i < plain.beauty.size(); ++i) {
      const float taken = caught.ground[i];
      ASSERT_GE(taken, 0);
      ASSERT_LT(taken, 1);
      if (taken == 0) {
        ASSERT_EQ(caught.beauty[i].x, plain.beauty[i].x);
      } else {
        ASSERT_NEAR(caught.beauty[i].x, plain.beauty[i].x - plain.ambient.x * taken, 1e-6f);
        ++darker;
      }
      // Pixels that the scene covers wholly catch nothing.
      if (length(plain.normal[i]) > 0.999f) {
        ASSERT_EQ(taken, 0);
      }
    }
    EXPECT_GT(darker, 50u);
  }
}

TEST(Ground, ShadowsLieWhereRaysToTheLightAreStopped) {
  const std::array<std::pair<UpAxis, Vec3>, 3> ups{
      {{UpAxis::kY, {0, 1, 0}}, {UpAxis::kMinusX, {-1, 0, 0}}, {UpAxis::kZ, {0, 0, 1}}}};
  for (const auto& [axis, up] : ups) {
    SceneDescription scene = sphere_alone();
    const Vec3 aside = std::fabs(up.x) > 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    const Vec3 center{0.3f, 1.5f, 0.2f};
    scene.lights[0] = sun(-2 * up - aside);
    scene.cameras[0].to_world = look_at(center + up * 4 + cross(up, aside) * 5, center, up);
    Scene rays;
    rays.add(scene.meshes[0].positions, scene.meshes[0].triangles);
    rays.commit();
    RenderOptions options = with_ground();
    options.ground->up = axis;
    options.ambient = Vec3{0.1f, 0.1f, 0.1f};
    const RenderResult image = render(scene, options);
    const CameraRays camera(make_camera_frame(scene.cameras[0], 48, 48));
    float lowest = std::numeric_limits<float>::infinity();
    for (const Vec3 p : scene.meshes[0].positions) lowest = std::min(lowest, dot(p, up));
    const Vec3 to_light = -scene.lights[0].direction;
    const float lit = 3 * dot(to_light, up) / std::numbers::pi_v<float>;
    std::size_t shaded = 0;
    for (std::uint32_t y = 0; y < 48; ++y) {
      for (std::uint32_t x = 0; x < 48; ++x) {
        const std::size_t i = std::size_t{y} * 48 + x;
        const Ray ray = camera.at(x, y);
        const float t = (lowest - dot(ray.origin, up)) / dot(ray.direction, up);
        const bool seen = image.ids[i].prim_id == kInvalidId && t > 0;
        const Vec3 at = ray.origin + ray.direction * t;
        const bool stopped =
            seen && any_hit(rays, std::vector<Ray>{{at, 1e-4f, to_light, 1e9f}})[0] != 0;
        ASSERT_NEAR(image.ground[i], stopped ? lit / (lit + 0.1f) : 0, 1e-5f) << x << " " << y;
        shaded += stopped ? 1 : 0;
      }
    }
    EXPECT_GT(shaded, 40u);
  }
}

TEST(Ground, IsTheSameForEveryMethodThreadAndDevice) {
  SceneDescription scene = sphere_alone();
  test::add_curtain(&scene, -1, 3);
  RenderOptions options = with_ground();
  options.samples = 3;
  const RenderResult expected = render(scene, options);
  EXPECT_GT(most_of(expected.ground), 0.3f);
  const auto expect_same = [&](const RenderResult& other) {
    EXPECT_TRUE(test::same_bits(other.beauty, expected.beauty));
    EXPECT_EQ(other.ground, expected.ground);
  };
  for (const Method method : {Method::kBrute, Method::kCrsh, Method::kGl10}) {
    options.method = method;
    expect_same(render(scene, options));
  }
  options.method = Method::kDual;
  for (const std::uint32_t threads : {1u, 3u}) {
    options.threads = threads;
    expect_same(render(scene, options));
  }
  const Executor executor(2);
  test::GuardedMemory memory;
  expect_same(render(
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory)),
      scene, options));
  // An image that ends early is that of as many samples.
  options.samples = 9;
  options.on_sample = [](const RenderResult& so_far) {
    EXPECT_TRUE(so_far.ground.empty());
    return so_far.samples < 3;
  };
  expect_same(render(scene, options));
}

TEST(Ground, OfBlocksThatStream) {
  const SceneDescription scene = sphere_alone();
  BlockList blocks;
  const SceneDescription rest = cut_into_blocks(scene, &blocks, 50);
  RenderOptions options = with_ground();
  options.samples = 2;
  const RenderResult expected = render(scene, options);
  const RenderResult streamed = render(BlocksInScene(blocks, rest), options);
  EXPECT_TRUE(test::same_bits(streamed.beauty, expected.beauty));
  EXPECT_EQ(streamed.ground, expected.ground);
}

TEST(Ground, DarkensAnEnvironment) {
  SceneDescription scene = sphere_alone();
  scene.lights.clear();
  scene.environment.width = 8;
  scene.environment.height = 4;
  scene.environment.radiance.assign(32, {0.5f, 0.25f, 0.125f});
  const RenderResult image = render(scene, with_ground());
  EXPECT_GT(most_of(image.ground), 0.2f);
  for (std::size_t i = 0; i < image.beauty.size(); ++i) {
    if (length(image.normal[i]) > 0) continue;
    ASSERT_NEAR(image.beauty[i].x, 0.5f * (1 - image.ground[i]), 1e-5f);
    ASSERT_NEAR(image.beauty[i].z, 0.125f * (1 - image.ground[i]), 1e-5f);
  }
}

TEST(Ground, ShowsNothingFromBelowNorWithoutShadows) {
  SceneDescription scene = sphere_alone();
  RenderOptions options = with_ground();
  options.shadows = false;
  EXPECT_EQ(most_of(render(scene, options).ground), 0);
  options.shadows = true;
  scene.cameras[0] = test::camera_at({0, -3, 7}, {0, 1, 0});
  EXPECT_EQ(most_of(render(scene, options).ground), 0);
  scene.cameras[0] = test::camera_at({0, -3, 7}, {-3, -5, -3});
  options.ground->height = -5.0f;  // now the camera is above it
  EXPECT_GT(most_of(render(scene, options).ground), 0);
}

TEST(Ground, RefusesWhatHasNoExtentAndNoHeight) {
  const auto sentence = [](const SceneDescription& scene, const RenderOptions& options) {
    try {
      static_cast<void>(render(scene, options));
    } catch (const Error& error) {
      return error.place() + ": " + error.sentence();
    }
    return std::string();
  };
  SceneDescription point = sphere_alone();
  for (Vec3& p : point.meshes[0].positions) p = {1, 2, 3};
  EXPECT_EQ(sentence(point, with_ground()),
            "ground: the scene has no extent, so it casts no shadow on a ground");
  RenderOptions options = with_ground();
  options.ground->height = std::nanf("");
  EXPECT_EQ(sentence(sphere_alone(), options), "ground: its height must be finite");
}

/// A sphere that falls by one unit a second.
class FallingSphere : public Animation {
 public:
  [[nodiscard]] SceneDescription& scene() override { return scene_; }
  [[nodiscard]] double start() const override { return 0; }
  [[nodiscard]] double end() const override { return 2; }
  [[nodiscard]] const std::vector<double>& frame_times() const override { return none_; }
  SceneChanges seek(double seconds) override {
    scene_.instances[0].to_world.m[1][3] = -static_cast<float>(std::clamp(seconds, 0.0, 2.0));
    SceneChanges changes;
    changes.moved = {0};
    return changes;
  }
  [[nodiscard]] const std::vector<std::string>& clips() const override { return names_; }
  void play(std::uint32_t /*clip*/) override {}

 private:
  SceneDescription scene_ = sphere_alone();
  std::vector<double> none_;
  std::vector<std::string> names_;
};

TEST(Ground, StaysBelowAllThatAnAnimationShows) {
  FallingSphere falling;
  const Ground ground = ground_under(falling, UpAxis::kY);
  ASSERT_TRUE(ground.height.has_value());
  EXPECT_NEAR(*ground.height, 0.5f - 2, 1e-5f);
  EXPECT_NEAR(ground_under(falling, UpAxis::kMinusY).height.value_or(0), -2.5f, 1e-5f);
}

}  // namespace
}  // namespace raysheaf
