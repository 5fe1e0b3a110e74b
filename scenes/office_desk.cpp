#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kDeskHeight = 0.75f;

std::uint32_t desk_top(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder top("desk top");
  top.use(m.oak);
  add_rounded_box(top, {-0.8f, kDeskHeight - 0.035f, -0.4f}, {0.8f, kDeskHeight, 0.4f}, 0.012f, 2);
  return stage.add(top.take());
}

/// A steel trestle: two posts on feet, and a beam under the top.
std::uint32_t desk_leg(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder leg("desk leg");
  leg.use(m.black);
  const float top = kDeskHeight - 0.06f;
  for (const float z : {-0.33f, 0.33f}) {
    add_rounded_box(leg, {-0.02f, 0.01f, z - 0.02f}, {0.02f, top, z + 0.02f}, 0.006f);
    leg.at(translation({0, 0, z}));
    add_cylinder(leg, {0, 0, 0}, 0.026f, 0.012f, 12);
    leg.at(Affine{});
  }
  add_rounded_box(leg, {-0.02f, top - 0.002f, -0.37f}, {0.02f, kDeskHeight - 0.034f, 0.37f},
                  0.006f);
  return stage.add(leg.take());
}

std::uint32_t pedestal(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder body("desk pedestal");
  body.use(m.white);
  add_rounded_box(body, {-0.21f, 0.05f, -0.36f}, {0.21f, kDeskHeight - 0.034f, 0.34f}, 0.006f);
  body.use(m.black);
  add_box(body, {-0.19f, 0, -0.34f}, {0.19f, 0.052f, 0.31f});
  return stage.add(body.take());
}

std::uint32_t drawer(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder front("drawer");
  front.use(m.oak);
  add_rounded_box(front, {-0.2f, 0.005f, 0}, {0.2f, 0.2f, 0.02f}, 0.005f, 2);
  front.use(m.brass);
  const std::array<Vec3, 6> handle = {{{-0.07f, 0.13f, 0.018f},
                                       {-0.068f, 0.13f, 0.04f},
                                       {-0.055f, 0.13f, 0.05f},
                                       {0.055f, 0.13f, 0.05f},
                                       {0.068f, 0.13f, 0.04f},
                                       {0.07f, 0.13f, 0.018f}}};
  add_tube(front, handle, 0.006f, 0.006f, 8);
  return stage.add(front.take());
}

std::uint32_t modesty_panel(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder panel("modesty panel");
  panel.use(m.white);
  add_rounded_box(panel, {-0.32f, 0.3f, -0.36f}, {0.72f, kDeskHeight - 0.06f, -0.34f}, 0.005f);
  return stage.add(panel.take());
}

std::uint32_t monitor_stand(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder stand("monitor stand");
  stand.use(m.silver);
  add_rounded_box(stand, {-0.13f, 0, -0.1f}, {0.13f, 0.014f, 0.1f}, 0.006f, 2);
  const std::array<Vec3, 5> neck = {{{0, 0.01f, -0.05f},
                                     {0, 0.12f, -0.05f},
                                     {0, 0.22f, -0.048f},
                                     {0, 0.27f, -0.035f},
                                     {0, 0.28f, -0.01f}}};
  add_tube(stand, neck, 0.024f, 0.018f, 16);
  return stage.add(stand.take());
}

std::uint32_t monitor_body(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder body("monitor body");
  body.use(m.black).at(translation({0, 0.3f, 0}));
  add_rounded_box(body, {-0.29f, -0.175f, -0.02f}, {0.29f, 0.175f, 0.012f}, 0.008f, 2);
  return stage.add(body.take());
}

std::uint32_t monitor_screen(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder screen("monitor screen");
  screen.use(m.screen).at(translation({0, 0.3f, 0}));
  add_quad(screen, {-0.276f, -0.155f, 0.0125f}, {0.552f, 0, 0}, {0, 0.316f, 0});
  return stage.add(screen.take());
}

/// A key without its invisible bottom: a flat top on four slanting sides.
void add_key(MeshBuilder& builder, float x, float z, float width) {
  constexpr float kHalf = 0.0078f, kBevel = 0.0022f, kHigh = 0.006f;
  const float half = width / 2 - 0.0012f;
  const std::array<Vec3, 4> foot = {{{x - half, 0, z + kHalf},
                                     {x + half, 0, z + kHalf},
                                     {x + half, 0, z - kHalf},
                                     {x - half, 0, z - kHalf}}};
  const auto top = [&](std::size_t i) {
    const Vec3 p = foot[i % 4];
    return Vec3{p.x + (p.x < x ? kBevel : -kBevel), kHigh, p.z + (p.z < z ? kBevel : -kBevel)};
  };
  add_quad(builder, top(0), top(1) - top(0), top(3) - top(0));
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 a = foot[i], b = foot[(i + 1) % 4], c = top(i + 1), d = top(i);
    const Vec3 n = normalized(cross(b - a, d - a));
    const auto vertex = [&](Vec3 p) { return builder.add_vertex(p, n, {p.x, p.z}); };
    // One after the other: compilers evaluate the arguments of a call in different orders.
    const auto at_d = vertex(d), at_c = vertex(c), at_b = vertex(b), at_a = vertex(a);
    builder.add_quad(at_a, at_b, at_c, at_d);
  }
}

std::uint32_t keyboard(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder board("keyboard");
  const Affine tilt = rotation({1, 0, 0}, radians(4));
  board.use(m.silver).at(compose(translation({0, 0.014f, 0}), tilt));
  add_rounded_box(board, {-0.152f, -0.006f, -0.058f}, {0.152f, 0.004f, 0.058f}, 0.004f, 2);
  board.use(m.white).at(compose(translation({0, 0.018f, 0}), tilt));
  constexpr float kPitch = 0.0195f;
  for (int row = 0; row < 5; ++row) {
    const float z = kPitch * (static_cast<float>(row) - 2);
    const bool with_space_bar = row == 4;
    for (int column = 0; column < 15; ++column) {
      if (with_space_bar && column > 4 && column < 10) continue;
      add_key(board, kPitch * (static_cast<float>(column) - 7), z, kPitch);
    }
    if (with_space_bar) add_key(board, 0, z, 5 * kPitch);
  }
  return stage.add(board.take());
}

std::uint32_t mouse(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder body("mouse");
  body.use(m.white).at(scaling({0.032f, 0.034f, 0.055f}));
  std::vector<Vec2> profile = {{0, 0.02f}, {0.9f, 0.02f}};
  for (const Vec3 p : arc({0, 0, 0}, 1, 12, 90, 6)) profile.push_back({p.x, p.y});
  profile.back().x = 0;
  add_lathe(body, profile, 20);
  body.use(m.grey).at(translation({0, 0.026f, -0.028f}));
  add_rounded_box(body, {-0.004f, -0.004f, -0.009f}, {0.004f, 0.008f, 0.009f}, 0.0035f, 2);
  return stage.add(body.take());
}

}  // namespace

Kit desk(Stage& stage, const OfficeMaterials& m) {
  const auto leg = desk_leg(stage, m), front = drawer(stage, m);
  Kit kit{"desk",
          {{desk_top(stage, m), {}},
           {modesty_panel(stage, m), {}},
           {pedestal(stage, m), translation({-0.55f, 0, 0})},
           {leg, translation({0.74f, 0, 0})},
           {leg, translation({-0.3f, 0, 0})}}};
  for (int i = 0; i < 3; ++i) {
    kit.parts.push_back(
        {front, translation({-0.55f, 0.07f + 0.212f * static_cast<float>(i), 0.338f})});
  }
  return kit;
}

Kit monitor(Stage& stage, const OfficeMaterials& m) {
  return {"monitor",
          {{monitor_stand(stage, m), {}},
           {monitor_body(stage, m), {}},
           {monitor_screen(stage, m), {}}}};
}

Kit keyboard_and_mouse(Stage& stage, const OfficeMaterials& m) {
  return {"keyboard and mouse",
          {{keyboard(stage, m), {}}, {mouse(stage, m), placed({0.23f, 0, 0.01f}, -8)}}};
}

}  // namespace raysheaf::builtin
