// Nodes, lights, cameras, textures and files of glTF.
#include <cmath>
#include <numbers>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using GltfScene = IoTest;

constexpr double kHalfAngle = std::numbers::sqrt2 / 2;

/// A PNG of 2 x 1 pixels, red and green.
Bytes small_png(const std::string& path) {
  write_png({"small", 2, 1, {255, 0, 0, 255, 0, 255, 0, 255}}, path);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(GltfScene, ComposesTheTransformsOfItsNodes) {
  GltfFile file;
  file.show_triangle();
  file.roots.clear();
  // Turns by 90 degrees about z after scaling x; the parent moves and doubles.
  file.json["nodes"][0].update(
      json{{"rotation", {0, 0, kHalfAngle, kHalfAngle}}, {"scale", {3, 1, 1}}});
  file.node({{"children", {0}}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.instances.size(), 1u);
  const Affine& m = scene.instances[0].to_world;
  const float expected[3][4] = {{0, -2, 0, 10}, {6, 0, 0, 20}, {0, 0, 2, 30}};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(m.m[r][c], expected[r][c], 1e-5);
  }
}

TEST_F(GltfScene, ShowsAMeshAtEveryPlaceOfItsNode) {
  constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
  GltfFile file;
  file.show_triangle();
  file.json["extensionsRequired"] = file.json["extensionsUsed"] = {kInstancing};
  const std::vector<std::int16_t> turns = {0, 0, 0, 32767, 0, 0, 32767, 0};
  json& attributes = file.json["nodes"][0]["extensions"][kInstancing]["attributes"];
  attributes["TRANSLATION"] = file.positions({1, 0, 0, 0, 2, 0});
  attributes["SCALE"] = file.positions({1, 1, 1, 3, 3, 3});
  attributes["ROTATION"] = file.accessor(turns, "VEC4", 5122, 4, true);
  attributes["_ID"] = file.accessor(std::vector<float>{7, 8}, "SCALAR", 5126, 1);
  file.json["nodes"][0].update(json{{"name", "tree"}, {"translation", {0, 0, 5}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.instances.size(), 2u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const float expected[2][3][4] = {{{1, 0, 0, 1}, {0, 1, 0, 0}, {0, 0, 1, 5}},
                                   {{-3, 0, 0, 0}, {0, -3, 0, 2}, {0, 0, 3, 5}}};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(scene.instances[i].name, "tree");
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_NEAR(scene.instances[i].to_world.m[r][c], expected[i][r][c], 1e-5) << i << r << c;
    }
  }
  const std::string place = std::string("nodes[0].extensions.") + kInstancing + ".attributes";
  attributes["SCALE"] = file.positions({1, 1, 1});
  expect_refused(write("b.gltf", file.text()), ErrorCode::kInvalidData, {place, "has 1 elements"});
  attributes["SCALE"] = attributes["ROTATION"];
  expect_refused(write("c.gltf", file.text()), ErrorCode::kInvalidData, {place + ".SCALE"});
  attributes.erase("SCALE");
  attributes["ROTATION"] =
      file.accessor(std::vector<std::int16_t>{0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 5122, 4, true);
  expect_refused(write("d.gltf", file.text()), ErrorCode::kInvalidData,
                 {place + ".ROTATION[1]", "no length"});
  attributes = json::object();
  expect_refused(write("e.gltf", file.text()), ErrorCode::kInvalidData, {place, "no attribute"});
}

// A chain with many nodes below its end, all of which the scene lists: once without the chain, and
// once with its other end.
TEST_F(GltfScene, ShowsManyNodesThatItNamesWithoutTheirParents) {
  constexpr std::size_t kNodes = 2000;
  GltfFile file;
  file.show_triangle();
  file.roots.clear();
  json leaves = json::array();
  for (std::size_t n = 0; n < kNodes; ++n) leaves.push_back(file.add("nodes", {{"mesh", 0}}));
  file.roots = leaves.get<std::vector<std::size_t>>();
  std::size_t top = file.add("nodes", {{"children", leaves}, {"translation", {5, 0, 0}}});
  for (std::size_t n = 0; n < kNodes; ++n) top = file.add("nodes", {{"children", {top}}});
  for (const bool whole : {false, true}) {
    if (whole) file.roots.push_back(top);
    const SceneDescription scene = load_scene(write("a.gltf", file.text()));
    ASSERT_EQ(scene.instances.size(), kNodes);
    for (const Instance& instance : scene.instances)
      ASSERT_EQ(instance.to_world.m[0][3], whole ? 5 : 0);
    EXPECT_TRUE(warns(scene, whole ? "once" : "without"));
  }
}

TEST_F(GltfScene, ShowsNodesThatItNamesWithoutTheirParents) {
  GltfFile file;
  file.show_triangle();  // nodes[0]
  file.roots = {0};
  file.add("nodes", {{"children", {0}}, {"translation", {5, 0, 0}}});
  file.add("nodes", {{"children", {1}}});
  SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].to_world.m[0][3], 0);
  EXPECT_TRUE(warns(scene, "without"));
  for (const auto& both : {std::vector<std::size_t>{0, 2}, std::vector<std::size_t>{2, 0}}) {
    file.roots = both;
    scene = load_scene(write("a.gltf", file.text()));
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].to_world.m[0][3], 5);
    EXPECT_TRUE(warns(scene, "once"));
  }
}

TEST_F(GltfScene, ShowsTheDefaultSceneAlone) {
  GltfFile file;
  file.show_triangle();
  file.node({{"mesh", 0}, {"name", "second"}});
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.json["scene"] = 1;
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].name, "second");
  // Without a list of scenes, every root is shown.
  file.json.erase("scenes");
  file.json.erase("scene");
  file.roots.clear();
  EXPECT_EQ(load_scene(write("b.gltf", file.text())).instances.size(), 2u);
}

TEST_F(GltfScene, ReadsLights) {
  GltfFile file;
  file.show_triangle();
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 4}, {"range", 7}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
      {{"type", "directional"}, {"name", "sun"}}};
  for (int light = 0; light < 3; ++light) {
    file.node({{"translation", {1, 2, 3}},
               {"scale", {2, 2, 2}},
               {"rotation", {-kHalfAngle, 0, 0, kHalfAngle}},
               {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.lights.size(), 3u);
  const Light &point = scene.lights[0], &spot = scene.lights[1], &sun = scene.lights[2];
  EXPECT_EQ(point.type, Light::Type::kPoint);
  EXPECT_EQ(point.position.y, 2);
  EXPECT_EQ(point.intensity.x, 4);
  EXPECT_EQ(point.intensity.y, 2);
  EXPECT_EQ(point.range, 7);
  EXPECT_EQ(spot.type, Light::Type::kSpot);
  EXPECT_FLOAT_EQ(spot.outer_angle, 0.2f);
  EXPECT_FLOAT_EQ(spot.inner_angle, 0.1f);
  EXPECT_TRUE(std::isinf(spot.range));
  EXPECT_EQ(sun.type, Light::Type::kDirectional);
  EXPECT_EQ(sun.name, "sun");
  // -z, turned by -90 degrees about x, points down.
  EXPECT_NEAR(sun.direction.y, -1, 1e-6);
  EXPECT_NEAR(sun.direction.z, 0, 1e-6);
}

TEST_F(GltfScene, ReadsCamerasWithoutTheScaleOfTheirNodes) {
  GltfFile file;
  file.show_triangle();
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  file.add("cameras", {{"type", "orthographic"},
                       {"name", "flat"},
                       {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}});
  file.node({{"camera", 0},
             {"name", "eye"},
             {"translation", {4, 5, 6}},
             {"rotation", {0.1, 0.2, 0.3, 0.9}},
             {"scale", {2, 3, -4}}});
  file.node({{"camera", 1}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.cameras.size(), 2u);
  const Camera& eye = scene.cameras[0];
  EXPECT_EQ(eye.name, "eye");
  EXPECT_FLOAT_EQ(eye.y_fov, 0.5f);
  EXPECT_FLOAT_EQ(eye.z_near, 0.1f);
  EXPECT_TRUE(std::isinf(eye.z_far));
  EXPECT_EQ(eye.to_world.m[1][3], 5);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      double sum = 0;
      for (std::size_t r = 0; r < 3; ++r) sum += eye.to_world.m[r][a] * eye.to_world.m[r][b];
      EXPECT_NEAR(sum, a == b ? 1 : 0, 1e-6);
    }
  }
  EXPECT_TRUE(scene.cameras[1].orthographic);
  EXPECT_EQ(scene.cameras[1].y_mag, 2);
  EXPECT_EQ(scene.cameras[1].z_far, 9);
}

TEST_F(GltfScene, ReadsImagesFromEverywhere) {
  const Bytes png = small_png(path("ex ternal.png"));
  GltfFile file;
  file.show_triangle();
  const std::size_t view = file.view(png);
  file.add("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "packed"}});
  file.add("images", {{"uri", "data:image/png;base64," + base64(png)}});
  file.add("images", {{"uri", "ex%20ternal.png"}});
  file.add("images", {{"uri", "data:image/png;base64,bm8gcGljdHVyZQ=="}});
  file.add("samplers",
           {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}});
  file.add("textures", {{"source", 0}, {"sampler", 0}});
  for (int image : {1, 2, 3}) file.add("textures", {{"source", image}});
  const json transform = {{"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 0.125}};
  file.add("materials", {{"pbrMetallicRoughness",
                          {{"baseColorTexture",
                            {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}},
                           {"metallicRoughnessTexture", {{"index", 2}}}}},
                         {"emissiveTexture", {{"index", 3}}},
                         {"normalTexture", {{"index", 1}, {"scale", 0.5}}}});
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  ASSERT_EQ(scene.images.size(), 3u);
  for (const Image& image : scene.images) {
    EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255}));
  }
  EXPECT_EQ(scene.images[0].name, "packed");
  ASSERT_EQ(scene.textures.size(), 3u);
  EXPECT_EQ(scene.textures[0].wrap_u, Wrap::kClampToEdge);
  EXPECT_EQ(scene.textures[0].wrap_v, Wrap::kMirroredRepeat);
  EXPECT_EQ(scene.textures[0].filter, Filter::kNearest);
  EXPECT_EQ(scene.textures[1].filter, Filter::kLinear);
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.base_color_texture.texture, 0u);
  EXPECT_EQ(material.base_color_texture.offset.y, 0.25f);
  EXPECT_EQ(material.base_color_texture.scale.y, 3);
  EXPECT_EQ(material.base_color_texture.rotation, 0.125f);
  EXPECT_EQ(material.metallic_roughness_texture.texture, 2u);
  EXPECT_EQ(material.emission_texture.texture, kInvalidId);
  EXPECT_EQ(material.normal_texture.texture, 1u);
  EXPECT_EQ(material.normal_scale, 0.5f);
  EXPECT_TRUE(warns(scene, "images[3] is truncated or not an image"));
}

// The bytes determine an image's format, whatever its URI says; and an image that only an extension
// uses does not affect the others.
TEST_F(GltfScene, ReadsImagesOfAnyKindOfUri) {
  const std::string png = base64(small_png(path("small.png")));
  for (const char* kind :
       {"image/jpg", "IMAGE/PNG", "image/png;charset=utf-8", "", "image/x-any"}) {
    GltfFile file;
    file.show_triangle();
    file.add("images", {{"uri", std::string("data:") + kind + ";base64," + png}});
    for (const char* uri : {"data:image/webp;base64,UklGRjEyMzRXRUJQ", "data:image/svg+xml,<svg/>"})
      file.add("images", {{"uri", uri}});
    file.add("textures", {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    file.json["extensionsUsed"] = {"EXT_texture_webp"};
    const SceneDescription scene = load_scene(write("a.gltf", file.text()));
    EXPECT_EQ(scene.images.size(), 1u) << kind;
    EXPECT_EQ(scene.textures.size(), 1u) << kind;
    EXPECT_TRUE(warns(scene, "images[1] is truncated or not an image"));
    EXPECT_TRUE(warns(scene, "images[2] is an SVG image"));
  }
}

TEST_F(GltfScene, ReadsBuffersOfAnyLengthAndSpelling) {
  GltfFile file;
  file.show_triangle();
  file.json["buffers"][0]["byteLength"] = file.buffer.size();
  file.json["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 0}});  // unused
  Bytes longer = file.buffer;
  longer.insert(longer.end(), 5, 0);
  const std::string data = base64(longer);
  std::string escaped;
  for (const std::uint8_t byte : longer) {
    constexpr const char* kDigits = "0123456789aBcDeF";
    escaped += {'%', kDigits[byte / 16], kDigits[byte % 16]};
  }
  std::string escaped_digits;
  for (const char c : data) escaped_digits += c == '=' ? std::string("%3D") : std::string(1, c);
  for (const std::string& uri :
       {"data:application/octet-stream;base64," + data,
        "data:Application/Octet-Stream;charset=binary;base64," + data,
        "data:application/gltf-buffer;base64," + data, "data:;base64," + data,
        "DATA:;BASE64," + data, "data:video/mp4;base64," + escaped_digits, "data:," + escaped,
        "data:text/plain;charset=x," + escaped})
    EXPECT_EQ(load_scene(write("a.gltf", file.text(uri))).triangle_count(), 1u) << uri;
  expect_refused(write("b.gltf", file.text("data:;base64")), ErrorCode::kInvalidData,
                 {"buffers[0].uri", "comma"});
  expect_refused(write("c.gltf", file.text("data:text/plain,hello")), ErrorCode::kInvalidData,
                 {"buffers[0].uri", "has 5 bytes", "needs 36"});
  expect_refused(write("c.gltf", file.text("data:,%2")), ErrorCode::kInvalidData,
                 {"buffers[0].uri"});
  file.json["buffers"][0]["byteLength"] = longer.size() + 1;
  expect_refused(write("d.gltf", file.text("data:text/plain;base64," + data)),
                 ErrorCode::kInvalidData, {"buffers[0].uri", "41 bytes", "needs 42"});
  file.json["buffers"][0]["byteLength"] = file.buffer.size();
  file.json["accessors"][0]["bufferView"] = file.json["bufferViews"].size() - 1;
  expect_refused(write("e.gltf", file.text()), ErrorCode::kInvalidData,
                 {"accessors[0]", "do not fit into the 0 bytes"});
  file.json["accessors"][0]["bufferView"] = 0;
  file.add("images",
           {{"bufferView", file.json["bufferViews"].size() - 1}, {"mimeType", "image/png"}});
  EXPECT_EQ(load_scene(write("f.gltf", file.text())).triangle_count(), 1u);
}

TEST_F(GltfScene, ReadsChunksThatFollowAtOnce) {
  GltfFile file;
  file.show_triangle();
  for (std::size_t beyond = 0; beyond < 4; ++beyond) {
    const SceneDescription scene = load_scene(write("a.glb", file.glb(beyond)));
    EXPECT_EQ(scene.meshes[0].positions[1].x, 1) << beyond;
    EXPECT_EQ(scene.meshes[0].positions[2].y, 1) << beyond;
  }
}

TEST_F(GltfScene, WarnsOncePerKindOfWhatIsLeftOut) {
  GltfFile file;
  file.show_triangle();
  for (int i = 0; i < 3; ++i)
    file.add("materials", {{"alphaMode", "BLEND"},
                           {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}});
  file.json["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_lights_punctual",
                                 "KHR_materials_clearcoat"};
  const SceneDescription scene = load_scene(write("a.gltf", file.text()));
  EXPECT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(warns(scene, "KHR_materials_clearcoat"));
  EXPECT_TRUE(warns(scene, "BLEND"));
  EXPECT_TRUE(scene.materials[0].alpha_blend);
  EXPECT_EQ(scene.materials[0].alpha_cutoff, 0);
}

TEST_F(GltfScene, SurvivesADeepChainOfNodes) {
  GltfFile file;
  file.show_triangle();
  file.roots.clear();
  constexpr int kDepth = 20000;
  for (int i = 0; i < kDepth; ++i) file.add("nodes", {{"children", {i}}});
  file.roots = {kDepth};
  EXPECT_EQ(load_scene(write("a.gltf", file.text())).instances.size(), 1u);
}

}  // namespace
}  // namespace raysheaf::test
