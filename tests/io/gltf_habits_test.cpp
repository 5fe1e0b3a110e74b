// glTF as exporters and people write it: second texture coordinates, alpha, aspect ratios of
// cameras, and files that are not glTF.
#include <array>

#include "raysheaf/animation.h"
#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using GltfHabits = IoTest;

TEST_F(GltfHabits, KeepsTheAlphaOfColoursWhereItCounts) {
  for (const char* mode : {"OPAQUE", "MASK", "BLEND"}) {
    for (const std::uint8_t alpha : {std::uint8_t{51}, std::uint8_t{255}}) {
      GltfFile file;
      const std::vector<std::uint8_t> colors = {9, 9, 9, 255, 9, 9, 9, alpha, 9, 9, 9, 255};
      const json attributes = {{"POSITION", file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
                               {"COLOR_0", file.accessor(colors, "VEC4", 5121, 4, true)}};
      file.add("materials", json::object());
      file.add("materials", {{"alphaMode", mode}});
      file.add("meshes", {{"primitives",
                           {{{"attributes", attributes}, {"material", 0}},
                            {{"attributes", attributes}, {"material", 1}}}}});
      file.node({{"mesh", 0}});
      const SceneDescription scene = load_scene(write("a.gltf", file.text()));
      const bool counts = alpha < 255 && std::string(mode) != "OPAQUE";
      const Mesh& mesh = scene.meshes[0];
      EXPECT_FALSE(warns(scene, "alpha")) << mode << int{alpha};
      ASSERT_EQ(mesh.alphas.size(), counts ? mesh.positions.size() : 0) << mode << int{alpha};
      if (!counts) continue;
      EXPECT_EQ(mesh.alphas[mesh.triangles[0][1]], 1) << "opaque materials ignore it";
      EXPECT_EQ(mesh.alphas[mesh.triangles[1][1]], 0.2f);
      save_glb(scene, path("b.glb"));
      const SceneDescription again = load_scene(path("b.glb"));
      EXPECT_EQ(again.meshes[0].alphas[again.meshes[0].triangles[1][1]], 0.2f);
    }
  }
}

TEST_F(GltfHabits, ReadsTwoSetsOfTextureCoordinates) {
  GltfFile file;
  const json attributes = {
      {"POSITION", file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
      {"TEXCOORD_0", file.accessor(std::vector<float>{0, 0, 0, 0, 0, 0}, "VEC2", 5126, 2)},
      {"TEXCOORD_1", file.accessor(std::vector<float>{1, 0, 2, 0, 3, 0}, "VEC2", 5126, 2)},
      {"TEXCOORD_3", file.accessor(std::vector<float>{4, 0, 5, 0, 6, 0}, "VEC2", 5126, 2)}};
  file.show({{"attributes", attributes}, {"material", 0}});
  file.add("images", {{"uri", "none.png"}});
  file.add("textures", {{"source", 0}});
  file.add("materials", {{"pbrMetallicRoughness",
                          {{"baseColorTexture", {{"index", 0}, {"texCoord", 3}}},
                           {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}},
                         {"emissiveTexture", {{"index", 0}, {"texCoord", 3}}},
                         {"normalTexture",
                          {{"index", 0},
                           {"texCoord", 0},
                           {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}}}});
  SceneDescription scene = load_scene(write("a.gltf", file.text()));
  const Material& m = scene.materials[0];
  EXPECT_FALSE(m.base_color_texture.second_uvs);
  EXPECT_TRUE(m.metallic_roughness_texture.second_uvs);
  EXPECT_FALSE(m.emission_texture.second_uvs);
  EXPECT_TRUE(m.normal_texture.second_uvs);
  ASSERT_EQ(scene.meshes[0].second_uvs.size(), 3u);
  EXPECT_EQ(scene.meshes[0].uvs[2].x, 6);
  EXPECT_EQ(scene.meshes[0].second_uvs[2].x, 3);
  EXPECT_FALSE(warns(scene, "third set"));
  file.json["materials"][0]["emissiveTexture"]["texCoord"] = 0;
  EXPECT_TRUE(warns(load_scene(write("b.gltf", file.text())), "third set"));
  save_glb(scene, path("c.glb"));
  EXPECT_EQ(load_scene(path("c.glb")).meshes[0].uvs[2].x, 6);
}

TEST_F(GltfHabits, HiddenNodesShowOnlyTheirCameras) {
  const json attributes = {{"attributes", {{"POSITION", 0}}}};
  const auto loaded = [&](const char* list, const json& child, const json& parent) {
    GltfFile file;
    file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    file.add("meshes", {{"primitives", {attributes}}});
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    json hidden = {{"mesh", 0}, {"camera", 0}};
    hidden["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
    if (!child.is_null()) hidden["extensions"]["KHR_node_visibility"] = child;
    const std::size_t index = file.add("nodes", hidden);
    json above = {{"children", {index}}, {"mesh", 0}};
    if (!parent.is_null()) above["extensions"]["KHR_node_visibility"] = parent;
    file.node(above);
    file.node({{"mesh", 0}});
    file.json[list] = {"KHR_node_visibility"};
    return load_scene(write("a.gltf", file.text()));
  };
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    const auto counts = [&](const json& child, const json& parent) {
      const SceneDescription scene = loaded(list, child, parent);
      EXPECT_TRUE(scene.warnings.empty());
      return std::array{scene.instances.size(), scene.lights.size(), scene.cameras.size()};
    };
    using Counts = std::array<std::size_t, 3>;
    const json shown = {{"visible", true}}, hidden = {{"visible", false}};
    EXPECT_EQ(counts({}, {}), (Counts{3, 1, 1}));
    EXPECT_EQ(counts(hidden, {}), (Counts{2, 0, 1}));
    EXPECT_EQ(counts(shown, hidden), (Counts{1, 0, 1})) << "children are hidden, too";
    EXPECT_EQ(counts(json::object(), shown), (Counts{3, 1, 1}));
    EXPECT_THROW((void)loaded(list, {{"visible", 0}}, {}), Error);
  }
}

TEST_F(GltfHabits, AnimationsByPointersAreLeftOutWithAWarning) {
  GltfFile file;
  file.show_triangle();
  const std::size_t times = file.accessor(std::vector<float>{0, 1}, "SCALAR", 5126, 1);
  const std::size_t values = file.accessor(std::vector<std::uint8_t>{0, 1}, "SCALAR", 5121, 1);
  const json pointer = {{"pointer", "/nodes/0/extensions/KHR_node_visibility/visible"}};
  file.add("animations",
           {{"samplers", {{{"input", times}, {"output", values}}}},
            {"channels",
             {{{"sampler", 0},
               {"target",
                {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", pointer}}}}}}}}});
  file.json["extensionsRequired"] = {"KHR_animation_pointer"};
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "KHR_animation_pointer"));
}

TEST_F(GltfHabits, AcceptsRequiredExtensionsThatChangeNothing) {
  for (const char* name : {"KHR_materials_variants", "KHR_xmp_json_ld"}) {
    GltfFile file;
    file.show_triangle();
    file.json["extensionsRequired"] = {name};
    EXPECT_TRUE(warns(load_scene(write("a.gltf", file.text())), name));
  }
  for (const char* name : {"KHR_materials_sheen", "VENDOR_unknown"}) {
    GltfFile file;
    file.show_triangle();
    file.json["extensionsRequired"] = {name};
    try {
      static_cast<void>(load_scene(write("a.gltf", file.text())));
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_NE(error.sentence().find(name), std::string::npos) << error.what();
    }
  }
}

TEST_F(GltfHabits, ReadsTheShapeOfCameras) {
  GltfFile file;
  file.show_triangle();
  file.add("cameras", {{"type", "perspective"},
                       {"perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", 2.5}}}});
  file.add("cameras", {{"type", "orthographic"},
                       {"orthographic", {{"xmag", 1}, {"ymag", 4}, {"znear", 1}, {"zfar", 9}}}});
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}});
  for (int i = 0; i < 3; ++i) file.node({{"camera", i}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  save_glb(scene, path("b.glb"));
  for (const SceneDescription& s : {scene, load_scene(path("b.glb"))}) {
    EXPECT_EQ(s.cameras[0].aspect_ratio, 2.5f);
    EXPECT_EQ(s.cameras[1].aspect_ratio, 0.25f);
    EXPECT_EQ(s.cameras[2].aspect_ratio, 0);
  }
}

TEST_F(GltfHabits, ReadsBackslashesAsSlashes) {
  GltfFile file;
  file.show_triangle();
  const std::string data(file.buffer.begin(), file.buffer.end());
  write("parts/a.bin", data);
  const SceneDescription scene = load_scene(write("a.gltf", file.text("parts\\a.bin")));
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_TRUE(warns(scene, "\"parts\\a.bin\" is not a valid URI"));
  write("parts\\a.bin", data);
  EXPECT_TRUE(load_scene(path("a.gltf")).warnings.empty()) << "a file is called so";
  expect_refused(write("b.gltf", file.text("..\\a.bin")), ErrorCode::kUnsupported, {"folder"});
}

TEST_F(GltfHabits, NamesTheFormatOfFilesThatAreNotGltf) {
  const auto is = [&](const char* name, const std::string& text, const std::string& kind) {
    expect_refused(write(name, text), ErrorCode::kInvalidData, {kind});
  };
  is("a.glb", "PK\x03\x04 and so on", "not a GLB file, but a ZIP archive");
  is("b.glb", "<!DOCTYPE html>", "a web page");
  is("c.glb", "hello", "not a GLB file: it begins neither");
  is("d.gltf", std::string("\xff\xfe{\0\"\0", 6), "UTF-16");
  is("e.gltf", std::string("{\0\"\0a\0", 6), "UTF-16");
  is("f.glb", std::string(64, '\0'), "zeros");
  is("g.gltf", "{\"asset\":", "JSON");
}

TEST_F(GltfHabits, MessagesAreUtf8) {
  GltfFile file;
  file.show_triangle();
  for (const std::string& broken :
       {std::string("{\"asset\": \xff}"), std::string("{\"\xc3("), std::string("\xe9t\xe9"),
        std::string("{\"asset\": {\"version\": \"\xed\xa0\x80\"}}")}) {
    try {
      static_cast<void>(load_scene(write("\xe4.gltf", broken)));
      ADD_FAILURE() << "was read";
    } catch (const Error& error) {
      EXPECT_NO_THROW(static_cast<void>(json(error.what()).dump())) << "is not UTF-8";
    }
  }
}

TEST_F(GltfHabits, SaysHowToConvertKtxTextures) {
  GltfFile file;
  file.show_triangle();
  file.json["extensionsUsed"] = {"KHR_texture_basisu"};
  EXPECT_TRUE(warns(load_scene(write("a.gltf", file.text())), "gltf-transform ktxdecompress"));
  file.json["extensionsRequired"] = {"KHR_texture_basisu"};
  expect_refused(write("b.gltf", file.text()), ErrorCode::kUnsupported,
                 {"KHR_texture_basisu", "gltf-transform ktxdecompress"});
}

TEST_F(GltfHabits, WarnsWhereFloatsAreTooFarApart) {
  GltfFile file;
  file.show_triangle();
  file.json["nodes"][0]["translation"] = {5e5, 0, 0};
  const SceneDescription far = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(far.warnings.size(), 1u);
  EXPECT_TRUE(warns(far, "0.03125 apart"));
  EXPECT_TRUE(warns(load_animation(path("a.gltf"))->scene(), "0.03125 apart"));
  file.json["nodes"][0]["translation"] = {5e3, 0, 0};
  EXPECT_TRUE(load_scene(write("b.gltf", file.text())).warnings.empty());
}

}  // namespace
}  // namespace raysheaf::test
