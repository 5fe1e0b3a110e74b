#include <array>

#include "scenes/atrium.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

/// The Attic base: two rings with a hollow between them, on a square plinth.
void add_base(MeshBuilder& builder, float radius) {
  const float r = radius;
  add_box(builder, {-1.45f * r, 0, -1.45f * r}, {1.45f * r, 0.35f * r, 1.45f * r});
  const std::array<Vec2, 8> profile = {{{1.25f * r, 0.35f * r},
                                        {1.42f * r, 0.5f * r},
                                        {1.3f * r, 0.68f * r},
                                        {1.14f * r, 0.76f * r},
                                        {1.14f * r, 0.9f * r},
                                        {1.25f * r, 1.0f * r},
                                        {1.14f * r, 1.12f * r},
                                        {1.0f * r, 1.18f * r}}};
  add_lathe(builder, profile, 12);
}

/// From `y` upwards: a ring, a bell and a square slab as wide as the arch needs.
void add_capital(MeshBuilder& builder, float y, float radius) {
  const float r = radius;
  const std::array<Vec2, 7> profile = {{{0.86f * r, y - 0.02f},
                                        {1.02f * r, y + 0.02f},
                                        {0.9f * r, y + 0.06f},
                                        {0.95f * r, y + 0.15f},
                                        {1.15f * r, y + 0.22f},
                                        {1.4f * r, y + 0.26f},
                                        {1.3f * r, y + 0.29f}}};
  add_lathe(builder, profile, 12);
  add_rounded_box(builder, {-0.235f, y + 0.28f, -0.235f}, {0.235f, y + 0.36f, 0.235f}, 0.012f);
}

constexpr float kCapitalHeight = 0.36f;

}  // namespace

void add_fluted_column(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                       float height) {
  constexpr float kRadius = 0.19f;
  constexpr int kFlutes = 12;
  const float low = 1.17f * kRadius, high = height - kCapitalHeight;
  builder.use(m.limestone).at(frame);
  add_base(builder, kRadius);
  add_surface(
      builder, 4 * kFlutes, 2,
      [&](float u, float v) {
        const float hollow = 0.035f * (1 - std::cos(2 * kPi * kFlutes * u));
        const float taper = 1 - 0.14f * v * v;
        const float r = kRadius * taper * (1 - hollow), angle = -2 * kPi * u;
        return Vec3{r * std::cos(angle), high + (low - high) * (1 - v), r * std::sin(angle)};
      },
      true);
  add_capital(builder, high, kRadius);
}

void add_slender_column(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame,
                        float height) {
  constexpr float kRadius = 0.14f;
  const float high = height - kCapitalHeight;
  builder.use(m.limestone).at(frame);
  add_base(builder, kRadius);
  builder.use(m.marble);
  add_lathe(builder,
            std::array<Vec2, 4>{{{kRadius, 1.17f * kRadius},
                                 {kRadius, 0.4f * high},
                                 {0.95f * kRadius, 0.75f * high},
                                 {0.86f * kRadius, high}}},
            16);
  builder.use(m.limestone);
  add_capital(builder, high, kRadius);
}

void add_pier(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame, float height) {
  builder.use(m.blocks).at(frame);
  add_box(builder, {-0.24f, 0, -0.24f}, {0.24f, height, 0.24f});
  builder.use(m.limestone);
  add_rounded_box(builder, {-0.29f, 0, -0.29f}, {0.29f, 0.22f, 0.29f}, 0.02f);
  add_rounded_box(builder, {-0.27f, height - 0.1f, -0.27f}, {0.27f, height, 0.27f}, 0.02f);
}

void add_baluster(MeshBuilder& builder, const AtriumMaterials& m, const Affine& frame) {
  builder.use(m.marble).at(frame);
  const std::array<Vec2, 8> profile = {{{0.045f, 0},
                                        {0.045f, 0.05f},
                                        {0.03f, 0.08f},
                                        {0.062f, 0.2f},
                                        {0.05f, 0.32f},
                                        {0.026f, 0.48f},
                                        {0.045f, 0.54f},
                                        {0.045f, 0.6f}}};
  add_lathe(builder, profile, 7);
}

}  // namespace raysheaf::builtin
