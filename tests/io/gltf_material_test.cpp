// Materials of glTF.
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using GltfMaterials = IoTest;

TEST_F(GltfMaterials, ReadsMaterialsAndTheirDefaults) {
  GltfFile file;
  file.add("materials", {{"name", "plain"}});
  file.add("materials", {{"doubleSided", true},
                         {"emissiveFactor", {0.5, 0.25, 1}},
                         {"pbrMetallicRoughness",
                          {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                           {"metallicFactor", 0.25},
                           {"roughnessFactor", 0.75}}},
                         {"extensions",
                          {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
                           {"KHR_materials_ior", {{"ior", 1.25}}},
                           {"KHR_materials_specular",
                            {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0, 0.5}}}},
                           {"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
                           {"KHR_materials_unlit", json::object()}}}});
  file.show_triangle();
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.materials.size(), 2u);
  const Material &plain = scene.materials[0], &rich = scene.materials[1];
  EXPECT_EQ(plain.metallic, 1) << "glTF's default";
  EXPECT_EQ(plain.roughness, 1);
  EXPECT_EQ(plain.ior, 1.5f);
  EXPECT_FALSE(plain.double_sided);
  EXPECT_TRUE(rich.double_sided);
  EXPECT_TRUE(rich.unlit);
  EXPECT_EQ(rich.base_color.w, 0.4f);
  EXPECT_EQ(rich.metallic, 0.25f);
  EXPECT_EQ(rich.roughness, 0.75f);
  EXPECT_EQ(rich.emission.y, 2);
  EXPECT_EQ(rich.transmission, 0.5f);
  EXPECT_EQ(rich.ior, 1.25f);
  EXPECT_EQ(rich.specular, 0.5f);
  EXPECT_EQ(rich.specular_color.z, 0.5f);
  EXPECT_TRUE(scene.meshes[0].materials.empty()) << "no material: Material{}";
}

TEST_F(GltfMaterials, ReadsSpecularGlossinessWhereThereIsNoOtherModel) {
  constexpr const char* kGloss = "KHR_materials_pbrSpecularGlossiness";
  const json gloss = {{"diffuseFactor", {0.5, 0.25, 1, 0.75}},
                      {"specularFactor", {0.25, 0.5, 0}},
                      {"glossinessFactor", 0.75}};
  GltfFile file;
  file.show_triangle();
  file.json["extensionsRequired"] = file.json["extensionsUsed"] = {kGloss};
  file.add("materials", {{"extensions", {{kGloss, gloss}}}});
  file.add("materials", {{"extensions", {{kGloss, json::object()}}}});
  file.add("materials", {{"extensions", {{kGloss, gloss}}},
                         {"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}});
  SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_TRUE(scene.warnings.empty());
  const Material &some = scene.materials[0], &whole = scene.materials[1];
  EXPECT_EQ(some.metallic, 0);
  EXPECT_EQ(some.roughness, 0.25f);
  EXPECT_EQ(some.ior, 0);
  EXPECT_EQ(some.specular_color.y, 0.5f);
  EXPECT_EQ(some.base_color.x, 0.25f) << "half of the light is reflected before it";
  EXPECT_EQ(some.base_color.w, 0.75f);
  EXPECT_EQ(whole.base_color.x, 0) << "a mirror, by the extension's defaults";
  EXPECT_EQ(whole.roughness, 0);
  EXPECT_EQ(scene.materials[2].metallic, 0.5f);
  EXPECT_EQ(scene.materials[2].ior, 1.5f);

  write_png({"small", 1, 1, {255, 0, 0, 255}}, path("a.png"));
  file.add("images", {{"uri", "a.png"}});
  file.add("textures", {{"source", 0}});
  for (const char* texture : {"diffuseTexture", "specularGlossinessTexture"})
    file.json["materials"][0]["extensions"][kGloss][texture] = {{"index", 0}};
  scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, 0u);
  EXPECT_EQ(scene.materials[0].roughness, 1);
  EXPECT_EQ(scene.materials[0].base_color.x, 0.5f);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("Specular-glossiness textures"), std::string::npos);
}

TEST_F(GltfMaterials, GlassIsThinUnlessItHasAThickness) {
  const json sheet = {{"transmissionFactor", 1}};
  struct Case {
    json extensions;
    bool thin;
  };
  const Case cases[] = {
      {{{"KHR_materials_transmission", sheet}}, true},
      {{{"KHR_materials_transmission", sheet}, {"KHR_materials_volume", json::object()}}, true},
      {{{"KHR_materials_transmission", sheet}, {"KHR_materials_volume", {{"thicknessFactor", 0}}}},
       true},
      {{{"KHR_materials_transmission", sheet},
        {"KHR_materials_volume", {{"thicknessFactor", 1e-3}}}},
       false},
      {{{"KHR_materials_ior", {{"ior", 1.25}}}}, false}};
  GltfFile file;
  file.show_triangle();
  file.json["extensionsRequired"] =
      file.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_volume"};
  for (const Case& one : cases) file.add("materials", {{"extensions", one.extensions}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.materials.size(), std::size(cases));
  for (std::size_t i = 0; i < std::size(cases); ++i)
    EXPECT_EQ(scene.materials[i].thin, cases[i].thin) << cases[i].extensions;
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(GltfMaterials, SaysThatTheAttenuationOfGlassIsLeftOut) {
  const auto warnings_of = [&](const json& volume) {
    GltfFile file;
    file.show_triangle();
    file.add(
        "materials",
        {{"extensions",
          {{"KHR_materials_transmission", json::object()}, {"KHR_materials_volume", volume}}}});
    return load_scene(write("a.gltf", file.text()));
  };
  json volume = {{"thicknessFactor", 1}, {"attenuationDistance", 2}};
  EXPECT_TRUE(warnings_of(volume).warnings.empty()) << "white";
  volume["attenuationColor"] = {1, 0.5, 1};
  EXPECT_TRUE(warns(warnings_of(volume), "attenuation"));
  volume["thicknessTexture"] = {{"index", 0}};
  EXPECT_TRUE(warns(warnings_of(volume), "Thickness textures"));
  volume["thicknessFactor"] = 0;
  EXPECT_TRUE(warnings_of(volume).warnings.empty()) << "thin surfaces have no interior";
}

TEST_F(GltfMaterials, ReadsWhatMasksCutAway) {
  GltfFile file;
  file.show_triangle();
  file.add("materials", {{"alphaMode", "MASK"}});
  file.add("materials", {{"alphaMode", "MASK"}, {"alphaCutoff", 0.25}});
  file.add("materials", {{"alphaMode", "OPAQUE"}, {"alphaCutoff", 0.25}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.materials.size(), 3u);
  EXPECT_EQ(scene.materials[0].alpha_cutoff, 0.5f);
  EXPECT_EQ(scene.materials[1].alpha_cutoff, 0.25f);
  EXPECT_EQ(scene.materials[2].alpha_cutoff, 0);
  EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace raysheaf::test
