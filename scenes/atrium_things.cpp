#include <algorithm>
#include <array>

#include "scenes/atrium.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {

/// Hangs down from y = 0 in front of z = 0, and ends in a point.
void add_banner(MeshBuilder& builder, std::uint32_t cloth, std::uint32_t rod, const Affine& frame) {
  constexpr float kWide = 0.9f, kLong = 2.3f;
  builder.use(rod).at(compose(frame, compose(translation({-kWide / 2 - 0.08f, 0, 0.1f}),
                                             rotation({0, 0, 1}, radians(-90)))));
  add_cylinder(builder, {0, 0, 0}, 0.02f, kWide + 0.16f, 8);
  builder.use(cloth).at(frame);
  add_surface(builder, 12, 14, [&](float u, float v) {
    const float down = 1 - v;
    const float point = 0.35f * (1 - std::fabs(2 * u - 1));
    const float wave = 0.055f * std::sin(2 * kPi * 1.5f * u + 2.5f * down) * down;
    const float billow = 0.18f * std::sin(kPi * 0.9f * down) * std::sin(kPi * u);
    return Vec3{(u - 0.5f) * kWide * (1 - 0.06f * down), -(kLong + point) * down,
                0.12f + wave + billow};
  });
}

void add_potted_plant(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                      std::uint64_t seed) {
  const std::array<Vec2, 11> profile = {{{0, 0},
                                         {0.2f, 0},
                                         {0.2f, 0.04f},
                                         {0.15f, 0.08f},
                                         {0.27f, 0.3f},
                                         {0.29f, 0.42f},
                                         {0.26f, 0.52f},
                                         {0.31f, 0.56f},
                                         {0.31f, 0.62f},
                                         {0.26f, 0.62f},
                                         {0.25f, 0.57f}}};
  builder.use(m.terracotta).at(frame);
  add_lathe(builder, profile, 14);
  builder.use(m.soil);
  add_lathe(builder, std::array<Vec2, 2>{{{0.25f, 0.57f}, {0, 0.59f}}}, 14);
  builder.use(m.leaf);
  Random random(seed);
  for (int i = 0; i < 16; ++i) {
    const float size = random.uniform(0.5f, 0.95f), pitch = random.uniform(25, 78);
    const Affine up = compose(rotation({0, 0, 1}, radians(pitch)), scaling({size, size, size}));
    builder.at(compose(frame, compose(placed({0, 0.56f, 0}, 137.5f * static_cast<float>(i)), up)));
    add_surface(builder, 6, 2, [&](float u, float v) {
      const float half = 0.015f + 0.085f * std::sin(kPi * std::min(1.0f, 0.12f + 0.87f * u));
      const float side = 1 - 2 * v;
      return Vec3{u, -0.5f * u * u + 0.3f * half * side * side, half * side};
    });
  }
}

void add_fountain(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame) {
  builder.use(m.marble).at(frame);
  const std::array<Vec2, 10> basin = {{{1.55f, 0},
                                       {1.55f, 0.1f},
                                       {1.42f, 0.14f},
                                       {1.38f, 0.36f},
                                       {1.48f, 0.42f},
                                       {1.5f, 0.5f},
                                       {1.3f, 0.5f},
                                       {1.26f, 0.44f},
                                       {1.22f, 0.1f},
                                       {0, 0.1f}}};
  add_lathe(builder, basin, 8);
  const std::array<Vec2, 16> stem = {{{0.3f, 0.1f},
                                      {0.3f, 0.4f},
                                      {0.16f, 0.5f},
                                      {0.12f, 0.75f},
                                      {0.2f, 0.9f},
                                      {0.13f, 1.05f},
                                      {0.5f, 1.2f},
                                      {0.66f, 1.34f},
                                      {0.7f, 1.36f},
                                      {0.66f, 1.38f},
                                      {0.46f, 1.27f},
                                      {0.1f, 1.26f},
                                      {0.07f, 1.5f},
                                      {0.11f, 1.62f},
                                      {0.06f, 1.72f},
                                      {0, 1.76f}}};
  add_lathe(builder, stem, 28);
  builder.use(m.water);
  add_lathe(builder, std::array<Vec2, 2>{{{1.25f, 0.4f}, {0, 0.4f}}}, 8);
  add_lathe(builder, std::array<Vec2, 2>{{{0.6f, 1.34f}, {0, 1.34f}}}, 28);
}

}  // namespace raysheaf::builtin
