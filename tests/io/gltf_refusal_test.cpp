// Errors in glTF files name their place.
#include <limits>
#include <tuple>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;
using enum ErrorCode;
using GltfRefusal = IoTest;

class GltfBroken : public IoTest {
 protected:
  GltfBroken() { file_.show_triangle(); }

  void expect(ErrorCode code, const std::vector<std::string>& words) {
    expect_refused(write("broken.gltf", file_.text()), code, words);
  }
  GltfFile file_;
};

TEST_F(GltfBroken, IndexOutOfRange) {
  std::vector<std::uint16_t> indices(18, 2);
  indices[17] = 3;
  const std::size_t accessor = file_.accessor(indices, "SCALAR", 5123, 1);
  file_.json["meshes"][0]["primitives"][0]["indices"] = accessor;
  expect(kInvalidData, {"meshes[0].primitives[0].indices[17]", "index 3", "3 vertices"});
}
TEST_F(GltfBroken, VertexThatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  file_.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      file_.positions({0, 0, 0, 1, 0, 0, 0, nan, 0});
  expect(kInvalidData, {"meshes[0].primitives[0].attributes.POSITION[2]", "not finite"});
}
TEST_F(GltfBroken, AccessorBeyondItsView) {
  file_.json["accessors"][0]["count"] = 4;
  expect(kInvalidData, {"accessors[0]", "4 elements of 12 bytes", "36 bytes of bufferViews[0]"});
}
TEST_F(GltfBroken, AccessorOfAbsurdSize) {
  file_.json["accessors"][0]["count"] = 9007199254740992;
  expect(kInvalidData, {"accessors[0]"});
  file_.json["accessors"][0]["byteOffset"] = 9007199254740992;
  expect(kInvalidData, {"accessors[0]"});
  file_.json["accessors"][0]["count"] = 1e300;
  expect(kInvalidData, {"accessors[0].count", "not an integer"});
}
TEST_F(GltfBroken, ViewBeyondItsBuffer) {
  file_.json["bufferViews"][0]["byteOffset"] = 8;
  expect(kInvalidData, {"bufferViews[0]", "44", "36 bytes"});
}
TEST_F(GltfBroken, StrideSmallerThanAnElement) {
  file_.json["bufferViews"][0]["byteStride"] = 8;
  expect(kInvalidData, {"bufferViews[0].byteStride", "12 bytes"});
}
TEST_F(GltfBroken, NegativeIndex) {
  file_.json["nodes"][0]["mesh"] = -1;
  expect(kInvalidData, {"nodes[0].mesh", "-1"});
}
TEST_F(GltfBroken, WrongTypes) {
  const std::vector<std::pair<std::string, json>> kCases = {{"/nodes/0/mesh", "zero"},
                                                            {"/nodes/0/matrix", {1, 2, 3}},
                                                            {"/nodes/0/children", 3},
                                                            {"/nodes/0/translation", {1, "2", 3}},
                                                            {"/meshes/0/primitives", 1},
                                                            {"/accessors/0/type", 3},
                                                            {"/accessors/0/componentType", 9},
                                                            {"/bufferViews/0/buffer", 2.5},
                                                            {"/asset", 2},
                                                            {"/meshes", json::object()},
                                                            {"/nodes/0", 7},
                                                            {"/accessors/0/sparse", {1}}};
  for (const auto& [pointer, value] : kCases) {
    const json before = file_.json;
    file_.json[json::json_pointer(pointer)] = value;
    SCOPED_TRACE(pointer);
    expect(kInvalidData, {});
    file_.json = before;
  }
}
TEST_F(GltfBroken, Cycles) {
  file_.add("nodes", {{"children", {2}}});
  file_.add("nodes", {{"children", {1}}});
  expect(kInvalidData, {"nodes[", "own ancestor"});
}
TEST_F(GltfBroken, TwoParents) {
  file_.node({{"children", {0}}});
  file_.node({{"children", {0}}});
  expect(kInvalidData, {"nodes[0]", "two parents, nodes[1] and nodes[2]"});
}
TEST_F(GltfBroken, RequiredExtension) {
  file_.json["extensionsRequired"] = {"KHR_texture_basisu"};
  expect(kUnsupported, {"KHR_texture_basisu"});
}
TEST_F(GltfBroken, Version) {
  file_.json["asset"]["version"] = "1.0";
  expect(kUnsupported, {"asset.version", "1.0"});
}
TEST_F(GltfBroken, UrisThatLeaveTheFolder) {
  write("outside.bin", file_.buffer);
  for (const char* uri : {"../outside.bin", "/etc/passwd", "a/../../outside.bin",
                          "http://example.org/a.bin", "..%2Foutside.bin", "file:outside.bin"}) {
    write("sub/a.gltf", file_.text(uri));
    expect_refused(path("sub/a.gltf"), kUnsupported, {"buffers[0].uri", "folder"});
  }
  file_.add("images", {{"uri", "../a.png"}});
  expect(kUnsupported, {"images[0].uri"});
}
TEST_F(GltfBroken, MissingBuffer) {
  expect_refused(write("a.gltf", file_.text("gone.bin")), kNotFound,
                 {"buffers[0].uri", "gone.bin"});
  write("short.bin", std::string("abc"));
  expect_refused(write("a.gltf", file_.text("short.bin")), kInvalidData, {"3 bytes", "36"});
}
TEST_F(GltfBroken, DataUriWithABadDigit) {
  std::string uri = "data:application/octet-stream;base64," + std::string(48, 'A');
  EXPECT_NO_THROW(static_cast<void>(load_scene(write("a.gltf", file_.text(uri.c_str())))));
  uri[50] = '*';
  expect_refused(write("a.gltf", file_.text(uri.c_str())), kInvalidData,
                 {"buffers[0].uri", "not a base64 digit"});
}
TEST_F(GltfBroken, MorphTargetOutOfRange) {
  file_.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 9}}};
  expect(kInvalidData, {"meshes[0].primitives[0].targets[0].POSITION", "is 9"});
  file_.json["meshes"][0]["primitives"][0]["targets"] = {7};
  expect(kInvalidData, {"meshes[0].primitives[0].targets[0]", "not an object"});
}
TEST_F(GltfBroken, CameraOfUnknownKind) {
  file_.add("cameras", {{"type", "fish-eye"}});
  expect(kInvalidData, {"cameras[0].type", "fish-eye"});
  file_.json["cameras"][0]["type"] = "perspective";
  expect(kInvalidData, {"cameras[0].perspective", "missing"});
}
TEST_F(GltfBroken, AttributesOfUnequalLength) {
  file_.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = file_.positions({0, 0, 1});
  expect(kInvalidData, {"meshes[0].primitives[0].attributes.NORMAL", "1 elements", "3"});
}
TEST_F(GltfBroken, AttributeOfAnotherShape) {
  file_.json["accessors"][0]["type"] = "VEC2";
  expect(kInvalidData, {"attributes.POSITION", "3 numbers"});
}
TEST_F(GltfBroken, SparseIndexOutOfRange) {
  file_.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", file_.view<std::uint8_t>({3})}, {"componentType", 5121}}},
      {"values", {{"bufferView", file_.view<float>({5, 0, 0})}}}};
  expect(kInvalidData, {"attributes.POSITION", "sparse index 0 is 3"});
}
TEST_F(GltfBroken, ManyElementsWithoutBytes) {
  file_.json["accessors"][0] = {{"componentType", 5126}, {"count", 500000000}, {"type", "VEC3"}};
  expect(kOutOfMemory, {"accessors[0].count"});
}
/// A thousand meshes that share one large accessor without bytes would exhaust the memory.
TEST_F(GltfBroken, SharedElementsWithoutBytes) {
  file_.json["accessors"][0] = {{"componentType", 5126}, {"count", 200000}, {"type", "VEC3"}};
  for (std::size_t m = 1; m < 1000; ++m) {
    file_.add("meshes", file_.json["meshes"][0]);
    file_.node({{"mesh", m}});
  }
  expect(kOutOfMemory, {"attributes.POSITION"});
}
TEST_F(GltfBroken, NoTriangles) {
  file_.json["meshes"][0]["primitives"][0]["mode"] = 0;
  expect(kInvalidData, {"triangle"});
}
TEST_F(GltfBroken, LightOfUnknownKind) {
  file_.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}}};
  expect(kInvalidData, {"KHR_lights_punctual.lights[0].spot", "missing"});
  file_.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "area"}}};
  file_.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  expect(kInvalidData, {"KHR_lights_punctual.lights[0].type"});
  file_.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 1;
  expect(kInvalidData, {"nodes[1].extensions.KHR_lights_punctual.light", "1"});
}
TEST_F(GltfBroken, MaterialBeyondItsRange) {
  file_.add("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 2}}}});
  expect(kInvalidData, {"materials[0].pbrMetallicRoughness.metallicFactor", "is 2", "from 0 to 1"});
}

/// Errors use the file's own indices and names, not those of the resulting scene.
TEST_F(GltfBroken, FieldsOfTheFileAreNamed) {
  const json good_camera = {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}};
  file_.json["cameras"] = {good_camera, good_camera};
  file_.node({{"camera", 1}});
  json& lights = file_.json["extensions"]["KHR_lights_punctual"]["lights"];
  lights = {{{"type", "point"}}, {{"type", "spot"}, {"spot", json::object()}}};
  file_.node({{"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  file_.add("materials", {{"name", "first"}});
  file_.add("materials", {{"name", "second"}});
  const json ortho = {{"xmag", 1}, {"ymag", 0}, {"znear", 0}, {"zfar", 1}};
  const std::vector<std::tuple<std::string, json, std::string>> kCases = {
      {"/cameras/1/perspective/yfov", 9, "cameras[1].perspective.yfov"},
      {"/cameras/1/perspective/znear", 0, "cameras[1].perspective.znear"},
      {"/cameras/1/perspective/zfar", 0.5, "cameras[1].perspective.zfar"},
      {"/cameras/1",
       {{"type", "orthographic"}, {"orthographic", ortho}},
       "cameras[1].orthographic.ymag"},
      {"/cameras/1/extras", {{"aperture", -1}}, "cameras[1].extras.aperture"},
      {"/extensions/KHR_lights_punctual/lights/1/spot/outerConeAngle", 2,
       "extensions.KHR_lights_punctual.lights[1].spot.outerConeAngle"},
      {"/extensions/KHR_lights_punctual/lights/1/spot/innerConeAngle", 1,
       "extensions.KHR_lights_punctual.lights[1].spot.innerConeAngle"},
      {"/extensions/KHR_lights_punctual/lights/1/color",
       {1, -1, 1},
       "extensions.KHR_lights_punctual.lights[1].color"},
      {"/extensions/KHR_lights_punctual/lights/1/intensity", -1,
       "extensions.KHR_lights_punctual.lights[1].intensity"},
      {"/extensions/KHR_lights_punctual/lights/1/extras",
       {{"width", 1}},
       "extensions.KHR_lights_punctual.lights[1].extras.height"},
      {"/materials/1/emissiveFactor", {0, 0, -1}, "materials[1].emissiveFactor[2]"},
      {"/materials/1/alphaCutoff", -0.5, "materials[1].alphaCutoff"},
      {"/materials/1/extensions/KHR_materials_emissive_strength/emissiveStrength", -1,
       "materials[1].extensions.KHR_materials_emissive_strength.emissiveStrength"},
      {"/materials/1",
       {{"emissiveFactor", {1, 2, 1e30}},
        {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e30}}}}}},
       "materials[1].extensions.KHR_materials_emissive_strength.emissiveStrength"},
      {"/materials/1/pbrMetallicRoughness/roughnessFactor", -0.5,
       "materials[1].pbrMetallicRoughness.roughnessFactor"},
      {"/materials/1/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", 2,
       "materials[1].extensions.KHR_materials_pbrSpecularGlossiness.glossinessFactor"},
      {"/materials/1/extensions/KHR_materials_volume/thicknessFactor", -1,
       "materials[1].extensions.KHR_materials_volume.thicknessFactor"},
      {"/materials/1/extensions/KHR_materials_ior/ior", 0.5,
       "materials[1].extensions.KHR_materials_ior.ior"}};
  const json before = file_.json;
  EXPECT_NO_THROW(static_cast<void>(load_scene(write("good.gltf", file_.text()))));
  for (const auto& [pointer, value, place] : kCases) {
    file_.json[json::json_pointer(pointer)] = value;
    expect(kInvalidData, {": " + place + ": "});
    file_.json = before;
  }
  file_.json["meshes"].insert(file_.json["meshes"].begin(), file_.json["meshes"][0]);
  file_.json["nodes"][0]["mesh"] = 1;
  file_.json["meshes"][1]["primitives"][0]["attributes"]["POSITION"] =
      file_.positions({0, 0, 0, 0, 3e18f, 0, 0, 0, 0});
  expect(kInvalidData, {"meshes[1].primitives[0].attributes.POSITION[1]", "farther out than 1e18"});
}

TEST_F(GltfRefusal, DeepNesting) {
  const std::string deep(200000, '[');
  expect_refused(write("a.gltf", deep), kInvalidData, {"nested"});
  expect_refused(write("b.gltf", "{\"asset\":{\"version\":\"2.0\",\"extras\":" + deep),
                 kInvalidData, {"nested"});
}
TEST_F(GltfRefusal, TextThatIsNotJson) {
  expect_refused(write("a.gltf", std::string("hello")), kInvalidData, {"not a glTF file"});
  expect_refused(write("b.gltf", std::string("{\"asset\":")), kInvalidData, {"JSON"});
  expect_refused(write("c.gltf", std::string("[]")), kInvalidData, {"object"});
}

TEST_F(GltfRefusal, TruncatedGlb) {
  GltfFile file;
  file.show_triangle();
  const Bytes whole = file.glb();
  for (std::size_t length = 1; length < whole.size(); ++length) {
    const std::string path =
        write("cut.glb", Bytes(whole.begin(), whole.begin() + static_cast<long>(length)));
    try {
      static_cast<void>(load_scene(path));
      ADD_FAILURE() << "read with only " << length << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), kInvalidData) << error.what();
    }
  }
  Bytes cut(whole.begin(), whole.end() - 4);
  expect_refused(write("cut.glb", cut), kInvalidData,
                 {"GLB header", "truncated", std::to_string(whole.size())});
}
TEST_F(GltfRefusal, GlbChunksThatDoNotFit) {
  GltfFile file;
  file.show_triangle();
  Bytes glb = file.glb();
  glb[15] = 0x7f;
  expect_refused(write("a.glb", glb), kInvalidData, {"GLB chunk 0"});
  glb = file.glb();
  glb[4] = 3;
  expect_refused(write("b.glb", glb), kUnsupported, {"version 3"});
  glb = file.glb();
  glb[16] = 'X';
  expect_refused(write("c.glb", glb), kInvalidData, {"not JSON"});
}

/// Fields of an older version have other types: the error must name the version.
TEST_F(GltfRefusal, OlderVersions) {
  const std::string old =
      R"({"asset": {"version": "1.0"}, "scene": "default", "meshes": {"a": {}}})";
  expect_refused(write("a.gltf", old), kUnsupported, {"asset.version", "\"1.0\"", "only 2.0"});
}

TEST_F(GltfRefusal, FilesThatAreNotGltf) {
  expect_refused(path("gone.glb"), kNotFound, {"no such file"});
  std::filesystem::create_directory(path("folder.glb"));
  expect_refused(path("folder.glb"), kIo, {"folder"});
  expect_refused(write("empty.glb", std::string()), kInvalidData, {"empty"});
  expect_refused(write("scene.xyzzy", std::string("a")), kUnsupported, {"ending"});
  expect_refused(write("scene", std::string("a")), kUnsupported, {"ending"});
  expect_refused(path(""), kIo, {});
}

}  // namespace
}  // namespace raysheaf::test
