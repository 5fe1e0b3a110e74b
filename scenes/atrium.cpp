// A courtyard with arcades on two storeys, in the style of palaces at the Adriatic.
#include "scenes/atrium.h"

#include <array>

#include "scenes/pattern.h"
#include "scenes/scenes.h"

namespace raysheaf::builtin {
namespace {

Material textured(std::string_view name, TextureSlot slot, float metres, float roughness) {
  Material material = matte(name, 0xffffff, roughness);
  slot.scale = {1 / metres, 1 / metres};
  material.base_color_texture = slot;
  return material;
}

std::uint32_t cloth(Stage& stage, std::string_view name, std::uint32_t rgb) {
  Material material = matte(name, rgb, 0.9f);
  material.double_sided = true;
  return stage.add(material);
}

AtriumMaterials atrium_materials(Stage& stage) {
  AtriumMaterials m{};
  m.blocks = stage.add(textured("stone blocks", stage.add(stone_blocks()), 2, 0.85f));
  m.paving = stage.add(textured("paving", stage.add(paving()), 2.4f, 0.6f));
  m.limestone = stage.add(matte("limestone", 0xe6dcc3, 0.7f));
  m.marble = stage.add(matte("marble", 0xece6dc, 0.35f));
  m.plaster = stage.add(matte("plaster", 0xdfb185, 0.9f));
  m.wood = stage.add(matte("dark wood", 0x6b4428, 0.6f));
  m.roof = stage.add(matte("roof tiles", 0xb5583a, 0.85f));
  m.bronze = stage.add(matte("bronze", 0x8a6a35, 0.35f));
  m.red_cloth = cloth(stage, "red cloth", 0xa8242c);
  m.blue_cloth = cloth(stage, "blue cloth", 0x2a4f9c);
  m.gold_cloth = cloth(stage, "gold cloth", 0xd9a331);
  m.terracotta = stage.add(matte("terracotta", 0xb9653f, 0.85f));
  m.soil = stage.add(matte("soil", 0x3c2a1e, 1));
  m.leaf = cloth(stage, "leaf", 0x3f8a3c);
  m.water = stage.add(matte("water", 0x3f8f9c, 0.2f));
  return m;
}

std::array<Side, 4> sides() {
  return {{{placed({0, 0, -kHalfLength}, 0), 4},
           {placed({0, 0, kHalfLength}, 180), 4},
           {placed({-kHalfWidth, 0, 0}, 90), 10},
           {placed({kHalfWidth, 0, 0}, -90), 10}}};
}

void add_building(MeshBuilder& builder, const AtriumMaterials& m) {
  constexpr Storey kGround{kPlinth, 2.75f, kFloorHeight - kSlab, false};
  constexpr Storey kUpper{kFloorHeight, 6.6f, kEaves, true};
  add_floors_and_walls(builder, m);
  for (const Side& side : sides()) {
    add_gallery(builder, m, side);
    add_arcade(builder, m, side, kGround);
    add_arcade(builder, m, side, kUpper);
    add_balustrade(builder, m, side, kFloorHeight);
    add_cornice(builder, m, side, kFloorHeight);
    add_cornice(builder, m, side, kEaves);
    add_roof(builder, m, side);
  }
}

void decorate(MeshBuilder& builder, const AtriumMaterials& m) {
  const std::array<std::uint32_t, 3> cloths = {m.red_cloth, m.gold_cloth, m.blue_cloth};
  const auto court_sides = sides();
  for (std::size_t i = 0; i < 5; ++i) {
    const float x = 4 * static_cast<float>(i) - 8;
    for (const std::size_t side : {2u, 3u}) {
      const float along = side == 2 ? -x : x;
      const Affine hung =
          compose(court_sides[side].frame, translation({along, kFloorHeight + 0.75f, 0.3f}));
      add_banner(builder, cloths[(i + side) % 3], m.bronze, hung);
      const Vec3 foot{(side == 2 ? -1.0f : 1.0f) * (kHalfWidth - 0.75f), 0, x + 1};
      add_potted_plant(builder, m, translation(foot), 10 * i + side);
    }
  }
  add_fountain(builder, m, translation({0, 0, -2.5f}));
}

}  // namespace

SceneDescription atrium() {
  Stage stage("atrium");
  const AtriumMaterials m = atrium_materials(stage);
  MeshBuilder builder("atrium");
  add_building(builder, m);
  decorate(builder, m);
  stage.place(stage.add(builder.take()), {}, "atrium");

  Light lamp;
  lamp.name = "sky lamp";
  lamp.position = {0.6f, 7, 0.2f};
  lamp.intensity = {165, 150, 126};
  lamp.radius = 0.3f;
  stage.scene.lights.push_back(lamp);

  Camera camera;
  camera.name = "court";
  camera.to_world = look_at({-1.3f, 2.3f, 9.3f}, {0.35f, 3.2f, -4}, {0, 1, 0});
  stage.scene.cameras.push_back(camera);
  return std::move(stage.scene);
}

}  // namespace raysheaf::builtin
