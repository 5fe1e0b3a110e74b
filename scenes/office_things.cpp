// Things on desks and on the floor, and the lamp above them.
#include <algorithm>
#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

/// A hollow profile: along `outer`, and back along the same points moved inwards.
std::vector<Vec2> shell(std::span<const Vec2> outer, float thickness) {
  std::vector<Vec2> profile(outer.begin(), outer.end());
  for (std::size_t i = outer.size(); i-- > 0;) {
    const Vec2 before = outer[i == 0 ? 0 : i - 1], after = outer[std::min(i + 1, outer.size() - 1)];
    const Vec3 n = normalized({after.y - before.y, before.x - after.x, 0});
    const bool on_axis = outer[i].x == 0;
    profile.push_back({on_axis ? 0 : outer[i].x - n.x * thickness, outer[i].y - n.y * thickness});
  }
  if (outer.front().x != 0) profile.push_back(outer.front());
  return profile;
}

std::uint32_t lamp_foot(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder foot("lamp foot");
  foot.use(m.black);
  add_lathe(
      foot,
      std::array<Vec2, 6>{
          {{0, 0}, {0.085f, 0}, {0.09f, 0.006f}, {0.086f, 0.016f}, {0.02f, 0.024f}, {0, 0.03f}}},
      32);
  foot.use(m.brass);
  const std::array<Vec3, 2> lower = {{{0, 0.02f, 0}, {-0.1f, 0.27f, 0}}};
  const std::array<Vec3, 2> upper = {{{-0.1f, 0.27f, 0}, {0.12f, 0.43f, 0}}};
  add_tube(foot, lower, 0.007f, 0.007f, 10);
  add_tube(foot, upper, 0.007f, 0.007f, 10);
  for (const Vec3 joint : {Vec3{0, 0.03f, 0}, Vec3{-0.1f, 0.27f, 0}, Vec3{0.12f, 0.43f, 0}}) {
    add_sphere(foot, joint, 0.014f, 12, 8);
  }
  return stage.add(foot.take());
}

std::uint32_t lamp_shade(Stage& stage, std::uint32_t paint) {
  MeshBuilder shade("lamp shade");
  shade.use(paint);
  const std::array<Vec2, 6> outer = {{{0.085f, 0},
                                      {0.075f, 0.035f},
                                      {0.055f, 0.07f},
                                      {0.03f, 0.095f},
                                      {0.02f, 0.125f},
                                      {0, 0.13f}}};
  add_lathe(shade, shell(outer, 0.004f), 28);
  return stage.add(shade.take());
}

std::uint32_t lamp_bulb(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder bulb("lamp bulb");
  bulb.use(m.lamp_glow);
  add_sphere(bulb, {0, 0.03f, 0}, 0.032f, 16, 10);
  return stage.add(bulb.take());
}

std::uint32_t pen(Stage& stage, std::uint32_t paint, std::uint32_t tip) {
  MeshBuilder builder("pen");
  builder.use(paint);
  add_lathe(builder,
            std::array<Vec2, 4>{{{0, 0}, {0.0038f, 0}, {0.0038f, 0.13f}, {0.0032f, 0.131f}}}, 8);
  builder.use(tip);
  add_lathe(builder, std::array<Vec2, 2>{{{0.0032f, 0.131f}, {0, 0.148f}}}, 8);
  return stage.add(builder.take());
}

}  // namespace

Kit desk_lamp(Stage& stage, const OfficeMaterials& m) {
  const Affine head = compose(translation({0.14f, 0.36f, 0}), rotation({0, 0, 1}, radians(18)));
  return {"desk lamp",
          {{lamp_foot(stage, m), {}},
           {lamp_shade(stage, m.paint_green), head},
           {lamp_bulb(stage, m), head}}};
}

Kit mug(Stage& stage, const OfficeMaterials& m, std::uint32_t glaze) {
  MeshBuilder body("mug");
  body.use(glaze);
  const std::array<Vec2, 5> outer = {
      {{0, 0}, {0.034f, 0}, {0.039f, 0.006f}, {0.041f, 0.05f}, {0.042f, 0.095f}}};
  add_lathe(body, shell(outer, 0.004f), 28);
  std::vector<Vec3> handle = arc({0.04f, 0.05f, 0}, 0.026f, 75, -75, 8);
  add_tube(body, handle, 0.005f, 0.005f, 8);
  body.use(m.coffee);
  add_lathe(body, std::array<Vec2, 2>{{{0.0375f, 0.08f}, {0, 0.08f}}}, 28);
  return {"mug", {{stage.add(body.take()), {}}}};
}

Kit glass_ball(Stage& stage, const OfficeMaterials& m) {
  constexpr float kRadius = 0.13f;
  MeshBuilder ball("glass ball"), ring("ball stand");
  ball.use(m.glass);
  add_sphere(ball, {0, 0, 0}, kRadius, 48, 32);
  ring.use(m.walnut);
  std::vector<Vec2> profile;
  for (const Vec3 p : arc({0.062f, 0.013f, 0}, 0.013f, -180, 180, 12))
    profile.push_back({p.x, p.y});
  profile.back() = profile.front();
  add_lathe(ring, profile, 32);
  return {"glass ball",
          {{stage.add(ball.take()), translation({0, 0.129f, 0})}, {stage.add(ring.take()), {}}}};
}

Kit glass_drop(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder drop("glass drop");
  drop.use(m.glass);
  std::vector<Vec2> profile = {{0, 0}, {0.03f, 0}};
  for (int i = 1; i < 20; ++i) {
    const float t = static_cast<float>(i) / 20;
    const float angle = radians(35 + 145 * t);
    const float radius = 0.052f * std::sin(angle) * (1 - 0.35f * t);
    profile.push_back({radius, 0.2f * t * (0.6f + 0.4f * t)});
  }
  profile.push_back({0, 0.2f});
  add_lathe(drop, profile, 36);
  return {"glass drop", {{stage.add(drop.take()), {}}}};
}

Kit pen_cup(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder cup("pen cup");
  cup.use(m.brass);
  const std::array<Vec2, 3> outer = {{{0, 0}, {0.036f, 0}, {0.036f, 0.1f}}};
  add_lathe(cup, shell(outer, 0.003f), 24);
  Kit kit{"pen cup", {{stage.add(cup.take()), {}}}};
  const std::array<std::uint32_t, 3> pens = {pen(stage, m.red_glaze, m.paper),
                                             pen(stage, m.blue_fabric, m.paper),
                                             pen(stage, m.paint_green, m.paper)};
  for (int i = 0; i < 6; ++i) {
    const Affine leaning =
        compose(translation({0.012f, 0.006f, 0}), rotation({0, 0, 1}, radians(-8)));
    kit.parts.push_back({pens[static_cast<std::size_t>(i % 3)],
                         compose(placed({0, 0, 0}, 61 * static_cast<float>(i)), leaning)});
  }
  return kit;
}

Kit paper_stack(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder sheets("paper");
  sheets.use(m.paper);
  add_box(sheets, {-0.105f, 0, -0.1485f}, {0.105f, 0.006f, 0.1485f});
  const auto mesh = stage.add(sheets.take());
  return {"paper stack",
          {{mesh, {}},
           {mesh, placed({0.008f, 0.0061f, 0.004f}, 7)},
           {mesh, placed({-0.004f, 0.0122f, 0}, -4)}}};
}

Kit waste_bin(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder bin("waste bin");
  bin.use(m.grey);
  const std::array<Vec2, 5> outer = {
      {{0, 0}, {0.11f, 0}, {0.145f, 0.28f}, {0.152f, 0.285f}, {0.152f, 0.3f}}};
  add_lathe(bin, shell(outer, 0.005f), 32);
  return {"waste bin", {{stage.add(bin.take()), {}}}};
}

Kit ceiling_lamp(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder mount("ceiling lamp mount"), bowl("ceiling lamp bowl");
  mount.use(m.brass);
  add_lathe(mount,
            std::array<Vec2, 8>{{{0, -0.19f},
                                 {0.33f, -0.19f},
                                 {0.36f, -0.18f},
                                 {0.36f, -0.16f},
                                 {0.02f, -0.12f},
                                 {0.02f, -0.03f},
                                 {0.09f, -0.01f},
                                 {0.09f, 0}}},
            40);
  bowl.use(m.lamp_glow);
  std::vector<Vec2> profile;
  for (const Vec3 p : arc({0, 0, 0}, 1, -90, -8, 8)) {
    profile.push_back({0.33f * p.x, 0.07f * p.y - 0.18f});
  }
  profile.front().x = 0;
  profile.push_back({0, -0.185f});
  add_lathe(bowl, profile, 40);
  return {"ceiling lamp", {{stage.add(mount.take()), {}}, {stage.add(bowl.take()), {}}}};
}

}  // namespace raysheaf::builtin
