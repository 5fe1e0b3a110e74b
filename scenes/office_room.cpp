// The room itself and the things on its walls.
#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kWindowLeft = -0.7f, kWindowRight = 1.5f, kSill = 0.95f, kLintel = 2.35f;
constexpr float kWallThickness = 0.25f;
constexpr float kRoomWidth = 2 * kRoomHalfWidth, kRoomDepth = kRoomFront - kRoomBack;

std::uint32_t plane(Stage& stage, std::string_view name, std::uint32_t material, Vec3 corner,
                    Vec3 u, Vec3 v) {
  MeshBuilder builder(name);
  builder.use(material);
  add_quad(builder, corner, u, v, {length(u), length(v)});
  return stage.add(builder.take());
}

void build_floor_and_walls(Stage& stage, const OfficeMaterials& m) {
  const Vec3 x{kRoomWidth, 0, 0}, y{0, kRoomHeight, 0}, z{0, 0, kRoomDepth};
  const Vec3 left{-kRoomHalfWidth, 0, kRoomBack}, right{kRoomHalfWidth, 0, kRoomBack};
  stage.place(plane(stage, "floor", m.floor, left + z, x, -z), {}, "floor");
  stage.place(plane(stage, "ceiling", m.ceiling, left + y, x, z), {}, "ceiling");
  stage.place(plane(stage, "left wall", m.white_wall, left + z, -z, y), {}, "left wall");
  stage.place(plane(stage, "right wall", m.white_wall, right, z, y), {}, "right wall");
  stage.place(plane(stage, "front wall", m.white_wall, right + z, -x, y), {}, "front wall");
}

/// Four pieces around the opening, and the opening's own four sides.
void build_window_wall(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder wall("window wall");
  wall.use(m.accent_wall).at(translation({0, 0, kRoomBack}));
  const auto piece = [&](float x0, float x1, float y0, float y1) {
    add_quad(wall, {x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0});
  };
  piece(-kRoomHalfWidth, kWindowLeft, 0, kRoomHeight);
  piece(kWindowRight, kRoomHalfWidth, 0, kRoomHeight);
  piece(kWindowLeft, kWindowRight, 0, kSill);
  piece(kWindowLeft, kWindowRight, kLintel, kRoomHeight);
  wall.use(m.trim);
  const Vec3 in{0, 0, -kWallThickness}, x{kWindowRight - kWindowLeft, 0, 0},
      y{0, kLintel - kSill, 0};
  add_quad(wall, {kWindowLeft, kSill, 0}, x, in);
  add_quad(wall, Vec3{kWindowLeft, kLintel, 0} + in, x, -in);
  add_quad(wall, {kWindowLeft, kSill, 0}, in, y);
  add_quad(wall, Vec3{kWindowRight, kSill, 0} + in, -in, y);
  stage.place(stage.add(wall.take()), {}, "window wall");
}

void build_window(Stage& stage, const OfficeMaterials& m) {
  constexpr float kWindowWidth = kWindowRight - kWindowLeft, kWindowHeight = kLintel - kSill;
  const Vec3 middle{(kWindowLeft + kWindowRight) / 2, (kSill + kLintel) / 2, kRoomBack - 0.16f};
  MeshBuilder frame("window frame");
  frame.use(m.trim);
  const std::array<Vec2, 4> outline = {{{-0.07f, 0}, {-0.07f, 0.06f}, {0, 0.06f}, {0, 0}}};
  add_moulding(frame, kWindowWidth, kWindowHeight, outline);
  add_rounded_box(frame, {-0.035f, -kWindowHeight / 2 + 0.06f, 0},
                  {0.035f, kWindowHeight / 2 - 0.06f, 0.055f}, 0.006f);
  add_rounded_box(frame, {-kWindowWidth / 2 + 0.06f, 0.28f, 0.005f},
                  {kWindowWidth / 2 - 0.06f, 0.33f, 0.05f}, 0.006f);
  stage.place(stage.add(frame.take()), translation(middle), "window frame");

  MeshBuilder sill("window sill");
  sill.use(m.trim);
  add_rounded_box(sill, {-kWindowWidth / 2 - 0.08f, -0.02f, -0.1f},
                  {kWindowWidth / 2 + 0.08f, 0.02f, 0.2f}, 0.012f, 2);
  stage.place(stage.add(sill.take()), translation({middle.x, kSill, kRoomBack}), "window sill");

  const auto view = plane(stage, "window view", m.view, {-3.2f, 0, 0}, {10.6f, 0, 0}, {0, 3, 0});
  for (Vec2& uv : stage.scene.meshes[view].uvs) uv = {uv.x / 5.3f, uv.y / 3};
  stage.place(view, translation({0, -0.1f, kRoomBack - 4}), "window view");
}

void build_curtains(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder curtain("curtain");
  curtain.use(m.curtain);
  add_surface(curtain, 40, 8, [](float u, float v) {
    const float fold = std::sin(2 * kPi * 5 * u) * (0.018f + 0.022f * (1 - v));
    const float gather = 1 + 0.12f * (1 - v);
    return Vec3{(u - 0.5f) * 0.46f * gather, 0.25f + 2.2f * v, fold};
  });
  const auto cloth = stage.add(curtain.take());
  MeshBuilder rod("curtain rod");
  rod.use(m.brass).at(compose(translation({-1.55f, 0, 0}), rotation({0, 0, 1}, radians(-90))));
  add_cylinder(rod, {0, 0, 0}, 0.014f, 3.1f, 12);
  rod.at(Affine{});
  add_sphere(rod, {-1.57f, 0, 0}, 0.03f, 12, 8);
  add_sphere(rod, {1.57f, 0, 0}, 0.03f, 12, 8);
  const float middle = (kWindowLeft + kWindowRight) / 2, z = kRoomBack + 0.13f;
  stage.place(stage.add(rod.take()), translation({middle, 2.47f, z}), "curtain rod");
  stage.place(cloth, translation({kWindowLeft - 0.15f, 0, z}), "left curtain");
  stage.place(cloth, translation({kWindowRight + 0.15f, 0, z}), "right curtain");
}

void build_skirting(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder board("skirting board");
  board.use(m.trim);
  add_box(board, {-0.5f, 0, 0}, {0.5f, 0.09f, 0.018f});
  const auto mesh = stage.add(board.take());
  const auto along = [&](Vec3 middle, float degrees, float size) {
    stage.place(mesh, compose(placed(middle, degrees), scaling({size, 1, 1})), "skirting board");
  };
  const float z = (kRoomBack + kRoomFront) / 2;
  along({0, 0, kRoomBack}, 0, kRoomWidth);
  along({0, 0, kRoomFront}, 180, kRoomWidth);
  along({-kRoomHalfWidth, 0, z}, 90, kRoomDepth);
  along({kRoomHalfWidth, 0, z}, -90, kRoomDepth);
}

void build_radiator(Stage& stage, const OfficeMaterials& m) {
  MeshBuilder fin("radiator fin");
  fin.use(m.white);
  add_rounded_box(fin, {-0.04f, 0.14f, 0.04f}, {0.04f, 0.74f, 0.13f}, 0.03f, 2);
  const auto mesh = stage.add(fin.take());
  for (int i = 0; i < 14; ++i) {
    const float x = 0.4f + 0.09f * (static_cast<float>(i) - 6.5f);
    stage.place(mesh, translation({x, 0, kRoomBack}), "radiator fin");
  }
}

/// A picture or a mirror in a frame, in front of z = 0 and centred at the origin.
Kit framed(Stage& stage, std::string_view name, std::uint32_t surface, std::uint32_t wood,
           float width, float height, float frame_width) {
  MeshBuilder panel("panel");
  panel.use(surface);
  add_quad(panel, {-width / 2, -height / 2, 0.012f}, {width, 0, 0}, {0, height, 0});
  MeshBuilder frame("frame");
  frame.use(wood);
  const float w = frame_width;
  const std::array<Vec2, 6> outline = {{{-0.005f, 0},
                                        {-0.005f, 0.018f},
                                        {0.3f * w, 0.035f},
                                        {0.8f * w, 0.035f},
                                        {w, 0.02f},
                                        {w, 0}}};
  add_moulding(frame, width, height, outline);
  return {std::string(name), {{stage.add(panel.take()), {}}, {stage.add(frame.take()), {}}}};
}

Kit wall_clock(Stage& stage, const OfficeMaterials& m) {
  const Affine upright = rotation({1, 0, 0}, radians(90));
  MeshBuilder face("clock face");
  face.use(m.paper).at(upright);
  add_lathe(face, std::array<Vec2, 2>{{{0.165f, 0.015f}, {0, 0.015f}}}, 40);
  MeshBuilder rim("clock rim");
  rim.use(m.black).at(upright);
  std::vector<Vec2> profile = {{0.16f, 0.001f}};
  for (const Vec3 p : arc({0.175f, 0.024f, 0}, 0.016f, -60, 200, 8)) profile.push_back({p.x, p.y});
  add_lathe(rim, profile, 40);
  MeshBuilder tick("clock tick"), hand("clock hand");
  tick.use(m.black);
  add_box(tick, {-0.004f, 0.125f, 0.015f}, {0.004f, 0.150f, 0.018f});
  hand.use(m.black);
  add_box(hand, {-0.006f, -0.02f, 0.020f}, {0.006f, 0.11f, 0.023f});
  Kit kit{"wall clock", {{stage.add(face.take()), {}}, {stage.add(rim.take()), {}}}};
  const auto tick_mesh = stage.add(tick.take()), hand_mesh = stage.add(hand.take());
  const auto turned = [](float degrees) { return rotation({0, 0, 1}, radians(degrees)); };
  for (int i = 0; i < 12; ++i) {
    kit.parts.push_back({tick_mesh, turned(30 * static_cast<float>(i))});
  }
  kit.parts.push_back({hand_mesh, turned(-54)});
  kit.parts.push_back({hand_mesh, compose(turned(58), scaling({1.3f, 0.65f, 1}))});
  return kit;
}

}  // namespace

void build_room(Stage& stage, const OfficeMaterials& m) {
  build_floor_and_walls(stage, m);
  build_window_wall(stage, m);
  build_window(stage, m);
  build_curtains(stage, m);
  build_skirting(stage, m);
  build_radiator(stage, m);
}

void hang_on_walls(Stage& stage, const OfficeMaterials& m) {
  const Vec3 left{-kRoomHalfWidth, 0, 0}, right{kRoomHalfWidth, 0, 0}, back{0, 0, kRoomBack};
  stage.place(framed(stage, "wall mirror", m.mirror, m.brass, 1.9f, 1.4f, 0.09f),
              placed(left + Vec3{0, 1.45f, -1.3f}, 90));
  stage.place(framed(stage, "landscape", m.landscape, m.walnut, 0.96f, 0.72f, 0.06f),
              placed(back + Vec3{-1.85f, 1.5f, 0}));
  stage.place(framed(stage, "abstract", m.art, m.black, 0.66f, 0.88f, 0.04f),
              placed(right + Vec3{0, 1.6f, -1.1f}, -90));
  stage.place(wall_clock(stage, m), placed(back + Vec3{-1.85f, 2.2f, 0}));
}

}  // namespace raysheaf::builtin
