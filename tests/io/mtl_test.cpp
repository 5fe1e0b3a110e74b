// What lines of MTL mean.
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
  /// Its material "a", whose lines are `lines`. `warnings`: how many it must give.
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

TEST_F(Mtl, ReadsHalosAsEven) {
  const SceneDescription scene = load("newmtl a\nKd 1 0 0\nd -halo .3\nnewmtl b\nd -halo .3\n");
  EXPECT_EQ(scene.materials[0].base_color.w, 0.3f);
  EXPECT_TRUE(scene.materials[0].alpha_blend);
  EXPECT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(warns(scene, "-halo"));
}

}  // namespace
}  // namespace raysheaf::test
