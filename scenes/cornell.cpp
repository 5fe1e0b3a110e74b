// A scene like the test scene of Reis, Costa and Pereira 2017: six mirrors around a sphere.
#include <array>

#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kSize = 120, kThickness = 0.5f;

struct Wall {
  std::string_view name;
  Vec3 outward;
  Vec4 reflectance;
};

constexpr std::array<Wall, 6> kWalls = {{
    {"floor", {0, -1, 0}, {0.70f, 0.68f, 0.64f, 1}},
    {"ceiling", {0, 1, 0}, {0.76f, 0.76f, 0.78f, 1}},
    {"left", {-1, 0, 0}, {0.80f, 0.55f, 0.50f, 1}},
    {"right", {1, 0, 0}, {0.52f, 0.78f, 0.56f, 1}},
    {"back", {0, 0, -1}, {0.78f, 0.75f, 0.66f, 1}},
    {"front", {0, 0, 1}, {0.55f, 0.64f, 0.80f, 1}},
}};

void add_wall(Stage& stage, const Wall& wall) {
  Material mirror;
  mirror.name = wall.name;
  mirror.base_color = wall.reflectance;
  mirror.metallic = 1;
  mirror.roughness = 0;
  MeshBuilder cube(wall.name);
  cube.use(stage.add(mirror));
  add_box(cube, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
  const Vec3 broad = Vec3{1, 1, 1} - abs(wall.outward);
  const Vec3 size = broad * (kSize + 2 * kThickness) + abs(wall.outward) * kThickness;
  const Vec3 center = wall.outward * ((kSize + kThickness) / 2);
  stage.place(stage.add(cube.take()), compose(translation(center), scaling(size)), wall.name);
}

void add_ball(Stage& stage) {
  constexpr float kRadius = 25;
  MeshBuilder ball("sphere");
  ball.use(stage.add(matte("sphere", 0xd9622b, 0.35f)));
  add_sphere(ball, {0, 0, 0}, 1, 24, 16);
  const Vec3 center{0, kRadius - kSize / 2, 0};
  stage.place(stage.add(ball.take()),
              compose(translation(center), scaling({kRadius, kRadius, kRadius})), "sphere");
}

}  // namespace

SceneDescription cornell() {
  Stage stage("cornell");
  for (const Wall& wall : kWalls) add_wall(stage, wall);
  add_ball(stage);

  Light light;
  light.name = "lamp";
  light.position = {8, 52, 6};
  light.intensity = {16000, 15500, 14500};
  light.radius = 3;
  stage.scene.lights.push_back(light);

  Camera camera;
  camera.name = "corner";
  camera.to_world = look_at({50, 6, 54}, {-4, -26, -4}, {0, 1, 0});
  camera.z_near = 0.1f;
  stage.scene.cameras.push_back(camera);
  return std::move(stage.scene);
}

}  // namespace raysheaf::builtin
