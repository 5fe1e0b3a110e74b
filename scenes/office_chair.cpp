#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kSeatHeight = 0.46f;

std::uint32_t seat(Stage& stage, const OfficeMaterials& m, std::uint32_t fabric) {
  MeshBuilder builder("chair seat");
  builder.use(fabric);
  add_rounded_box(builder, {-0.24f, kSeatHeight, -0.23f}, {0.24f, kSeatHeight + 0.08f, 0.23f},
                  0.038f, 4);
  builder.use(m.black);
  add_rounded_box(builder, {-0.2f, kSeatHeight - 0.02f, -0.19f}, {0.2f, kSeatHeight + 0.02f, 0.19f},
                  0.015f, 2);
  return stage.add(builder.take());
}

/// A cushion that curves around the sitter: an outline swept along an arc, smaller at both ends.
std::uint32_t back(Stage& stage, std::uint32_t fabric) {
  MeshBuilder builder("chair back");
  constexpr int kSteps = 16;
  constexpr float kRadius = 0.36f;
  Path path;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = 2 * static_cast<float>(i) / kSteps - 1;
    const float size = std::sqrt(1 - 0.9f * std::pow(std::fabs(t), 8.0f));
    const Affine around = rotation({0, 1, 0}, radians(90 - 38 * t));
    path.push_back(
        compose(around, compose(translation({kRadius, 0, 0}), scaling({size, size, 1}))));
  }
  // The arc's middle leans back behind the seat.
  const Affine lean = rotation({1, 0, 0}, radians(-8));
  builder.use(fabric).at(compose(translation({0, kSeatHeight + 0.4f, -0.28f}),
                                 compose(lean, translation({0, 0, kRadius}))));
  add_sweep(builder, rounded_rectangle(0.06f, 0.48f, 0.028f, 4), path);
  return stage.add(builder.take());
}

/// The support of the back: a flat bar from under the seat.
std::uint32_t spine(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("chair spine");
  builder.use(m.black);
  const std::array<Vec3, 7> points = {{{0, kSeatHeight - 0.01f, -0.05f},
                                       {0, kSeatHeight - 0.01f, -0.22f},
                                       {0, kSeatHeight + 0.01f, -0.29f},
                                       {0, kSeatHeight + 0.07f, -0.325f},
                                       {0, kSeatHeight + 0.2f, -0.335f},
                                       {0, kSeatHeight + 0.35f, -0.335f},
                                       {0, kSeatHeight + 0.5f, -0.33f}}};
  Path path = path_along(points);
  add_sweep(builder, rounded_rectangle(0.07f, 0.018f, 0.007f, 2), path);
  return stage.add(builder.take());
}

std::uint32_t arm_rest(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("arm rest");
  builder.use(m.black);
  const std::array<Vec3, 5> points = {{{0.02f, kSeatHeight, 0},
                                       {0.07f, kSeatHeight + 0.01f, 0},
                                       {0.085f, kSeatHeight + 0.05f, 0},
                                       {0.085f, kSeatHeight + 0.15f, 0},
                                       {0.085f, kSeatHeight + 0.2f, 0}}};
  add_tube(builder, points, 0.016f, 0.014f, 10);
  add_rounded_box(builder, {0.05f, kSeatHeight + 0.195f, -0.13f},
                  {0.12f, kSeatHeight + 0.225f, 0.13f}, 0.013f, 3);
  return stage.add(builder.take());
}

std::uint32_t column(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("chair column");
  builder.use(m.black);
  add_lathe(builder,
            std::array<Vec2, 6>{{{0, 0.07f},
                                 {0.045f, 0.07f},
                                 {0.045f, 0.11f},
                                 {0.032f, 0.13f},
                                 {0.032f, 0.26f},
                                 {0.018f, 0.26f}}},
            20);
  builder.use(m.chrome);
  add_lathe(
      builder,
      std::array<Vec2, 4>{
          {{0, 0.25f}, {0.018f, 0.25f}, {0.018f, kSeatHeight - 0.015f}, {0, kSeatHeight - 0.015f}}},
      20);
  return stage.add(builder.take());
}

/// From the column outwards along +x.
std::uint32_t foot(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("chair foot");
  builder.use(m.silver);
  const std::array<Vec3, 4> points = {
      {{0.03f, 0.095f, 0}, {0.12f, 0.09f, 0}, {0.22f, 0.08f, 0}, {0.31f, 0.072f, 0}}};
  Path path = path_along(points);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const float size = 1 - 0.12f * static_cast<float>(i);
    path[i] = compose(path[i], scaling({size, size, 1}));
  }
  add_sweep(builder, rounded_rectangle(0.05f, 0.034f, 0.01f, 2), path);
  return stage.add(builder.take());
}

std::uint32_t castor(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder builder("castor");
  builder.use(m.black);
  const std::array<Vec2, 6> wheel = {
      {{0, 0}, {0.022f, 0}, {0.029f, 0.004f}, {0.029f, 0.014f}, {0.022f, 0.018f}, {0, 0.018f}}};
  for (const float x : {-0.022f, 0.004f}) {
    builder.at(compose(translation({x, 0.029f, 0.012f}), rotation({0, 0, 1}, radians(-90))));
    add_lathe(builder, wheel, 16);
  }
  builder.use(m.grey).at(Affine{});
  add_rounded_box(builder, {-0.005f, 0.02f, -0.012f}, {0.005f, 0.062f, 0.03f}, 0.003f);
  add_cylinder(builder, {0, 0.05f, 0}, 0.008f, 0.03f, 10);
  return stage.add(builder.take());
}

}  // namespace

Kit chair(Stage& stage, const OfficeMaterials& m, std::uint32_t fabric) {
  const auto rest = arm_rest(stage, m), leg = foot(stage, m), wheel = castor(stage, m);
  Kit kit{"chair",
          {{seat(stage, m, fabric), {}},
           {back(stage, fabric), {}},
           {spine(stage, m), {}},
           {column(stage, m), {}},
           {rest, translation({0.19f, 0, 0})},
           {rest, placed({-0.19f, 0, 0}, 180)}}};
  for (int i = 0; i < 5; ++i) {
    const float degrees = 72 * static_cast<float>(i) + 18;
    const Affine turned = placed({0, 0, 0}, degrees);
    kit.parts.push_back({leg, turned});
    kit.parts.push_back({wheel, compose(turned, placed({0.3f, 0, 0}, 40 * static_cast<float>(i)))});
  }
  return kit;
}

}  // namespace raysheaf::builtin
