// Every scene that is there: good ones load with the known numbers, bad ones end in one `Error`.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

bool is_scene(const std::filesystem::path& path) {
  static const std::set<std::string> kEndings = {".gltf", ".glb", ".obj", ".ply", ".stl"};
  return kEndings.count(path.extension().string()) > 0;
}

std::vector<std::string> scenes_below(const std::string& folder) {
  std::vector<std::string> result;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && is_scene(entry.path())) result.push_back(entry.path().string());
  }
  std::sort(result.begin(), result.end());
  return result;
}

void expect_usable(const SceneDescription& scene, const std::string& path) {
  EXPECT_NO_THROW(validate(scene)) << path;
  EXPECT_GT(scene.triangle_count(), 0u) << path;
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_FALSE(mesh.triangles.empty()) << path;
    for (const Vec3& n : mesh.normals) {
      ASSERT_NEAR(n.x * n.x + n.y * n.y + n.z * n.z, 1, 1e-4) << path;
    }
  }
  for (const std::string& warning : scene.warnings) {
    EXPECT_TRUE(warning.ends_with(".")) << path << ": " << warning;
  }
}

TEST(Sweep, BadInputsLoadOrSayWhy) {
  RAYSHEAF_SCENE_OR_SKIP(folder, "bad_inputs");
  int loaded = 0, refused = 0;
  for (const std::string& path : scenes_below(folder)) {
    try {
      expect_usable(load_scene(path), path);
      ++loaded;
    } catch (const Error& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(path)) << what;
      EXPECT_NE(error.code(), ErrorCode::kInternal) << what;
      EXPECT_FALSE(error.sentence().empty()) << what;
      EXPECT_EQ(what.find('\n'), what.npos) << what;
      EXPECT_LT(error.sentence().size(), 400u) << what;
      ++refused;
      if (std::getenv("RAYSHEAF_VERBOSE") != nullptr) std::printf("%s\n", what.c_str());
    }
  }
  EXPECT_GT(loaded, 50);
  EXPECT_GT(refused, 50);
}

/// Reads with the file cut off at many lengths, and with bytes changed, must end in `Error` too.
TEST(Sweep, DamagedFilesLoadOrSayWhy) {
  RAYSHEAF_SCENE_OR_SKIP(folder, "gltf_samples");
  const std::string source = folder + "/BoxTextured.glb";
  std::vector<char> bytes(std::filesystem::file_size(source));
  std::FILE* file = std::fopen(source.c_str(), "rb");
  ASSERT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
  std::fclose(file);
  const std::string path =
      (std::filesystem::temp_directory_path() / "raysheaf_damaged.glb").string();
  std::uint32_t random = 1;
  for (int round = 0; round < 400; ++round) {
    std::vector<char> damaged = bytes;
    random = random * 1664525u + 1013904223u;
    if (round % 2 == 0) damaged.resize(random % damaged.size());
    // Most of the head is JSON, where a changed byte means most.
    else
      damaged[random % 2048] = static_cast<char>(random >> 24);
    file = std::fopen(path.c_str(), "wb");
    std::fwrite(damaged.data(), 1, damaged.size(), file);
    std::fclose(file);
    try {
      static_cast<void>(load_scene(path));
    } catch (const Error&) {
    }
  }
  std::filesystem::remove(path);
}

TEST(Sweep, GoodScenesLoad) {
  const auto root = scenes_directory();
  if (root.empty()) GTEST_SKIP() << "no scenes (set RAYSHEAF_SCENES)";
  for (const char* folder : {"gltf_samples", "gltf_animated", "standard_meshes", "cornell_variants",
                             "bitterli_coffee", "bitterli_teapot_full", "cloth_ball"}) {
    if (!std::filesystem::exists(root / folder)) continue;
    for (const std::string& path : scenes_below((root / folder).string())) {
      try {
        const auto start = std::chrono::steady_clock::now();
        const SceneDescription scene = load_scene(path);
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - start;
        expect_usable(scene, path);
        if (std::getenv("RAYSHEAF_VERBOSE") != nullptr) {
          std::printf("%s: %lu triangles, %zu meshes, %.0f ms\n", path.c_str(),
                      scene.triangle_count(), scene.meshes.size(), took.count());
          for (const std::string& warning : scene.warnings) std::printf("  %s\n", warning.c_str());
        }
      } catch (const Error& error) {
        ADD_FAILURE() << error.what();
      }
    }
  }
}

struct Known {
  const char* path;
  std::uint64_t triangles;
  std::size_t meshes, instances;  ///< 0: not known
};

class KnownScenes : public ::testing::TestWithParam<Known> {};

TEST_P(KnownScenes, HaveTheirTriangles) {
  const Known& known = GetParam();
  RAYSHEAF_SCENE_OR_SKIP(path, known.path);
  const SceneDescription scene = load_scene(path);
  EXPECT_EQ(scene.triangle_count(), known.triangles);
  EXPECT_TRUE(known.meshes == 0 || scene.meshes.size() == known.meshes) << scene.meshes.size();
  EXPECT_TRUE(known.instances == 0 || scene.instances.size() == known.instances)
      << scene.instances.size();
  expect_usable(scene, path);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, KnownScenes,
    ::testing::Values(Known{"paper/office.glb", 36308, 0, 299},
                      Known{"paper/cornell.glb", 792, 0, 7}, Known{"paper/sponza.glb", 66450, 1, 1},
                      Known{"sibenik/sibenik.obj", 73564, 1, 1},
                      Known{"bart_kitchen/static.obj", 103343, 307, 307},
                      Known{"bart_kitchen/dynamic_000.obj", 7218, 86, 86},
                      Known{"bart_museum/static.obj", 10668, 0, 0},
                      Known{"bart_museum/dynamic_000.obj", 1024, 0, 0},
                      Known{"cloth_ball/cloth_ball92.ply", 92230, 1, 1},
                      Known{"bitterli_coffee/coffee.glb", 235271, 0, 23},
                      Known{"bitterli_teapot_full/teapot-full.glb", 126744, 0, 5}));

TEST(Sweep, PaperScenesHaveTheirLightAndCamera) {
  for (const char* name : {"paper/office.glb", "paper/cornell.glb", "paper/sponza.glb"}) {
    RAYSHEAF_SCENE_OR_SKIP(path, name);
    const SceneDescription scene = load_scene(path);
    ASSERT_EQ(scene.lights.size(), 1u) << name;
    ASSERT_EQ(scene.cameras.size(), 1u) << name;
    EXPECT_NEAR(scene.cameras[0].y_fov, 1.0471975f, 1e-5f) << name;
  }
}

}  // namespace
}  // namespace raysheaf::test
