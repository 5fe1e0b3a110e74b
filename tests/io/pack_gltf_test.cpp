// Packs glTF into blocks without holding it in memory.
#include <algorithm>
#include <array>

#include "raysheaf/animation.h"
#include "support/random.h"
#include "tests/io/pack_support.h"

namespace raysheaf::test {
namespace {

using nlohmann::json;

constexpr int kUnsignedBytes = 5121, kShorts = 5122, kUnsignedShorts = 5123, kUnsignedInts = 5125,
              kFloats = 5126;

class PackGltf : public PackTest {
 protected:
  /// The vertices of a sheet of `side` by `side` quads, bent at some lines.
  struct Sheet {
    std::vector<float> positions, normals, uvs;
    std::vector<std::uint8_t> colors;
    std::vector<std::uint32_t> indices;
  };
  static Sheet sheet(std::uint32_t side, bool some_without_normal) {
    Random random(side);
    Sheet sheet;
    const std::uint32_t across = side + 1;
    for (std::uint32_t v = 0; v < across * across; ++v) {
      const Vec3 at = random.in_box(0.3f);
      const auto x = static_cast<float>(v % across), y = static_cast<float>(v / across);
      for (const float c : {x + at.x, y, v % across % 5 == 2 ? 3.0f : at.z})
        sheet.positions.push_back(c);
      const bool none = some_without_normal && v % 3 == 0;
      for (const float c : {0.0f, at.y, none ? 0.0f : 1.0f}) sheet.normals.push_back(none ? 0 : c);
      sheet.uvs.insert(sheet.uvs.end(), {x / 8, y / 8});
      for (const std::uint32_t c : {v, 2 * v, 255u, 0u})
        sheet.colors.push_back(static_cast<std::uint8_t>(c));
    }
    for (std::uint32_t k = 0; k < side; ++k) {
      for (std::uint32_t v = across * k; v < across * k + side; ++v)
        sheet.indices.insert(sheet.indices.end(),
                             {v, v + 1, v + across, v + across, v + 1, v + across + 1});
    }
    return sheet;
  }

  /// Meshes of all kinds, some of them shown twice, once mirrored; one of them is unused.
  static GltfFile scene_of_all_kinds(std::uint32_t side) {
    GltfFile file;
    file.add("materials", {{"doubleSided", true}});
    file.add("materials", json::object());
    for (const bool some : {false, true}) {
      const Sheet s = sheet(side, some);
      const std::size_t position = file.positions(s.positions);
      const std::size_t normal = file.accessor(s.normals, "VEC3", kFloats, 3);
      const std::size_t uv = file.accessor(s.uvs, "VEC2", kFloats, 2);
      const std::size_t color = file.accessor(s.colors, "VEC4", kUnsignedBytes, 4, true);
      const std::size_t indices = file.accessor(s.indices, "SCALAR", kUnsignedInts, 1);
      const json all = {
          {"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}, {"COLOR_0", color}};
      const json bare = {{"POSITION", position}};
      const json whole = {{"attributes", all}, {"indices", indices}, {"material", 0}};
      const json flat = {{"attributes", bare}, {"indices", indices}, {"material", 1}};
      const json strip = {{"attributes", all}, {"mode", 5}};
      const json fan = {{"attributes", bare}, {"indices", indices}, {"mode", 6}};
      file.add("meshes", {{"name", "whole"}, {"primitives", {whole}}});
      file.add("meshes", {{"name", "mixed"}, {"primitives", {whole, flat, strip, fan}}});
      file.add("meshes", {{"name", "bare"}, {"primitives", {flat, fan}}});
      file.add("meshes",
               {{"name", "points"}, {"primitives", {{{"attributes", all}, {"mode", 0}}}}});
    }
    file.add("meshes", {{"name", "quantized"}, {"primitives", {quantized(&file)}}});
    const std::array<std::size_t, 8> shown = {1, 0, 8, 2, 5, 3, 6, 1};
    float x = 0;
    for (const std::size_t mesh : shown) {
      json node = {{"mesh", mesh}, {"translation", {x, 1, -x}}};
      if (mesh == 1) node["scale"] = {x > 3 ? -2 : 1, 1, 0.5};
      file.node(node);
      x += 3;
    }
    return file;
  }
  static json quantized(GltfFile* file) {
    std::vector<std::int16_t> positions;
    std::vector<std::uint16_t> indices;
    for (std::uint16_t v = 0; v < 200; ++v) {
      for (const int c : {v * 91 % 32767, v * 7, v % 5, 0})
        positions.push_back(static_cast<std::int16_t>(c));
      if (v >= 2) indices.insert(indices.end(), {v, static_cast<std::uint16_t>(v - 1), 0});
    }
    const std::size_t view = file->view(positions);
    file->json["bufferViews"][view]["byteStride"] = 8;
    const std::size_t position = file->add("accessors", {{"bufferView", view},
                                                         {"componentType", kShorts},
                                                         {"count", 200},
                                                         {"type", "VEC3"},
                                                         {"normalized", true}});
    return {{"attributes", {{"POSITION", position}}},
            {"indices", file->accessor(indices, "SCALAR", kUnsignedShorts, 1)}};
  }
};

TEST_F(PackGltf, GivesTheBytesOfTheSceneInMemory) {
  const GltfFile file = scene_of_all_kinds(21);
  const std::string glb = write("scene.glb", file.glb());
  write("its buffer.bin", file.buffer);
  const std::string gltf = write("scene.gltf", file.text("its%20buffer.bin"));
  for (const std::uint32_t most : {30u, 999u, 65536u}) {
    expect_same(glb, most, 50);
    expect_same(gltf, most, 3000);
  }
  expect_same(write("data.gltf", file.text()), 300, 100);
  expect_same(write("small.glb", scene_of_all_kinds(3).glb()), 1, 1);
}

/// More vertices and corners than a window holds.
TEST_F(PackGltf, ReadsMeshesInWindows) {
  GltfFile file;
  const Sheet s = sheet(150, true);
  const std::size_t normal = file.accessor(s.normals, "VEC3", kFloats, 3);
  file.show({{"attributes", {{"POSITION", file.positions(s.positions)}, {"NORMAL", normal}}},
             {"indices", file.accessor(s.indices, "SCALAR", kUnsignedInts, 1)}});
  expect_same(write("scene.glb", file.glb()), 9999, 5000);
}

TEST_F(PackGltf, RefusesWhatLoadSceneRefuses) {
  const auto spoiled = [&](const auto& spoil) {
    GltfFile file = scene_of_all_kinds(9);
    spoil(file);
    return write("bad.glb", file.glb());
  };
  const auto number_at = [](GltfFile& file, std::size_t view, std::size_t i, auto number) {
    const std::size_t offset = file.json["bufferViews"][view]["byteOffset"];
    std::memcpy(file.buffer.data() + offset + 4 * i, &number, sizeof number);
  };
  const float inf = std::numeric_limits<float>::infinity();
  expect_same_words(spoiled([&](GltfFile& f) { number_at(f, 0, 71, inf); }), "POSITION[23]");
  expect_same_words(spoiled([&](GltfFile& f) { number_at(f, 2, 7, inf); }), "TEXCOORD_0[3]");
  expect_same_words(spoiled([&](GltfFile& f) { number_at(f, 4, 5, 12345); }), "indices[5]");
  expect_same_words(spoiled([&](GltfFile& f) { f.json["accessors"][0]["count"] = 101; }),
                    "do not fit");
  expect_same_words(spoiled([&](GltfFile& f) { f.json["accessors"][1]["count"] = 99; }),
                    "POSITION");
  expect_same_words(spoiled([&](GltfFile& f) { f.json["nodes"][0]["mesh"] = 99; }), "meshes");
  expect_same_words(spoiled([&](GltfFile& f) {
                      f.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
                    }),
                    "rotation");
  GltfFile file = scene_of_all_kinds(9);
  Bytes bytes = file.glb();
  bytes.resize(bytes.size() - 1);
  expect_same_words(write("cut.glb", bytes), "truncated");
  bytes.resize(300);
  expect_same_words(write("cut.glb", bytes), "truncated");
  expect_same_words(write("a.gltf", file.text("none.bin")), "none.bin");
  write("short.bin", Bytes(100));
  expect_same_words(write("a.gltf", file.text("short.bin")), "short.bin");
}

TEST_F(PackGltf, SaysThatAnimationsAreLeftOut) {
  GltfFile file = scene_of_all_kinds(9);
  const std::size_t times = file.accessor<float>({0, 1}, "SCALAR", kFloats, 1);
  const std::size_t places = file.positions({0, 0, 0, 0, 9, 0});
  file.add("animations",
           {{"samplers", {{{"input", times}, {"output", places}}}},
            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  const std::string scene = write("moving.glb", file.glb());
  expect_same(scene, 100, 50);
  BlockList sink;
  const auto rest = pack_file(scene, &sink, {.triangles_at_once = 50, .beside = path("out.rsb")});
  ASSERT_TRUE(rest.has_value());
  EXPECT_EQ(rest->warnings, cut_into_blocks(load_scene(scene), &sink).warnings);
  EXPECT_EQ(
      std::count_if(rest->warnings.begin(), rest->warnings.end(),
                    [](const std::string& w) { return w.starts_with("Animations are left out"); }),
      1);
  EXPECT_FALSE(warns(load_animation(scene)->scene(), "Animations"));
}

TEST_F(PackGltf, LeavesOthersAlone) {
  GltfFile file = scene_of_all_kinds(9);
  EXPECT_TRUE(is_taken(write("a.glb", file.glb())));
  const json target = {
      {"POSITION", file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]}};
  file.json["meshes"][0]["primitives"][0]["targets"] = {target};
  EXPECT_FALSE(is_taken(write("moving.glb", file.glb())));
  GltfFile far = scene_of_all_kinds(9);
  far.json["nodes"][0]["translation"] = {2e18, 0, 0};
  EXPECT_FALSE(is_taken(write("far.glb", far.glb())));
}

}  // namespace
}  // namespace raysheaf::test
