#include <algorithm>
#include <array>

#include "scenes/office.h"
#include "scenes/shapes.h"

namespace raysheaf::builtin {
namespace {

/// A leaf of one metre along +x from its stalk, arched, and folded along its middle.
std::uint32_t leaf(Stage& stage, std::string_view name, std::uint32_t material, float width,
                   float droop) {
  MeshBuilder builder(name);
  builder.use(material);
  add_surface(builder, 10, 4, [&](float u, float v) {
    const float half =
        width * (0.06f + std::pow(std::max(0.0f, std::sin(kPi * std::pow(u, 0.75f))), 0.8f));
    const float side = 1 - 2 * v;
    const float rise = 0.35f * std::sin(1.9f * u) - droop * u * u + 0.18f * half * side * side;
    return Vec3{u, rise, half * side};
  });
  return stage.add(builder.take());
}

std::uint32_t pot(Stage& stage, const OfficeMaterials& m, std::uint32_t glaze) {
  MeshBuilder builder("flower pot");
  builder.use(glaze);
  const std::array<Vec2, 8> profile = {{{0, 0},
                                        {0.32f, 0},
                                        {0.44f, 0.72f},
                                        {0.5f, 0.74f},
                                        {0.5f, 0.9f},
                                        {0.44f, 0.9f},
                                        {0.42f, 0.8f},
                                        {0.42f, 0.78f}}};
  add_lathe(builder, profile, 28);
  builder.use(m.soil);
  add_lathe(builder, std::array<Vec2, 3>{{{0.42f, 0.78f}, {0.2f, 0.82f}, {0, 0.83f}}}, 28);
  return stage.add(builder.take());
}

Affine leaf_at(Vec3 stalk, float degrees, float pitch, float size) {
  const Affine up = compose(rotation({0, 0, 1}, radians(pitch)), scaling({size, size, size}));
  return compose(placed(stalk, degrees), up);
}

}  // namespace

Kit small_plant(Stage& stage, const OfficeMaterials& m) {
  constexpr float kPot = 0.16f;
  const auto blade = leaf(stage, "small leaf", m.light_leaf, 0.11f, 0.75f);
  Kit kit{"small plant", {{pot(stage, m, m.terracotta), scaling({kPot, kPot, kPot})}}};
  Random random(41);
  for (int i = 0; i < 18; ++i) {
    const float degrees = 137.5f * static_cast<float>(i) + random.uniform(-12, 12);
    const float pitch = 70 - 3.2f * static_cast<float>(i) + random.uniform(-6, 6);
    kit.parts.push_back(
        {blade, leaf_at({0, 0.82f * kPot, 0}, degrees, pitch, random.uniform(0.17f, 0.26f))});
  }
  return kit;
}

Kit tall_plant(Stage& stage, const OfficeMaterials& m) {
  constexpr float kPot = 0.42f;
  const auto blade = leaf(stage, "tall leaf", m.leaf, 0.24f, 0.55f);
  MeshBuilder stems("stems");
  stems.use(m.walnut);
  Kit kit{"tall plant", {{pot(stage, m, m.porcelain), scaling({kPot, kPot, kPot})}}};
  Random random(7);
  for (int i = 0; i < 3; ++i) {
    const float turn = radians(120 * static_cast<float>(i) + 20),
                high = 1.15f + 0.25f * static_cast<float>(i);
    std::vector<Vec3> stem;
    for (int k = 0; k <= 5; ++k) {
      const float t = static_cast<float>(k) / 5, out = 0.04f + 0.14f * t * t;
      stem.push_back({out * std::cos(turn), 0.32f + (high - 0.32f) * t, out * std::sin(turn)});
    }
    add_tube(stems, stem, 0.014f, 0.007f, 8);
    for (int k = 0; k < 10; ++k) {
      const float t = 0.35f + 0.65f * static_cast<float>(k) / 9;
      const Vec3 at =
          lerp(stem[static_cast<std::size_t>(t * 4.99f)],
               stem[static_cast<std::size_t>(t * 4.99f) + 1], t * 4.99f - std::floor(t * 4.99f));
      // One after the other: compilers evaluate the arguments of a call in different orders.
      const float size = random.uniform(0.26f, 0.4f), pitch = random.uniform(15, 50);
      const float degrees = 137.5f * static_cast<float>(k) + random.uniform(0, 60);
      kit.parts.push_back({blade, leaf_at(at, degrees, pitch, size)});
    }
  }
  kit.parts.push_back({stage.add(stems.take()), {}});
  return kit;
}

}  // namespace raysheaf::builtin
