// The building behind and above the arcades.
#include <array>

#include "scenes/atrium.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

constexpr float kOuterX = kHalfWidth + kGalleryDepth, kOuterZ = kHalfLength + kGalleryDepth;

/// A horizontal rectangle that faces up or down, with coordinates in metres.
void add_level(MeshBuilder& builder, float x0, float x1, float z0, float z1, float y, bool up) {
  const Vec3 x{x1 - x0, 0, 0}, z{0, 0, z1 - z0};
  if (up) {
    add_quad(builder, {x0, y, z1}, x, -z, {x.x, z.z});
  } else {
    add_quad(builder, {x0, y, z0}, x, z, {x.x, z.z});
  }
}

/// The ring between the court and the outer walls.
void add_ring(MeshBuilder& builder, float x, float z, float y, bool up) {
  add_level(builder, -kOuterX, -x, -kOuterZ, kOuterZ, y, up);
  add_level(builder, x, kOuterX, -kOuterZ, kOuterZ, y, up);
  add_level(builder, -x, x, -kOuterZ, -z, y, up);
  add_level(builder, -x, x, z, kOuterZ, y, up);
}

void add_door(MeshBuilder& builder, const AtriumMaterials& m, const Affine& foot) {
  constexpr float kWide = 1.0f, kHigh = 2.3f;
  builder.use(m.wood).at(foot);
  for (const float side : {-1.0f, 1.0f}) {
    const float middle = side * kWide / 4;
    add_box(builder, {middle - kWide / 4 + 0.004f, 0.01f, 0},
            {middle + kWide / 4 - 0.004f, kHigh, 0.05f});
    for (const float y : {0.2f, 1.25f}) {
      add_rounded_box(builder, {middle - 0.17f, y, 0.03f}, {middle + 0.17f, y + 0.9f, 0.075f},
                      0.02f);
    }
    builder.use(m.bronze);
    add_sphere(builder, {side * 0.06f, 1.1f, 0.075f}, 0.03f, 8, 4);
    builder.use(m.wood);
  }
  builder.use(m.limestone).at(compose(foot, translation({0, kHigh / 2 - 0.1f, 0})));
  const std::array<Vec2, 5> outline = {
      {{0, 0}, {0, 0.09f}, {0.08f, 0.12f}, {0.16f, 0.08f}, {0.18f, 0}}};
  add_moulding(builder, kWide, kHigh + 0.2f, outline);
}

constexpr float kOverhang = 0.55f, kSlope = 0.3f, kRun = kGalleryDepth + kOverhang;

/// Half the length of the eaves, without the corners that the other sides cover.
float half_eaves(const Side& side) {
  return side.length() / 2 - kOverhang;
}

/// A point of the roof's underside: `back` from the eaves, `lift` above it.
Vec3 on_roof(float x, float back, float lift = 0) {
  return {x, kEaves + 0.02f + kSlope * back + lift, kOverhang - back};
}

/// The frame whose -z points up the roof.
Affine up_the_roof(const Side& side, Vec3 foot) {
  const Affine slope = rotation({1, 0, 0}, static_cast<float>(std::atan(double{kSlope})));
  return compose(side.frame, compose(translation(foot), slope));
}

/// Visible from above or from below; the hips widen it towards the back.
void add_roof_plane(MeshBuilder& builder, const Side& side, float lift, bool from_above) {
  const float half = half_eaves(side);
  const std::array<Vec3, 4> corners = {on_roof(-half, 0, lift), on_roof(half, 0, lift),
                                       on_roof(half + kRun, kRun, lift),
                                       on_roof(-half - kRun, kRun, lift)};
  const Vec3 n = normalized(Vec3{0, 1, kSlope} * (from_above ? 1.0f : -1.0f));
  std::array<std::uint32_t, 4> ids{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 p = corners[from_above ? i : 3 - i];
    ids[i] = builder.add_vertex(p, n, {p.x, p.z});
  }
  builder.add_quad(ids[0], ids[1], ids[2], ids[3]);
}

void add_rafters(MeshBuilder& builder, const Side& side) {
  constexpr float kPitch = 0.5f;
  const int count = static_cast<int>(2 * half_eaves(side) / kPitch);
  for (int i = 0; i < count; ++i) {
    const float x = kPitch * (static_cast<float>(i) - 0.5f * static_cast<float>(count - 1));
    builder.at(up_the_roof(side, on_roof(x, 0.03f)));
    add_box(builder, {-0.05f, -0.12f, -1.03f * kRun}, {0.05f, 0, 0});
  }
}

/// Half tubes, whose ends are visible from the court.
void add_barrel_tiles(MeshBuilder& builder, const Side& side) {
  constexpr float kPitch = 0.26f;
  std::vector<Vec2> barrel;
  for (const Vec3 p : arc({0, 0, 0}, 0.12f, 0, 180, 5)) barrel.push_back({p.x, p.y});
  const int count = static_cast<int>(2 * half_eaves(side) / kPitch);
  for (int i = 0; i < count; ++i) {
    const float x = kPitch * (static_cast<float>(i) - 0.5f * static_cast<float>(count - 1));
    builder.at(up_the_roof(side, on_roof(x, 0, 0.05f)));
    add_sweep(builder, barrel, {translation({0, 0, -1.1f}), translation({0, 0, 0.04f})});
  }
}

}  // namespace

void add_floors_and_walls(MeshBuilder& builder, const AtriumMaterials& m) {
  constexpr float kStepX = kHalfWidth - 0.35f, kStepZ = kHalfLength - 0.35f;
  builder.at(Affine{}).use(m.paving);
  add_level(builder, -kStepX, kStepX, -kStepZ, kStepZ, 0, true);
  add_ring(builder, kStepX, kStepZ, kPlinth, true);
  builder.use(m.limestone);
  const Vec3 up{0, kPlinth, 0};
  add_quad(builder, {-kStepX, 0, -kStepZ}, {2 * kStepX, 0, 0}, up);
  add_quad(builder, {kStepX, 0, kStepZ}, {-2 * kStepX, 0, 0}, up);
  add_quad(builder, {-kStepX, 0, kStepZ}, {0, 0, -2 * kStepZ}, up);
  add_quad(builder, {kStepX, 0, -kStepZ}, {0, 0, 2 * kStepZ}, up);
  constexpr float kEdgeX = kHalfWidth - kWallHalf, kEdgeZ = kHalfLength - kWallHalf;
  builder.use(m.plaster);
  add_ring(builder, kEdgeX, kEdgeZ, kFloorHeight - kSlab, false);
  builder.use(m.paving);
  add_ring(builder, kEdgeX, kEdgeZ, kFloorHeight, true);
}

void add_gallery(MeshBuilder& builder, const AtriumMaterials& m, const Side& side) {
  const float half = side.length() / 2 + kGalleryDepth;
  builder.use(m.blocks).at(side.frame);
  add_quad(builder, {-half, kPlinth, -kGalleryDepth}, {2 * half, 0, 0},
           {0, kFloorHeight - kPlinth, 0}, {2 * half, kFloorHeight});
  builder.use(m.plaster);
  add_quad(builder, {-half, kFloorHeight, -kGalleryDepth}, {2 * half, 0, 0},
           {0, kEaves + 1 - kFloorHeight, 0}, {2 * half, 4});
  builder.use(m.limestone);
  add_box(builder, {-side.length() / 2, kFloorHeight - kSlab, kWallHalf - 0.02f},
          {side.length() / 2, kFloorHeight, kWallHalf});
  for (int i = 0; i < side.bays; ++i) {
    const float x = kBay * (static_cast<float>(i) + 0.5f) - side.length() / 2;
    builder.use(m.wood).at(side.frame);
    for (const float shift : {-0.5f, 0.5f}) {
      add_box(builder, {x + shift - 0.07f, kFloorHeight - kSlab - 0.16f, -kGalleryDepth},
              {x + shift + 0.07f, kFloorHeight - kSlab, -kWallHalf});
    }
    if (i % 2 != 0) continue;
    add_door(builder, m, compose(side.frame, translation({x, kPlinth, -kGalleryDepth})));
    add_door(builder, m, compose(side.frame, translation({x, kFloorHeight, -kGalleryDepth})));
  }
}

void add_roof(MeshBuilder& builder, const AtriumMaterials& m, const Side& side) {
  constexpr float kThickness = 0.05f;
  const float half = half_eaves(side);
  builder.at(side.frame).use(m.roof);
  add_roof_plane(builder, side, kThickness, true);
  builder.use(m.wood);
  add_roof_plane(builder, side, 0, false);
  add_quad(builder, on_roof(-half, 0), {2 * half, 0, 0}, {0, kThickness, 0});
  add_rafters(builder, side);
  builder.use(m.roof);
  add_barrel_tiles(builder, side);
}

}  // namespace raysheaf::builtin
