// Loads every installed scene: valid ones have the known counts, invalid ones give one `Error`.
#include <gtest/gtest.h>

#include <cctype>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "tests/io/io_support.h"
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

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
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

/// A truncated file, or one with some bytes changed.
std::string damaged(std::string bytes, int round, std::uint32_t& random) {
  const auto next = [&] { return random = random * 1664525u + 1013904223u, random >> 8; };
  if (round % 3 == 0) {
    bytes.resize(next() % bytes.size());
    return bytes;
  }
  // Most headers lie in the first bytes, where changes matter most.
  for (int i = 0; i < 1 + round % 4; ++i) {
    const std::size_t range =
        round % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 2048);
    bytes[next() % range] =
        round % 5 == 0 ? "0-9/ \n{[\"e"[next() % 10] : static_cast<char>(next());
  }
  return bytes;
}

using DamagedFiles = IoTest;

TEST_F(DamagedFiles, LoadOrSayWhy) {
  std::uint32_t random = 1;
  for (const char* name :
       {"gltf_samples/BoxTextured.glb",
        "gltf_samples/SimpleSparseAccessor/SimpleSparseAccessor.gltf",
        "gltf_samples/Cameras/Cameras.gltf", "cornell_variants/mcguire/CornellBox-Original.obj",
        "cornell_variants/mcguire/CornellBox-Original.mtl", "cloth_ball/t0.ply"}) {
    RAYSHEAF_SCENE_OR_SKIP(source, name);
    const std::filesystem::path folder = std::filesystem::path(source).parent_path();
    std::string scene = std::filesystem::path(source).filename().string();
    for (const char* beside : {"SimpleSparseAccessor.bin", "simpleSquare.bin",
                               "CornellBox-Original.mtl", "CornellBox-Original.obj"}) {
      if (std::filesystem::exists(folder / beside)) write(beside, contents(folder / beside));
    }
    const std::string bytes = contents(source);
    for (int round = 0; round < 150; ++round) {
      write(scene, damaged(bytes, round, random));
      try {
        static_cast<void>(
            load_scene(path(scene.ends_with(".mtl") ? "CornellBox-Original.obj" : scene)));
      } catch (const Error& error) {
        EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
      }
    }
  }
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
                      Known{"bitterli_teapot_full/teapot-full.glb", 126744, 0, 5}),
    [](const auto& test) {
      std::string name = test.param.path;
      for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
      return name;
    });

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
