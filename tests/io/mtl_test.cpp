// The meaning of MTL statements.
#include <cmath>

#include "tests/io/io_support.h"

namespace raysheaf::test {
namespace {

class Mtl : public IoTest {
 protected:
  /// A scene whose library is `text`.
  SceneDescription load(const std::string& text) {
    write("a.mtl", text);
    return load_scene(
        write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n"));
  }
  /// The material "a" with these lines. `warnings` is the expected number of warnings.
  Material material(const std::string& lines, std::size_t warnings = 0) {
    const SceneDescription scene = load("newmtl a\n" + lines);
    EXPECT_EQ(scene.warnings.size(), warnings) << lines;
    return scene.materials[0];
  }
};

void expect_color(const Vec3& color, const Vec3& expected, const std::string& lines) {
  EXPECT_NEAR(color.x, expected.x, 1e-4) << lines;
  EXPECT_NEAR(color.y, expected.y, 1e-4) << lines;
  EXPECT_NEAR(color.z, expected.z, 1e-4) << lines;
}
Vec3 base_of(const Material& material) {
  return {material.base_color.x, material.base_color.y, material.base_color.z};
}

TEST_F(Mtl, TakesTheFirstPartForThoseLeftOut) {
  for (const char* lines : {"Kd .4\n", "Kd\t+0.4  # grey\r\n", "  Kd 4e-1 .4", "Ka .1\rKd .4\r"})
    expect_color(base_of(material(lines)), {0.4f, 0.4f, 0.4f}, lines);
  expect_color(base_of(material("Kd .4 .2\n")), {0.4f, 0.2f, 0.4f}, "two");
  expect_color(base_of(material("Kd .4 .2 0 # red\n")), {0.4f, 0.2f, 0}, "three");
  expect_color(base_of(material("illum 4\nTf .5\n")), {0.5f, 0.5f, 0.5f}, "Tf");
  expect_color(base_of(material("illum 4\nKt .5\n")), {0.5f, 0.5f, 0.5f}, "Kt");
  const Material lamp = material("Kd 1\nKs .25\nKe 7\n");
  expect_color(lamp.emission, {7, 7, 7}, "Ke");
  expect_color(lamp.specular_color, {1, 1, 1}, "Ks");
  EXPECT_EQ(lamp.specular, 0.25f);
}

TEST_F(Mtl, ConvertsXyz) {
  expect_color(base_of(material("Kd xyz .95047 1 1.08883\n")), {1, 1, 1}, "white");
  // The red and green primaries, half as bright.
  expect_color(base_of(material("Kd xyz 0.206228 0.106336 0.009667\n")), {0.5f, 0, 0}, "red");
  expect_color(material("Ke xyz 3.575761 7.151522 1.19192\n").emission, {0, 10, 0}, "green");
  const Material equal = material("Kd xyz .5\n");
  expect_color(base_of(equal), base_of(material("Kd xyz .5 .5 .5\n")), "left out");
  EXPECT_GT(equal.base_color.x, equal.base_color.z) << "redder than daylight";
}

TEST_F(Mtl, LeavesOutSpectralCurves) {
  const SceneDescription scene = load(
      "newmtl a\nKd spectral file.rfl 1\nKs spectral file.rfl\nKe spectral lamp.rfl\n"
      "Ka spectral file.rfl\nnewmtl b\nKd spectral other.rfl\n");
  ASSERT_EQ(scene.materials.size(), 2u);
  expect_color(base_of(scene.materials[0]), {0.8f, 0.8f, 0.8f}, "grey");
  expect_color(scene.materials[0].emission, {0, 0, 0}, "none");
  EXPECT_EQ(scene.materials[0].specular, 0);
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "spectral"));
  material("Kd 1 1 1\nKa spectral file.rfl\n", 0);
}

/// d determines the transmitted and the diffuse part, whatever the body's colour.
TEST_F(Mtl, KeepsTheColourOfThinPlastic) {
  struct Body {
    Vec3 kd, tint;
  };
  for (const Body& body :
       {Body{{0.8f, 0, 0}, {1, 0, 0}}, Body{{0.2f, 0.4f, 0.1f}, {0.5f, 1, 0.25f}},
        Body{{1, 1, 1}, {1, 1, 1}}, Body{{0, 0, 0}, {1, 1, 1}}}) {
    for (const float d : {0.0f, 0.25f, 0.9f}) {
      const std::string lines = "Kd " + std::to_string(body.kd.x) + " " +
                                std::to_string(body.kd.y) + " " + std::to_string(body.kd.z) +
                                "\nd " + std::to_string(d) + "\nNi 1.45\nillum 2\nTf 1 1 1\n";
      const Material m = material(lines);
      const Vec3 base = base_of(m);
      const auto part_of = [&](float part) {
        return Vec3{base.x * part, base.y * part, base.z * part};
      };
      expect_color(part_of(m.transmission),
                   {(1 - d) * body.tint.x, (1 - d) * body.tint.y, (1 - d) * body.tint.z}, lines);
      expect_color(part_of(1 - m.transmission), {d * body.kd.x, d * body.kd.y, d * body.kd.z},
                   lines);
      EXPECT_EQ(m.ior, 1.45f);
      EXPECT_EQ(m.base_color.w, 1);
    }
  }
}

TEST_F(Mtl, KeepsTheTextureOfThinPlasticAndNotOfClearGlass) {
  write_png({"", 1, 1, {10, 20, 30, 255}}, path("t.png"));
  const Material plastic = material("Kd 1\nmap_Kd t.png\nd .5\nNi 1.45\nillum 2\n");
  EXPECT_NE(plastic.base_color_texture.texture, kInvalidId);
  EXPECT_EQ(plastic.transmission, 0.5f);
  for (const char* clear : {"illum 7\n", "d .5\nNi 1.5\nTf .5 1 1\n"}) {
    const Material glass = material(std::string("Kd 1 0 0\nKs 1 1 1\nmap_Kd t.png\n") + clear, 1);
    EXPECT_EQ(glass.base_color_texture.texture, kInvalidId);
    EXPECT_EQ(glass.base_color.z, 1);
  }
  EXPECT_TRUE(warns(load("newmtl a\nKd 1 0 0\nKs .5 .5 .5\nd .5\nNi 1.5\n"), "Ks"));
}

TEST_F(Mtl, MirrorsAreAsRoughAsPrSaysAndGlassIsSmooth) {
  const Material mirror = material("illum 3\nKd 0\nKs .9\nPr .25\n", 0);
  EXPECT_EQ(mirror.metallic, 1);
  EXPECT_EQ(mirror.roughness, 0.25f);
  EXPECT_EQ(material("illum 3\nKd 0\nKs .9\n", 0).roughness, 0);
  for (const char* glass : {"illum 7\n", "Kd 1\nd .5\nNi 1.5\n"})
    EXPECT_EQ(material(std::string(glass) + "Pr .25\n", 1).roughness, 0);
  EXPECT_TRUE(warns(load("newmtl a\nillum 7\nPr .25\n"), "Pr"));
}

TEST_F(Mtl, FindsTheNamesOfMapsBehindTheirOptions) {
  write_png({"", 1, 1, {10, 20, 30, 255}}, path("a map.png"));
  struct Line {
    const char* text;
    Vec2 scale, offset;
  };
  for (const Line& line :
       {Line{"map_Kd -cc on a map.png", {1, 1}, {0, 0}},
        Line{"map_Kd -blendu off\t-cc off -s 2 3 a map.png  ", {2, 3}, {0, -2}},
        Line{"\tmap_Kd\t-o .25 -clamp off -s 2 a map.png", {2, 1}, {0.25f, 0}},
        Line{"map_Kd -o .5 -.5 0 -type sphere a map.png\r", {1, 1}, {0.5f, 0.5f}},
        Line{"map_Kd -texres 8 -boost 2 -imfchan r a map.png", {1, 1}, {0, 0}}}) {
    const TextureSlot slot = material(std::string("Kd 1\n") + line.text).base_color_texture;
    EXPECT_NE(slot.texture, kInvalidId) << line.text;
    EXPECT_EQ(slot.scale.x, line.scale.x) << line.text;
    EXPECT_EQ(slot.scale.y, line.scale.y) << line.text;
    EXPECT_EQ(slot.offset.x, line.offset.x) << line.text;
    EXPECT_EQ(slot.offset.y, line.offset.y) << line.text;
  }
  for (const char* line : {"map_Kd -mm 0 1 a map.png", "map_Kd -t 0 0 0 a map.png"}) material(line);
  for (const char* line :
       {"map_Kd -mm .2 .5 a map.png", "map_Ke -mm .2 a map.png", "map_Kd -t .1 a map.png"})
    material(line, 1);
}

TEST_F(Mtl, ShowsMapsWithoutAColourAsTheyAre) {
  const std::string map = "map_Kd gone.png\n";
  for (const char* before : {"", "newmtl b\nKd .2 .2 .2\n"}) {
    const SceneDescription scene = load(before + ("newmtl a\n" + map));
    expect_color(base_of(scene.materials.back()), {1, 1, 1}, before);
  }
}

TEST_F(Mtl, NamesWhatIsLeftOut) {
  write_png({"", 1, 1, {10, 20, 30, 255}}, path("t.png"));
  struct Line {
    const char *text, *word;
  };
  for (const Line& line :
       {Line{"map_Ka t.png", "Ambient"}, Line{"map_Ka u.png\nmap_Kd t.png", "Ambient"},
        Line{"decal t.png", "Decals"}, Line{"decal\tt.png", "Decals"},
        Line{"map_Ps t.png", "Sheen"}, Line{"Ps .5", "Sheen"}, Line{"Pc 1", "Clear coats"},
        Line{"map_Pc t.png", "Clear coats"}, Line{"aniso .5", "Anisotropy"}}) {
    const SceneDescription scene =
        load(std::string("newmtl a\n") + line.text + "\nnewmtl b\n" + line.text);
    EXPECT_EQ(scene.warnings.size(), 1u) << line.text;
    EXPECT_TRUE(warns(scene, line.word)) << line.text;
  }
  // Statements that programs write with default values.
  material(
      "Ka 1 1 1\nKd 1 1 1\nmap_Kd t.png\nmap_Ka t.png\nPs 0\nPc 0\nPcr .03\naniso 0\nanisor 0\n"
      "illum 2\n");
}

TEST_F(Mtl, HasHighlightsByModel) {
  const std::string mirror = "Kd .1 .2 .3\nKs .9 .9 .9\nNs 1000\n";
  EXPECT_EQ(material(mirror).metallic, 1) << "no model is named";
  EXPECT_EQ(material(mirror + "illum 2\n").metallic, 1);
  const Material matte = material("illum 1\n" + mirror);
  EXPECT_EQ(matte.metallic, 0);
  EXPECT_EQ(matte.specular, 0);
  EXPECT_FALSE(matte.unlit);
  const Material constant = material("illum 0\n" + mirror);
  EXPECT_TRUE(constant.unlit);
  expect_color(base_of(constant), {0.1f, 0.2f, 0.3f}, "constant");
  const Material thin = material("illum 0\nKd 1 0 0\nd .5\nNi 1.45\n", 1);
  EXPECT_TRUE(thin.unlit && thin.alpha_blend);
  EXPECT_EQ(thin.transmission, 0) << "unlit materials have no Fresnel reflection";
  const Material lamp = material("illum 0\nKd 0 0 0\nKe 5 5 5\nKs 1 1 1\n");
  EXPECT_FALSE(lamp.unlit);
  EXPECT_EQ(lamp.emission.x, 5);
  EXPECT_EQ(lamp.specular, 0);
}

TEST_F(Mtl, LeavesTheMaterialBeforeANameThatIsMissing) {
  const Material red = material("Kd 1 0 0\nillum 1\nnewmtl\nnewmtl \n");
  expect_color(base_of(red), {1, 0, 0}, "newmtl");
}

TEST_F(Mtl, ReadsHalosAsEven) {
  const SceneDescription scene = load("newmtl a\nKd 1 0 0\nd -halo .3\nnewmtl b\nd -halo .3\n");
  EXPECT_EQ(scene.materials[0].base_color.w, 0.3f);
  EXPECT_TRUE(scene.materials[0].alpha_blend);
  EXPECT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(warns(scene, "-halo"));
}

TEST_F(Mtl, IsGreyWithoutAColour) {
  for (const char* lines : {"", "Ks .1 .1 .1\nNs 10\nillum 2\n", "illum 0\n", "Kd\n"})
    expect_color(base_of(material(lines)), {0.8f, 0.8f, 0.8f}, lines);
  expect_color(base_of(material("Kd 0 0 0\n")), {0, 0, 0}, "black");
}

TEST_F(Mtl, ReadsKeywordsInAnyCase) {
  write_png({"", 1, 1, {10, 20, 30, 255}}, path("t.png"));
  expect_color(base_of(material("kd 1 0 0\nILLUM 1\n")), {1, 0, 0}, "kd");
  expect_color(material("KE 7\n").emission, {7, 7, 7}, "KE");
  EXPECT_EQ(material("D .5\nni 1.25\nKD 1\n").ior, 1.25f);
  EXPECT_EQ(material("kd 1\npr .25\nPM .75\n").metallic, 0.75f);
  for (const char* map : {"map_kd t.png", "Map_Kd t.png", "MAP_KD -S 2 2 -Clamp ON t.png"})
    EXPECT_NE(material(map).base_color_texture.texture, kInvalidId) << map;
  for (const char* map : {"MAP_BUMP t.png", "Bump t.png", "map_ns t.png"}) material(map, 1);
}

TEST_F(Mtl, ReadsCommasAndBytes) {
  expect_color(base_of(material("Kd 0,8 0,2 0,1\n", 1)), {0.8f, 0.2f, 0.1f}, "commas");
  expect_color(base_of(material("Kd 0.8, 0.2, 0.1\n", 1)), {0.8f, 0.2f, 0.1f}, "separated");
  EXPECT_TRUE(warns(load("newmtl a\nKd 1\nNs 96,078\n"), "Commas"));
  expect_color(base_of(material("Kd 255 128 0\n", 1)), {1, 128 / 255.f, 0}, "bytes");
  expect_color(base_of(material("illum 4\nTf 255 51 0\n", 1)), {1, 0.2f, 0}, "bytes");
  expect_color(base_of(material("Kd 1.5 .5 0\n", 1)), {1, 0.5f, 0}, "too bright");
  expect_color(base_of(material("Kd 1.0005 1 1\n")), {1.0005f, 1, 1}, "rounded");
  expect_color(material("Ke 300 200 100\n").emission, {300, 200, 100}, "lamps");
  EXPECT_TRUE(warns(load("newmtl a\nKd 255 128 0\n"), "255"));
}

TEST_F(Mtl, RefusesWhatIsNoNumber) {
  for (const char* line : {"Kd red", "Kd 1 x 1", "Kd 1,2,3", "kd nan 0 0", "Ks xyz", "Ns shiny",
                           "illum two", "d -halo", "Tr 1e99", "Kd xyz 1 a"}) {
    write("a.mtl", std::string("newmtl a\n") + line + "\n");
    for (const char* lib : {"mtllib a.mtl\n", "mtllib b.mtl a.mtl\n"})
      expect_refused(write("a.obj", lib + std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")),
                     ErrorCode::kInvalidData, {"a.mtl: line 2"});
  }
}

}  // namespace
}  // namespace raysheaf::test
