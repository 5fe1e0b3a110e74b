// SceneDescription::files lists the file that a scene was read from, and the files that it refers
// to.
#include "raysheaf/animation.h"
#include "raysheaf/block_file.h"
#include "raysheaf/builtin_scenes.h"
#include "tests/io/io_support.h"
#include "tests/support/gltf_triangle.h"

namespace raysheaf::test {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kTexturedTriangle =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

class Files : public IoTest {
 protected:
  Files() {
    write("o.obj", std::string("mtllib m/o.mtl\n") + kTexturedTriangle);
    write("m/o.mtl", "newmtl m\nmap_Kd -clamp on gone.png\n");
    write("f_1.obj", kTexturedTriangle);
    write("f_2.obj", kTexturedTriangle);
  }
  /// A triangle whose buffer and image are separate files.
  std::string gltf() {
    write("c.bin", gltf_triangle_corners());
    return write("c.gltf", kGltfTriangle);
  }
  [[nodiscard]] Names paths(const Names& names) const {
    Names paths;
    for (const std::string& name : names) paths.push_back(path(name));
    return paths;
  }
};

TEST_F(Files, OfOneFileAndOfThoseThatItNames) {
  EXPECT_EQ(load_scene(gltf()).files, paths({"c.gltf", "a b.png", "c.bin"}));
  EXPECT_EQ(load_scene(path("f_1.obj")).files, paths({"f_1.obj"}));
  EXPECT_EQ(load_scene(path("o.obj")).files, paths({"o.obj", "m/gone.png", "m/o.mtl"}));
  EXPECT_TRUE(builtin_scene("cornell").files.empty());
}

TEST_F(Files, OfASequenceAreThoseOfAllFrames) {
  const Names frames = paths({"f_1.obj", "f_2.obj"});
  EXPECT_EQ(load_animation(path("f_?.obj"))->scene().files, frames);
  const std::string json = write("s.json", R"({"static": "o.obj", "frames": [
      {"file": "f_1.obj"}, {"file": "f_2.obj"}]})");
  for (const bool preload : {false, true})
    EXPECT_EQ(load_animation(json, {.preload = preload})->scene().files,
              paths({"s.json", "o.obj", "m/gone.png", "m/o.mtl", "f_1.obj", "f_2.obj"}));
}

TEST_F(Files, StayWithAScenePackedOrCut) {
  const std::string scene = gltf();
  BlockList held, outer;
  const Names files = cut_into_blocks(load_scene(scene), &held).files;
  EXPECT_EQ(files, load_scene(scene).files);
  const auto rest = pack_file(scene, &outer, {.triangles_at_once = 1, .beside = path("x")});
  ASSERT_TRUE(rest.has_value());
  EXPECT_EQ(rest->files, files);
  BlockFileWriter writer(path("x.rsb"));
  writer.finish(cut_into_blocks(load_scene(scene), &writer));
  EXPECT_EQ(BlockFile(path("x.rsb")).scene().files, paths({"x.rsb"}));
}

}  // namespace
}  // namespace raysheaf::test
