#include <array>

#include "scenes/atrium.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr int kArchSteps = 12;

/// A wall's side between an arch and a horizontal top: `z` is its depth, `front` tells which way it
/// faces.
void add_spandrel(MeshBuilder& builder, std::span<const Vec3> curve, float top, float z,
                  bool front) {
  const Vec3 n{0, 0, front ? 1.0f : -1.0f};
  const auto vertex = [&](float x, float y) { return builder.add_vertex({x, y, z}, n, {x, -y}); };
  const auto strip = [&](Vec3 a, Vec3 b) {
    const auto p = vertex(a.x, a.y), q = vertex(b.x, b.y), r = vertex(b.x, top),
               s = vertex(a.x, top);
    if (front) {
      builder.add_quad(p, q, r, s);
    } else {
      builder.add_quad(q, p, s, r);
    }
  };
  const Vec3 left{-kBay / 2, curve.front().y, 0}, right{kBay / 2, curve.back().y, 0};
  strip(left, curve.front());
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) strip(curve[i], curve[i + 1]);
  strip(curve.back(), right);
}

void add_soffit(MeshBuilder& builder, std::span<const Vec3> curve, Vec3 center) {
  std::vector<std::uint32_t> ids;
  for (const Vec3 p : curve) {
    const Vec3 n = normalized(center - p);
    for (const float z : {-kWallHalf, kWallHalf}) {
      ids.push_back(builder.add_vertex({p.x, p.y, z}, n, {p.x + p.y, z}));
    }
  }
  for (std::size_t i = 0; i + 3 < ids.size(); i += 2) {
    builder.add_quad(ids[i], ids[i + 2], ids[i + 3], ids[i + 1]);
  }
}

/// The moulding around an arch on the court's side.
void add_archivolt(MeshBuilder& builder, Vec3 center) {
  Path path;
  for (int i = 0; i <= kArchSteps; ++i) {
    const float angle = radians(180 - 180 * static_cast<float>(i) / kArchSteps);
    // The outline's plane: x is the distance from the centre, y the height above the wall's middle.
    const Affine upright = rotation({1, 0, 0}, radians(90));
    path.push_back(compose(translation(center), compose(rotation({0, 0, 1}, angle), upright)));
  }
  constexpr float kIn = kArchRadius - 0.01f, kOut = kArchRadius + 0.13f;
  const std::array<Vec2, 5> outline = {{{kIn, kWallHalf - 0.02f},
                                        {kOut, kWallHalf - 0.02f},
                                        {kOut, kWallHalf + 0.02f},
                                        {kOut - 0.05f, kWallHalf + 0.05f},
                                        {kIn, kWallHalf + 0.03f}}};
  add_sweep(builder, outline, path, Ends::kOpen);
}

void add_arch(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
              const Storey& storey) {
  const Vec3 center{0, storey.springing, 0};
  const auto curve = arc(center, kArchRadius, 180, 0, kArchSteps);
  builder.use(storey.is_upper ? m.plaster : m.blocks).at(frame);
  add_spandrel(builder, curve, storey.top, kWallHalf, true);
  add_spandrel(builder, curve, storey.top, -kWallHalf, false);
  builder.use(m.limestone);
  add_soffit(builder, curve, center);
  add_archivolt(builder, center);
  const float crown = storey.springing + kArchRadius;
  add_box(builder, {-0.08f, crown - 0.04f, kWallHalf - 0.05f},
          {0.08f, crown + 0.24f, kWallHalf + 0.09f});
}

float along(const Side& side, float bay) {
  return kBay * bay - side.length() / 2;
}

}  // namespace

void add_arcade(MeshBuilder& builder, const AtriumMaterials& m, const Side& side,
                const Storey& storey) {
  const float height = storey.springing - storey.floor;
  const auto add_column = storey.is_upper ? add_slender_column : add_fluted_column;
  for (int i = 0; i < side.bays; ++i) {
    const float x = along(side, static_cast<float>(i));
    add_arch(builder, m, compose(side.frame, translation({x + kBay / 2, 0, 0})), storey);
    const Affine foot = compose(side.frame, translation({x, storey.floor, 0}));
    if (i == 0) {
      add_pier(builder, m, foot, height);
    } else {
      add_column(builder, m, foot, height);
    }
  }
}

void add_balustrade(MeshBuilder& builder, const AtriumMaterials& m, const Side& side, float floor) {
  constexpr int kBalusters = 5;
  constexpr float kHigh = 0.12f;
  for (int i = 0; i < side.bays; ++i) {
    const Affine bay = compose(
        side.frame, translation({along(side, static_cast<float>(i)) + kBay / 2, floor, 0.05f}));
    for (int k = 0; k < kBalusters; ++k) {
      const float x = 0.31f * (static_cast<float>(k) - 0.5f * (kBalusters - 1));
      add_baluster(builder, m, compose(bay, translation({x, kHigh, 0})));
    }
    builder.use(m.limestone).at(bay);
    add_box(builder, {-kBay / 2 + 0.1f, 0, -0.08f}, {kBay / 2 - 0.1f, kHigh, 0.08f});
    add_rounded_box(builder, {-kBay / 2 + 0.1f, kHigh + 0.6f, -0.085f},
                    {kBay / 2 - 0.1f, kHigh + 0.7f, 0.085f}, 0.025f);
  }
}

void add_cornice(MeshBuilder& builder, const AtriumMaterials& m, const Side& side, float y) {
  const std::array<Vec2, 7> outline = {{{0, -0.28f},
                                        {0.04f, -0.28f},
                                        {0.08f, -0.18f},
                                        {0.2f, -0.13f},
                                        {0.22f, -0.05f},
                                        {0.27f, 0},
                                        {0, 0}}};
  const float half = side.length() / 2 - kWallHalf;
  builder.use(m.limestone).at(compose(side.frame, translation({0, y, kWallHalf})));
  // In the outline's plane x points into the court; the ends are mitred to fit the other sides.
  std::vector<Affine> ends(2);
  for (int i = 0; i < 2; ++i) {
    const float sign = i == 0 ? 1.0f : -1.0f;
    ends[static_cast<std::size_t>(i)].m = {
        {{-sign, 0, -1, sign * half}, {0, 1, 0, 0}, {1, 0, 0, 0}}};
  }
  add_sweep(builder, outline, ends, Ends::kOpen);
  const int dentils = static_cast<int>(2 * half / 0.25f);
  for (int i = 0; i < dentils; ++i) {
    const float x = 0.25f * (static_cast<float>(i) - 0.5f * static_cast<float>(dentils - 1));
    add_box(builder, {x - 0.06f, -0.3f, 0}, {x + 0.06f, -0.19f, 0.11f});
  }
}

}  // namespace raysheaf::builtin
