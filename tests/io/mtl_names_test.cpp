// Where files that OBJ and MTL name are found, and which material a name refers to.
#include <dirent.h>
#include <dlfcn.h>

#include <atomic>

#include "tests/io/io_support.h"

namespace {
std::atomic<int> folders_opened = 0;
}

/// Counts the calls of this program, and forwards them to the system's function.
extern "C" DIR* opendir(const char* name) {
  static const auto open = reinterpret_cast<DIR* (*)(const char*)>(dlsym(RTLD_NEXT, "opendir"));
  ++folders_opened;
  return open(name);
}

namespace raysheaf::test {
namespace {

class MtlNames : public IoTest {
 protected:
  static constexpr const char* kFace =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
  /// Writes an image of one texel.
  void image(const std::string& name, std::uint8_t red) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_png({"", 1, 1, {red, 20, 30, 255}}, path(name));
  }
  SceneDescription load(const std::string& head) {
    return load_scene(write("a.obj", head + kFace));
  }
  /// The red channel of the texture of the face's material, or -1.
  static int red_of(const SceneDescription& scene) {
    const Material& material = scene.materials[scene.meshes[0].materials[0]];
    if (material.base_color_texture.texture == kInvalidId) return -1;
    return scene.images[scene.textures[material.base_color_texture.texture].image].rgba[0];
  }
};

TEST_F(MtlNames, AreReadInDoubleQuotes) {
  image("wood 1.png", 7);
  image("map.png", 8);
  write("my lib.mtl", std::string("newmtl m\nmap_Kd \"wood 1.png\"\n"));
  for (const char* line :
       {"mtllib \"my lib.mtl\"\n", "mtllib my lib.mtl\n", "mtllib \"gone.mtl\" \"my lib.mtl\"\n",
        "mtllib \"my lib.mtl\" gone.mtl\n"})
    EXPECT_EQ(red_of(load(line)), 7) << line;
  EXPECT_TRUE(load("mtllib \"my lib.mtl\"\n").warnings.empty());
  for (const char* map : {"map_Kd -s 2 2 1 \"map.png\"", "map_Kd -clamp on  \"map.png\" "}) {
    write("b.mtl", std::string("newmtl m\n") + map + "\n");
    EXPECT_EQ(red_of(load("mtllib b.mtl\n")), 8) << map;
  }
}

TEST_F(MtlNames, OfImagesAreBesideTheLibraryOrTheScene) {
  image("both.png", 1), image("lib/both.png", 2), image("scene.png", 3);
  image("lib/deep/own.png", 4), image("up.png", 5);
  struct Case {
    const char* name;
    int red;
  };
  for (const Case& one : {Case{"both.png", 2}, Case{"scene.png", 3}, Case{"deep/own.png", 4},
                          Case{"deep\\own.png", 4}, Case{"../up.png", 5}, Case{"..\\up.png", 5}}) {
    write("lib/a.mtl", std::string("newmtl m\nmap_Kd ") + one.name + "\n");
    for (const char* library : {"lib/a.mtl", "lib\\a.mtl", "./lib/a.mtl"}) {
      const SceneDescription scene = load(std::string("mtllib ") + library + "\n");
      EXPECT_EQ(red_of(scene), one.red) << one.name << " in " << library;
      EXPECT_TRUE(scene.warnings.empty()) << one.name;
    }
  }
}

TEST_F(MtlNames, OfAnotherCaseAreFoundWhereOneMatches) {
  image("Maps/Wood.PNG", 6), image("twin.png", 7), image("TWIN.png", 8);
  write("Lib.MTL", std::string("newmtl m\nmap_Kd maps\\wood.png\n"));
  const SceneDescription scene = load("mtllib lib.mtl\n");
  EXPECT_EQ(red_of(scene), 6);
  EXPECT_TRUE(warns(scene, "no file \"lib.mtl\"; \"Lib.MTL\" is read instead"));
  EXPECT_TRUE(warns(scene, "\"Wood.PNG\" is read instead"));
  EXPECT_EQ(scene.warnings.size(), 2u);
  write("Lib.MTL", std::string("newmtl m\nmap_Kd twin.png\n"));
  EXPECT_EQ(red_of(load("mtllib Lib.MTL\n")), 7) << "the exact name counts";
  write("Lib.MTL", std::string("newmtl m\nmap_Kd Twin.png\n"));
  EXPECT_EQ(red_of(load("mtllib Lib.MTL\n")), -1) << "ambiguous names are not resolved";
}

TEST_F(MtlNames, ThatLeadOutAreReadFromTheFolder) {
  image("wood.png", 9);
  write("outside.png", std::string("no image"));
  for (const char* name :
       {"C:\\models\\wood.png", "/home/someone/wood.png", "../../wood.png", "D:/maps/WOOD.png"}) {
    write("sub/a.mtl", std::string("newmtl m\nmap_Kd ") + name + "\n");
    const SceneDescription scene = load("mtllib sub/a.mtl\n");
    EXPECT_EQ(red_of(scene), 9) << name;
    EXPECT_TRUE(warns(scene, "\"wood.png\" is read instead")) << name;
  }
  write("sub/a.mtl", std::string("newmtl m\nmap_Kd ../../gone.png\n"));
  EXPECT_TRUE(warns(load("mtllib sub/a.mtl\n"), "does not stay inside"));
}

TEST_F(MtlNames, OfMaterialsAreFoundWhereverTheirLibraryIs) {
  image("t.png", 4);
  write("a.mtl", std::string("newmtl m\nmap_Kd t.png\n"));
  const SceneDescription scene =
      load_scene(write("late.obj", kFace + std::string("mtllib a.mtl\n")));
  EXPECT_EQ(red_of(scene), 4);
  EXPECT_TRUE(scene.warnings.empty());
  const SceneDescription between =
      load_scene(write("b.obj", kFace + std::string("mtllib a.mtl\nusemtl m\nf 3/1 2/1 1/1\n")));
  EXPECT_EQ(between.meshes[0].materials.size(), 1u) << "one material";
}

TEST_F(MtlNames, OfMaterialsThatAreDefinedTwiceMeanTheFirst) {
  write("a.mtl", std::string("newmtl m\nKd 0 0 1\nnewmtl m\nKd 1 0 0\nnewmtl n\nnewmtl n\n"));
  write("b.mtl", std::string("newmtl m\nKd 0 1 0\n"));
  const SceneDescription scene = load("mtllib a.mtl b.mtl\n");
  EXPECT_EQ(scene.materials[scene.meshes[0].materials[0]].base_color.z, 1);
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(warns(scene, "defined more than once (\"m\" and 2 more); the first"));
}

TEST_F(MtlNames, ThatAreMissingListTheirFolderOnce) {
  std::string maps, libraries = "mtllib";
  for (int i = 0; i < 300; ++i) {
    maps += "newmtl m" + std::to_string(i) + "\nmap_Kd gone" + std::to_string(i) + ".png\n";
    libraries += " gone" + std::to_string(i);
  }
  write("a.mtl", maps);
  const int before = folders_opened;
  const SceneDescription scene = load(libraries + "\nmtllib a.mtl\n");
  EXPECT_EQ(folders_opened - before, 1);
  EXPECT_EQ(scene.warnings.size(), 601u);
}

}  // namespace
}  // namespace raysheaf::test
