#include "scenes/office.h"
#include "scenes/pattern.h"

namespace raysheaf::builtin {
namespace {

Material textured(std::string_view name, TextureSlot slot, Vec2 scale, float roughness) {
  Material material = matte(name, 0xffffff, roughness);
  slot.scale = scale;
  material.base_color_texture = slot;
  return material;
}

/// Reflects like a mirror; `rgb` is its colour.
Material polished(std::string_view name, std::uint32_t rgb) {
  Material material = matte(name, rgb, 0);
  material.metallic = 1;
  return material;
}

Material clear_glass() {
  Material material = matte("glass", 0xf4fbf8, 0);
  material.transmission = 1;
  material.ior = 1.5f;
  material.double_sided = true;
  return material;
}

Material glowing(std::string_view name, Vec3 emission, TextureSlot slot = {}) {
  Material material = matte(name, 0x101010, 0.5f);
  material.emission = emission;
  material.emission_texture = slot;
  return material;
}

Material on_both_sides(Material material) {
  material.double_sided = true;
  return material;
}

void add_surroundings(Stage& stage, OfficeMaterials& m) {
  m.white_wall = stage.add(matte("white wall", 0xefe8dc, 0.9f));
  m.accent_wall = stage.add(matte("accent wall", 0x5f8a8b, 0.9f));
  m.ceiling = stage.add(matte("ceiling", 0xf4f2ee, 0.95f));
  m.floor = stage.add(textured("floor", stage.add(floor_planks()), {0.7f, 0.7f}, 0.45f));
  m.rug = stage.add(textured("rug", stage.add(rug()), {1, 1}, 0.95f));
  m.trim = stage.add(matte("trim", 0xf6f4f0, 0.5f));
  m.lamp_glow = stage.add(glowing("lamp glow", {2.2f, 2.0f, 1.7f}));
  m.screen = stage.add(glowing("screen", {0.9f, 0.9f, 0.9f}, stage.add(screen_text())));
  m.view = stage.add(glowing("window view", {1.1f, 1.1f, 1.1f}, stage.add(window_view())));
  m.landscape = stage.add(textured("landscape", stage.add(landscape()), {1, 1}, 0.6f));
  m.art = stage.add(textured("abstract art", stage.add(abstract_art()), {1, 1}, 0.6f));
}

void add_furniture(Stage& stage, OfficeMaterials& m) {
  const TextureSlot grain = stage.add(wood_grain());
  m.oak = stage.add(textured("oak", grain, {0.9f, 1.6f}, 0.5f));
  Material walnut = textured("walnut", grain, {1.1f, 2}, 0.4f);
  walnut.base_color = {0.32f, 0.23f, 0.19f, 1};
  m.walnut = stage.add(walnut);
  m.white = stage.add(matte("white plastic", 0xe9e9e6, 0.4f));
  m.black = stage.add(matte("black plastic", 0x202226, 0.35f));
  m.grey = stage.add(matte("grey plastic", 0x6c7178, 0.5f));
  m.silver = stage.add(matte("silver paint", 0xb4b8bd, 0.3f));
  m.brass = stage.add(matte("brass paint", 0xc79a45, 0.3f));
  m.mirror = stage.add(polished("mirror", 0xf2f4f4));
  m.chrome = stage.add(polished("chrome", 0xd8dade));
  m.glass = stage.add(clear_glass());
  m.blue_fabric = stage.add(matte("blue fabric", 0x2f5f95, 0.95f));
  m.orange_fabric = stage.add(matte("orange fabric", 0xd9722e, 0.95f));
  m.curtain = stage.add(on_both_sides(matte("curtain", 0xe3c9a0, 0.95f)));
}

void add_small_things(Stage& stage, OfficeMaterials& m) {
  m.terracotta = stage.add(matte("terracotta", 0xbf6a43, 0.85f));
  m.porcelain = stage.add(matte("porcelain", 0xf1efe9, 0.25f));
  m.red_glaze = stage.add(matte("red glaze", 0xb3262b, 0.22f));
  m.soil = stage.add(matte("soil", 0x3c2a1e, 1));
  m.coffee = stage.add(matte("coffee", 0x2a1509, 0.2f));
  m.paper = stage.add(matte("paper", 0xf7f4ea, 0.9f));
  m.leaf = stage.add(on_both_sides(matte("leaf", 0x2f7a35, 0.45f)));
  m.light_leaf = stage.add(on_both_sides(matte("light leaf", 0x6ea43a, 0.5f)));
  m.paint_green = stage.add(matte("green paint", 0x2e7d5b, 0.3f));
}

}  // namespace

OfficeMaterials office_materials(Stage& stage) {
  OfficeMaterials m{};
  add_surroundings(stage, m);
  add_furniture(stage, m);
  add_small_things(stage, m);
  return m;
}

}  // namespace raysheaf::builtin
