// Surfaces that the cameras see and the lights reach, by brute force.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/vec.h"
#include "raysheaf/builtin_scenes.h"

namespace raysheaf {
namespace {

struct Triangle {
  std::array<Vec3, 3> corners;
  std::uint32_t material;
};

struct Seen {
  float t = std::numeric_limits<float>::infinity();
  const Triangle* triangle = nullptr;
};

class World {
 public:
  explicit World(std::string_view name) : scene(builtin_scene(name)) {
    for (const Instance& instance : scene.instances) {
      const Mesh& mesh = scene.meshes[instance.mesh];
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Triangle triangle{{}, mesh.materials[mesh.materials.size() == 1 ? 0 : i]};
        for (std::size_t k = 0; k < 3; ++k) {
          triangle.corners[k] =
              transform_point(instance.to_world, mesh.positions[mesh.triangles[i][k]]);
        }
        triangles_.push_back(triangle);
      }
    }
  }

  [[nodiscard]] Seen closest(Vec3 origin, Vec3 direction, float t_max) const {
    Seen seen;
    seen.t = t_max;
    for (const Triangle& triangle : triangles_) {
      const Vec3 u = triangle.corners[1] - triangle.corners[0],
                 v = triangle.corners[2] - triangle.corners[0];
      const Vec3 p = cross(direction, v), s = origin - triangle.corners[0], q = cross(s, u);
      const float det = dot(u, p), a = dot(s, p) / det, b = dot(direction, q) / det,
                  t = dot(v, q) / det;
      if (a >= 0 && b >= 0 && a + b <= 1 && t > 0 && t < seen.t) seen = {t, &triangle};
    }
    return seen;
  }

  /// Whether the ray sees the front, or either side of a double-sided material.
  [[nodiscard]] bool shows_front(const Triangle& triangle, Vec3 direction) const {
    const auto& c = triangle.corners;
    return scene.materials[triangle.material].double_sided ||
           dot(cross(c[1] - c[0], c[2] - c[0]), direction) < 0;
  }

  /// Directions through the centres of `size` by `size` pixels.
  [[nodiscard]] std::vector<Vec3> camera_rays(int size) const {
    const Camera& camera = scene.cameras[0];
    const float extent = std::tan(camera.y_fov / 2);
    std::vector<Vec3> rays;
    for (int i = 0; i < size * size; ++i) {
      const float x = (2 * static_cast<float>(i % size) + 1) / static_cast<float>(size) - 1;
      const float y = (2 * static_cast<float>(i / size) + 1) / static_cast<float>(size) - 1;
      rays.push_back(normalized(transform_vector(camera.to_world, {x * extent, y * extent, -1})));
    }
    return rays;
  }

  [[nodiscard]] Vec3 eye() const { return column(scene.cameras[0].to_world, 3); }

  SceneDescription scene;

 private:
  std::vector<Triangle> triangles_;
};

constexpr float kFar = std::numeric_limits<float>::infinity();

class BuiltinView : public testing::TestWithParam<std::string> {
 protected:
  World world_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(All, BuiltinView, testing::ValuesIn(builtin_scene_names()),
                         [](const auto& test) { return test.param; });

TEST_P(BuiltinView, CameraStandsInTheOpen) {
  int hits = 0;
  for (const Vec3 ray : world_.camera_rays(12)) {
    const Seen seen = world_.closest(world_.eye(), ray, kFar);
    if (seen.triangle == nullptr) continue;
    ++hits;
    EXPECT_TRUE(world_.shows_front(*seen.triangle, ray));
    EXPECT_GT(seen.t, 0.5f);
  }
  EXPECT_GT(hits, 12 * 12 * 3 / 4);
}

TEST_P(BuiltinView, MainLightStandsInTheOpen) {
  const Vec3 light = world_.scene.lights[0].position;
  for (int i = 0; i < 64; ++i) {
    const float y = (static_cast<float>(i) + 0.5f) / 32 - 1,
                turn = 2.39996f * static_cast<float>(i);
    const float r = std::sqrt(1 - y * y);
    const Vec3 ray{r * std::cos(turn), y, r * std::sin(turn)};
    const Seen seen = world_.closest(light, ray, kFar);
    EXPECT_TRUE(seen.triangle == nullptr || world_.shows_front(*seen.triangle, ray)) << y;
  }
}

TEST_P(BuiltinView, MainLightReachesHalfOfThePictureAndLeavesShadows) {
  const Vec3 light = world_.scene.lights[0].position;
  int lit = 0, seen_count = 0;
  for (const Vec3 ray : world_.camera_rays(16)) {
    const Seen seen = world_.closest(world_.eye(), ray, kFar);
    if (seen.triangle == nullptr) continue;
    ++seen_count;
    const Vec3 way = world_.eye() + ray * seen.t - light;
    lit += world_.closest(light, way, 0.999f).triangle == nullptr;
  }
  EXPECT_GT(lit, seen_count / 2);
  EXPECT_LT(lit, seen_count * 97 / 100);
}

TEST(OfficeView, ShowsMirrorAndGlass) {
  const World world("office");
  int mirror = 0, glass = 0;
  for (const Vec3 ray : world.camera_rays(16)) {
    const Seen seen = world.closest(world.eye(), ray, kFar);
    ASSERT_NE(seen.triangle, nullptr) << "the room is closed";
    const Material& material = world.scene.materials[seen.triangle->material];
    mirror += material.metallic == 1 && material.roughness == 0;
    glass += material.transmission == 1;
  }
  EXPECT_GT(mirror, 16 * 16 / 50);
  EXPECT_GT(glass, 16 * 16 / 100);
}

TEST(OfficeView, SunComesInThroughTheWindow) {
  const World world("office");
  const Light& sun = world.scene.lights.at(1);
  ASSERT_EQ(sun.type, Light::Type::kDirectional);
  int lit = 0;
  for (const Vec3 ray : world.camera_rays(16)) {
    const Vec3 at = world.eye() + ray * (world.closest(world.eye(), ray, kFar).t * 0.9999f);
    lit += world.closest(at, -sun.direction, kFar).triangle == nullptr;
  }
  EXPECT_GT(lit, 16 * 16 / 100);
  EXPECT_LT(lit, 16 * 16 / 4);
}

}  // namespace
}  // namespace raysheaf
