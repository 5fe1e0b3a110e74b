// Wavefront OBJ and MTL.
#include <cmath>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;

class Obj : public IoTest {
 protected:
  SceneDescription load(const std::string& text) { return load_scene(write("a.obj", text)); }
  void expect(ErrorCode code, const std::string& text, const std::vector<std::string>& words) {
    expect_refused(write("a.obj", text), code, words);
  }
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

float area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    sum += ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  }
  return static_cast<float>(sum);
}

TEST_F(Obj, CutsPolygonsIntoFans) {
  const SceneDescription scene = load(kSquare + "f 1 2 3 4\n");
  const std::vector<std::array<std::uint32_t, 3>> fan = {{0, 1, 2}, {0, 2, 3}};
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
  ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_FLOAT_EQ(area(scene.meshes[0]), 1);
  EXPECT_EQ(scene.instances.size(), 1u);
  EXPECT_TRUE(scene.materials[0].double_sided);
}
TEST_F(Obj, CutsConcavePolygonsWithoutOverlap) {
  // An L, and a comb whose fan would fold over.
  const std::string shape = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 2 0\nv 1 1 0\nv 0 1 0\nf 5 6 1 2 3 4\n";
  const SceneDescription scene = load(shape);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_FLOAT_EQ(area(mesh), 3);
  for (const auto& t : mesh.triangles) {
    Mesh one = mesh;
    one.triangles = {t};
    EXPECT_GE(area(one), 0);
  }
}
TEST_F(Obj, CountsNegativeIndicesFromTheNewest) {
  const SceneDescription scene = load("v 9 9 9\n" + kSquare + "f -4 -3 -2\nv 5 5 5\nf -5 -4 -1\n");
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions[mesh.triangles[0][0]].x, 0);
  EXPECT_EQ(mesh.positions[mesh.triangles[1][2]].x, 5);
}
TEST_F(Obj, MakesAMeshOfEachGroup) {
  const SceneDescription scene = load(kSquare +
                                      "o Cylinder#1 \nf 1 2 3\ng left side\nf 1 2 3\nf 1 3 4\n"
                                      "o other\nf 1 2 4\no Cylinder#1\nf 2 3 4\n");
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].name, "Cylinder#1");
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u) << "a group may be continued";
  EXPECT_EQ(scene.meshes[1].name, "Cylinder#1/left side");
  EXPECT_EQ(scene.meshes[2].name, "other");
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[2].mesh, 2u);
}
TEST_F(Obj, ReadsNormalsAndCoordinates) {
  const SceneDescription scene =
      load(kSquare + "vt 0.25 0.75\nvt 1\nvn 0 0 -2\nf 1/1/1 2/2/1 3//1 # a comment\n");
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.normals[0].z, -1);
  EXPECT_EQ(mesh.uvs[0].x, 0.25f);
  EXPECT_EQ(mesh.uvs[0].y, 0.25f) << "v counts from the top row";
  EXPECT_EQ(mesh.uvs[1].y, 1);
}
TEST_F(Obj, TakesNothingFromTheNextReference) {
  const std::string lists =
      "vt 0 1\nvt 0 0.75\nvt 0 0.5\nvt 0 0.25\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\n";
  for (const char* face :
       {"f 1/2/ 2/3/ 3/4/\n", "f 1/2 2/3 3/4\n", "f 1/2/ 2/3/\t3/4/ # 1/1/1\n"}) {
    const Mesh mesh = load(kSquare + lists + face).meshes[0];
    EXPECT_EQ(mesh.uvs[0].y, 0.25f) << face;
    EXPECT_EQ(mesh.uvs[2].y, 0.75f) << face;
    for (const Vec3& normal : mesh.normals) EXPECT_EQ(normal.z, 1) << face << "of the face";
  }
  for (const char* face : {"f 1/ 2/ 3/\n", "f 1// 2// 3//\n"}) {
    const Mesh mesh = load(kSquare + lists + face).meshes[0];
    EXPECT_TRUE(mesh.uvs.empty()) << face;
    for (const Vec3& normal : mesh.normals) EXPECT_EQ(normal.z, 1) << face;
  }
}
TEST_F(Obj, ReadsUtf8WithItsMarkAndNoUtf16) {
  const std::string mark = "\xef\xbb\xbf";
  write("a.mtl", mark + "newmtl red\nKd 1 0 0\n");
  const SceneDescription scene =
      load(mark + "v 0 0 0\nv 1 0 0\nv 1 1 0\nmtllib a.mtl\nusemtl red\nf 1 2 3\n");
  EXPECT_EQ(scene.meshes[0].positions[1].x, 1);
  EXPECT_EQ(scene.materials[scene.meshes[0].materials[0]].base_color.y, 0);
  EXPECT_TRUE(scene.warnings.empty());
  expect(kUnsupported, std::string("\xff\xfev\0 \0", 6), {"UTF-16"});
  expect(kUnsupported, std::string("\xfe\xff\0v\0 ", 6), {"UTF-16"});
}
TEST_F(Obj, ReadsColoursBehindVertices) {
  const SceneDescription scene = load(
      "v 0 0 0 1 0 +0.5\nv 1 0 0 0 1 1.0005\nv 1 1 0\nv 0 1 0 1 -1 1e-999\nf 1 2 3\nf 1 3 4\n");
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.colors.size(), 4u);
  EXPECT_EQ(mesh.colors[0].x, 1);
  EXPECT_NEAR(mesh.colors[0].z, 0.2140411f, 1e-6) << "sRGB";
  EXPECT_EQ(mesh.colors[1].z, 1);
  EXPECT_EQ(mesh.colors[2].x, 1) << "white without a colour";
  EXPECT_EQ(mesh.colors[3].x, 1);
  EXPECT_EQ(mesh.colors[3].y, 0);
  EXPECT_EQ(mesh.colors[3].z, 0);
  EXPECT_EQ(scene.materials[0].base_color.x, 1) << "vertex colours are not multiplied by grey";
  EXPECT_TRUE(load(kSquare + "f 1 2 3\n").meshes[0].colors.empty());
}
TEST_F(Obj, TakesColoursBeyondOneForBytes) {
  const SceneDescription scene = load("v 0 0 0 255 0 1\nv 1 0 0 0 128 9e999\nv 1 1 0\nf 1 2 3\n");
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.colors[0].x, 1);
  EXPECT_NEAR(mesh.colors[0].z, 1 / (255 * 12.92), 1e-7);
  EXPECT_NEAR(mesh.colors[1].y, 0.2158605f, 1e-6);
  EXPECT_EQ(mesh.colors[1].z, 1);
  EXPECT_EQ(mesh.colors[2].x, 1) << "white without a colour";
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "divided by 255"));
}
TEST_F(Obj, UnderstandsOddLines) {
  const SceneDescription scene = load(
      "\r\n# head\r\n  v 0 0 0 1 1 1\r\nv\t1. +0 -.0e-1\r\nv 0 \\\r\n1 0\r\n\r\ns off\r\nf 1 "
      "2 3");
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_EQ(scene.meshes[0].positions[2].y, 1);
  EXPECT_EQ(load("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").triangle_count(), 1u) << "old line ends";
  EXPECT_EQ(load("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\f3 \v\n").triangle_count(), 1u) << "blanks";
}
TEST_F(Obj, JoinsNoLineToACommentOrAName) {
  EXPECT_EQ(load("# from C:\\models\\\n" + kSquare + "f 1 2 3 # C:\\\nf 1 3 4\n").triangle_count(),
            2u);
  EXPECT_EQ(load("l 1 2 # C:\\\n" + kSquare + "maplib C:\\maps\\\nf 1 2 3\n").triangle_count(), 1u);
  EXPECT_EQ(load(kSquare + "f 1 2 \\\n3 \\\n4\n # out\\\r\nf 1 2 3\n").triangle_count(), 3u);
  const SceneDescription scene =
      load(kSquare + "g C:\\dir\\\nf 1 2 3\no a\\\nusemtl b\\\ng left \\\nside\nf 1 3 4\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "C:\\dir\\");
  EXPECT_EQ(scene.meshes[1].name, "a\\/left side");
}
TEST_F(Obj, WarnsOfWhatIsLeftOut) {
  const SceneDescription scene = load(kSquare + "l 1 2\np 1\nf 1 2\nf 1 2 3\n");
  EXPECT_TRUE(warns(scene, "Points and lines"));
  EXPECT_TRUE(warns(scene, "fewer than three"));
}

TEST_F(Obj, WarnsOfNumbersWithoutTheirLists) {
  const SceneDescription scene = load(kSquare + "f 1/1/7 2/2/7 3/-3/-7\n");
  EXPECT_TRUE(warns(scene, "normals or texture coordinates"));
  EXPECT_TRUE(scene.meshes[0].uvs.empty());
  EXPECT_EQ(scene.meshes[0].normals[0].z, 1);
}
TEST_F(Obj, NamesTheLineOfWhatIsWrong) {
  expect(kInvalidData, kSquare + "f 1 2 5\n", {"line 5", "vertex 5", "there are 4"});
  expect(kInvalidData, kSquare + "f 1 2 -5\n", {"line 5", "vertex -5"});
  expect(kInvalidData, kSquare + "f 1 2 0\n", {"line 5", "vertex 0", "begin at 1"});
  expect(kInvalidData, kSquare + "f 1 2 99999999999\n", {"line 5", "out of range"});
  expect(kInvalidData, kSquare + "f 1 2 x\n", {"line 5", "\"x\""});
  expect(kInvalidData, kSquare + "f 1 2 3/4/5/6\n", {"line 5", "\"3/4/5/6\""});
  expect(kInvalidData, "v 0 0\n", {"line 1", "2 numbers"});
  expect(kInvalidData, "v 0 0 1..2\n", {"line 1"});
  expect(kInvalidData, kSquare, {"triangle"});
  expect(kInvalidData, std::string("\0\1\2\3", 4), {"triangle"});
}

TEST_F(Obj, LeavesOutFacesWithVerticesThatAreNotFinite) {
  for (const char* odd :
       {"nan 0 0", "0 inf 0", "0 0 -1e99", "1.#QNAN -1.#IND 0", "-nan(ind) 0 0"}) {
    const std::string vertices = kSquare + "v " + odd + "\n";
    const SceneDescription unused = load(vertices + "f 1 2 3\n");
    EXPECT_EQ(unused.triangle_count(), 1u) << odd;
    EXPECT_TRUE(unused.warnings.empty()) << odd;
    const SceneDescription used = load(vertices + "f 1 2 3\nf 1 2 5\nf 5 2 3 4\n");
    EXPECT_EQ(used.triangle_count(), 1u) << odd;
    EXPECT_EQ(used.warnings.size(), 1u) << odd;
    EXPECT_TRUE(warns(used, "2 faces")) << odd;
    expect(kInvalidData, vertices + "f 1 2 5\n", {"every face", "not finite"});
  }
}
TEST_F(Obj, IgnoresNormalsAndCoordinatesThatDoNotServe) {
  struct Case {
    const char *lines, *warning;
  };
  for (const Case& one : {Case{"vn nan nan nan\nf 1//1 2//1 3//1\n", "not finite"},
                          Case{"vn 1e999 0 0\nf 1//1 2//1 3//1\n", "not finite"},
                          Case{"vt inf 0\nf 1/1 2/1 3/1\n", "not finite"},
                          Case{"vn 0 0 1\nf 1//2 2//-2 3//0\n", "does not have"},
                          Case{"vn 0 0 1\nf 1//99999999999999999999 2//1 3//1\n", "does not have"},
                          Case{"vt 0 0\nf 1/2 2/1 3/-7\n", "does not have"}}) {
    const SceneDescription scene = load(kSquare + one.lines);
    EXPECT_EQ(scene.triangle_count(), 1u) << one.lines;
    EXPECT_EQ(scene.warnings.size(), 1u) << one.lines;
    EXPECT_TRUE(warns(scene, one.warning)) << one.lines;
    for (const Vec3& normal : scene.meshes[0].normals) EXPECT_EQ(normal.z, 1) << one.lines;
  }
}
TEST_F(Obj, ReadsKeywordsInAnyCaseAndNumbersWithCommas) {
  write("a.mtl", std::string("NEWMTL red\nkd 1 0 0\n"));
  const SceneDescription scene = load(
      "MtlLib a.mtl\nV 0 0 0\nV 1 0 0\nv 1 1 0\nVN 0 0 1\nVT 0,5 0,25\nO Box\nUSEMTL red\n"
      "F 1/1/1 2/1/1 3/1/1\n");
  EXPECT_EQ(scene.meshes[0].name, "Box");
  EXPECT_EQ(scene.meshes[0].uvs[0].x, 0.5f);
  EXPECT_EQ(scene.materials[scene.meshes[0].materials[0]].base_color.y, 0);
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "Commas"));
  EXPECT_EQ(load("v 0, 0, 0\nv 1.5, 0, 0\nv 0 1 0\nf 1 2 3\n").meshes[0].positions[1].x, 1.5f);
  expect(kInvalidData, "v 1,2,3 0 0\n", {"line 1", "\"1,2,3\""});
  expect(kInvalidData, "v +-1 0 0\n", {"line 1", "\"+-1\""});
}

/// Two squares that meet at an angle of 30 or 120 degrees, with a line before each.
std::string folded(const std::string& first, const std::string& second, bool sharp = false) {
  return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 " +
         std::string(sharp ? "0.5 0.866\nv 0 0.5 0.866\n" : "1.866 0.5\nv 0 1.866 0.5\n") + first +
         "f 1 2 3 4\n" + second + "f 4 3 5 6\n";
}
/// Whether the normals of the first face differ at its corners.
bool is_smooth(const Mesh& mesh) {
  const auto normal = [&](std::size_t k) { return mesh.normals[mesh.triangles[0][k]]; };
  return std::abs(normal(0).z - normal(2).z) > 1e-3;
}
TEST_F(Obj, IsSmoothWithinAGroupOnly) {
  const auto smooth = [&](const char* first, const char* second, bool sharp) {
    return is_smooth(load(folded(first, second, sharp)).meshes[0]);
  };
  EXPECT_TRUE(smooth("", "", false)) << "by the angle";
  EXPECT_FALSE(smooth("", "", true)) << "by the angle";
  for (const bool sharp : {false, true}) {
    EXPECT_TRUE(smooth("s 1\n", "", sharp)) << "one group";
    EXPECT_TRUE(smooth("S on\n", "s ON # on\n", sharp)) << "one group";
    EXPECT_FALSE(smooth("s 1\n", "s 2\n", sharp)) << "two groups";
    EXPECT_FALSE(smooth("s 1\n", "s off\n", sharp));
    EXPECT_FALSE(smooth("", "s 1\n", sharp));
    for (const char* flat : {"s off\n", "s 0\n", "S OFF\r\n", "s\n"})
      EXPECT_FALSE(smooth(flat, "", sharp)) << flat;
  }
  const Mesh given = load(folded("vn 0 1 0\ns off\nf 1//1 2//1 3//1\n", "")).meshes[0];
  EXPECT_EQ(given.normals[given.triangles[0][1]].y, 1) << "the file's normals count";
}

TEST_F(Obj, BlendsThinMaterialsOtherThanGlass) {
  write("m.mtl",
        "newmtl thin\nKd 1 0 0\nd 0.25\n"
        "newmtl by_tr\nKd 1 0 0\nTr 0.25\n"
        "newmtl glass\nd 0.25\nNi 1.5\n"
        "newmtl only_tr\nKd 0 1 0\nTr 1\n"
        "newmtl contradiction\nKd 0 1 0\nTr 0\nd 0\n"
        "newmtl nothing\nKd 0 1 0\nd 0\n"
        "newmtl nothing_twice\nKd 0 1 0\nd 0\nTr 1\n"
        "newmtl whole\nKd 0 1 0\nd 1\n");
  std::string text = "mtllib m.mtl\n" + kSquare;
  for (const char* name :
       {"thin", "by_tr", "glass", "only_tr", "contradiction", "nothing", "nothing_twice", "whole"})
    text += std::string("usemtl ") + name + " \nf 1 2 3\n";
  const SceneDescription scene = load(text);
  const auto& m = scene.materials;
  ASSERT_EQ(m.size(), 8u);
  EXPECT_TRUE(m[0].alpha_blend && m[1].alpha_blend);
  EXPECT_EQ(m[0].base_color.w, 0.25f);
  EXPECT_EQ(m[1].base_color.w, 0.75f);
  for (const std::size_t i : {5u, 6u}) {
    EXPECT_TRUE(m[i].alpha_blend) << i;
    EXPECT_EQ(m[i].base_color.w, 0) << i;
  }
  for (const std::size_t i : {2u, 3u, 4u, 7u}) {
    EXPECT_FALSE(m[i].alpha_blend) << i;
    EXPECT_EQ(m[i].base_color.w, 1) << i;
  }
  EXPECT_EQ(scene.warnings.size(), 3u);
}

TEST_F(Obj, TurnsPhongIntoMetallicRoughness) {
  write("m.mtl",
        "newmtl matte\nKd 0.5 0.25 0.125\nKs 0 0 0\nNs 0\nillum 2\n"
        "newmtl glossy\nKd 0.5 0.5 0.5\nKs 0.4 0.2 0\nNs 98\n"
        "newmtl mirror\nKd 0 0 0\nKs 0.9 0.8 0.7\nNs 50\nillum 5\n"
        "newmtl sharp\nKd 0.1 0.1 0.1\nKs 0.9 0.9 0.9\nNs 1000\n"
        "newmtl glass\nTf 0.9 0.95 1\nNi 1.33\nillum 7\n"
        "newmtl thin\nKd 1 1 1\nd 0.25\nNi 1.2\n"
        "newmtl lamp\nKd 1 1 1\nKe 10 20 30\n"
        "newmtl metal\nKd 1 1 0\nPm 0.5\nPr 0.25\n");
  std::string text = "mtllib m.mtl\n" + kSquare;
  for (const char* name :
       {"matte", "glossy", "mirror", "sharp", "glass", "thin", "lamp", "metal"}) {
    text += std::string("usemtl ") + name + " \nf 1 2 3\n";
  }
  const SceneDescription scene = load(text);
  ASSERT_EQ(scene.materials.size(), 8u);
  ASSERT_EQ(scene.meshes[0].materials, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  const auto& m = scene.materials;
  EXPECT_EQ(m[0].name, "matte");
  EXPECT_EQ(m[0].base_color.y, 0.25f);
  EXPECT_EQ(m[0].roughness, 1);
  EXPECT_EQ(m[0].specular, 0);
  EXPECT_NEAR(m[1].roughness, std::sqrt(0.02), 1e-6);
  EXPECT_EQ(m[1].specular, 0.4f);
  EXPECT_EQ(m[1].specular_color.y, 0.5f);
  for (std::size_t i : {2u, 3u}) {
    EXPECT_EQ(m[i].metallic, 1);
    EXPECT_EQ(m[i].roughness, 0);
    EXPECT_EQ(m[i].base_color.x, 0.9f);
  }
  EXPECT_EQ(m[4].transmission, 1);
  EXPECT_EQ(m[4].ior, 1.33f);
  EXPECT_EQ(m[4].base_color.x, 0.9f);
  EXPECT_EQ(m[5].transmission, 0.75f);
  EXPECT_EQ(m[6].emission.z, 30);
  EXPECT_EQ(m[7].metallic, 0.5f);
  EXPECT_EQ(m[7].roughness, 0.25f);
  for (const Material& material : m) EXPECT_TRUE(material.double_sided);
}

TEST_F(Obj, ReadsTexturesOfMaterials) {
  write_png({"", 1, 1, {10, 20, 30, 255}}, path("a texture.png"));
  write("with space.mtl",
        "newmtl a\nKd 0 0 0\nmap_Kd -s 2 4 1 -o 0.5 0.25 0 a texture.png\n"
        "newmtl b\nKd 1 1 1\nmap_Kd a texture.png\nmap_Bump bump.png\nnorm a texture.png\n"
        "newmtl c\nKd 1 1 1\nmap_Kd gone.png\n"
        "newmtl d\nKd 1 1 1\nmap_Kd ../outside.png\n");
  const SceneDescription scene = load("mtllib with space.mtl\n" + kSquare +
                                      "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl d\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 4u);
  ASSERT_EQ(scene.images.size(), 1u);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.images[0].rgba[1], 20);
  const TextureSlot& slot = scene.materials[0].base_color_texture;
  EXPECT_EQ(slot.texture, 0u);
  EXPECT_EQ(scene.materials[0].base_color.x, 1) << "a black factor would hide the texture";
  // u' = 2 u + 0.5, v' = 4 v + 0.25, with v from the bottom.
  EXPECT_EQ(slot.scale.y, 4);
  EXPECT_FLOAT_EQ(slot.offset.x, 0.5f);
  EXPECT_FLOAT_EQ(1 - (slot.scale.y * (1 - 0.5f) + slot.offset.y), 4 * 0.5f + 0.25f);
  EXPECT_EQ(scene.materials[1].base_color_texture.texture, 0u);
  EXPECT_EQ(scene.materials[1].normal_texture.texture, 0u);
  EXPECT_EQ(scene.materials[2].base_color_texture.texture, kInvalidId);
  EXPECT_EQ(scene.materials[3].base_color_texture.texture, kInvalidId);
  EXPECT_TRUE(warns(scene, "gone.png"));
  EXPECT_TRUE(warns(scene, "outside.png"));
  EXPECT_TRUE(warns(scene, "Bump"));
}
TEST_F(Obj, CutsByMasks) {
  write_png({"", 2, 1, {10, 20, 30, 255, 40, 50, 60, 0}}, path("leaf.png"));
  write_png({"", 2, 2, {0, 0, 0, 255, 255, 255, 255, 255, 9, 9, 9, 255, 0, 255, 0, 255}},
            path("mask.png"));
  write("a.mtl",
        "newmtl own\nd 0\nNi 1.5\nmap_Kd leaf.png\nmap_d leaf.png\n"
        "newmtl two\nKd 1 1 1\nmap_Kd leaf.png\nmap_d mask.png\n"
        "newmtl bare\nKd 1 0 0\nmap_d -o 0.5 0 0 mask.png\n"
        "newmtl same\nKd 0 1 0\nmap_Kd leaf.png\nmap_d mask.png\n"
        "newmtl gone\nKd 0 1 0\nmap_d gone.png\n"
        "newmtl glass\nillum 4\nmap_d mask.png\n");
  const SceneDescription scene = load("mtllib a.mtl\n" + kSquare + "f 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 7u);
  const auto image_of = [&](std::size_t material) -> const Image& {
    return scene.images[scene.textures[scene.materials[material].base_color_texture.texture].image];
  };
  const auto cutoffs = [&](std::size_t m) { return scene.materials[m].alpha_cutoff; };
  EXPECT_EQ(cutoffs(0), 0.5f);
  EXPECT_EQ(scene.materials[0].base_color.w, 1);
  EXPECT_EQ(scene.materials[0].transmission, 0) << "a mask overrides d";
  EXPECT_EQ(image_of(0).rgba, (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 0}));
  // The base colour's size and colours, and the luminance of the mask's middle row.
  EXPECT_EQ(image_of(1).rgba, (std::vector<std::uint8_t>{10, 20, 30, 9, 40, 50, 60, 182}));
  EXPECT_EQ(image_of(2).rgba, (std::vector<std::uint8_t>{255, 255, 255, 0, 255, 255, 255, 255, 255,
                                                         255, 255, 9, 255, 255, 255, 182}));
  EXPECT_EQ(scene.materials[2].base_color_texture.offset.x, 0.5f);
  EXPECT_EQ(scene.materials[2].base_color.x, 1);
  EXPECT_EQ(scene.materials[3].base_color_texture.texture,
            scene.materials[1].base_color_texture.texture);
  EXPECT_EQ(cutoffs(4), 0);
  EXPECT_EQ(cutoffs(5), 0);
  EXPECT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(warns(scene, "gone.png"));
  EXPECT_TRUE(warns(scene, "glass"));
}
TEST_F(Obj, CutsByTheChannelThatIsNamed) {
  write_png({"", 1, 1, {10, 60, 200, 90}}, path("mask.png"));
  std::string mtl;
  const std::string channels = "rgblmz";
  for (const char channel : channels)
    mtl += std::string("newmtl ") + channel + "\nmap_d -imfchan " + channel + " mask.png\n";
  write("a.mtl", mtl);
  const SceneDescription scene = load("mtllib a.mtl\n" + kSquare + "f 1 2 3\n");
  const std::uint8_t expected[] = {10, 60, 200, 59, 90, 90};
  for (std::size_t m = 0; m < channels.size(); ++m) {
    const TextureSlot& slot = scene.materials[m].base_color_texture;
    EXPECT_EQ(scene.images[scene.textures[slot.texture].image].rgba[3], expected[m]) << channels[m];
  }
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "-imfchan z"));
}
TEST_F(Obj, ReplacesMissingMaterials) {
  const SceneDescription scene = load("mtllib gone.mtl\n" + kSquare +
                                      "f 1 2 3\nusemtl absent\nf 1 2 3\nusemtl none\nf 1 2 3\n");
  EXPECT_TRUE(warns(scene, "gone.mtl"));
  EXPECT_TRUE(warns(scene, "\"absent\" and 1 more"));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_TRUE(scene.materials[0].double_sided);
  write("empty.mtl", std::string());
  EXPECT_EQ(load("mtllib empty.mtl\n" + kSquare + "f 1 2 3\n").triangle_count(), 1u);
}

TEST_F(Obj, ReadsManyNamesAndFacesInLinearTime) {
  std::string text = kSquare;
  for (int i = 0; i < 50000; ++i) {
    text += "vn 0 0 " + std::to_string(i + 1) + "\nusemtl m" + std::to_string(i) + "\ng g" +
            std::to_string(i) + "\nf 1//-1 2//-1 3//-1\n";
  }
  EXPECT_EQ(load(text).meshes.size(), 50000u);
  std::string joined, polygon = kSquare + "f 1 2";
  for (int i = 0; i < 500000; ++i) joined += "\\\n";
  for (int i = 0; i < 100000; ++i) polygon += " \\\n";
  EXPECT_EQ(load(joined + "\n" + polygon + " 3\n").triangle_count(), 1u);
}

}  // namespace
}  // namespace raysheaf::test
