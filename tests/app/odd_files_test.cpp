// Invalid and unusual files from the test suites of other readers, through the whole program: each
// gives an image or one sentence, within seconds and a gigabyte.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/process.h"
#include "tests/support/read_png.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

constexpr std::size_t kMostMemory = std::size_t{1} << 30;
// CPU seconds, because other programs may run at the same time.
constexpr const char* kMostSeconds = "10";

std::vector<std::filesystem::path> scene_files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    for (const char* known : {".gltf", ".glb", ".obj", ".ply", ".stl"}) {
      if (ending == known && entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Expects one line by the program that names the file.
void expect_a_sentence(const std::string& told, const std::string& name) {
  EXPECT_TRUE(told.starts_with("raysheaf: ")) << told;
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1) << told;
  EXPECT_NE(told.find(name), std::string::npos) << told;
}

/// Whether the program wrote an image. It is killed when its time is up.
bool renders(const std::filesystem::path& file) {
  SCOPED_TRACE(file);
  const TemporaryFolder folder;
  const Finished finished =
      run_program({"sh", "-c", R"(ulimit -t "$0" && exec "$@")", kMostSeconds, RAYSHEAF_APP,
                   "render", file.string(), "-o", "picture.png", "--size", "64x64", "--primary",
                   "trace", "--threads", "1", "-q"},
                  folder.path());
  EXPECT_LE(finished.memory_bytes, kMostMemory);
  EXPECT_EQ(finished.out, "");
  if (finished.code == 0) {
    EXPECT_EQ(finished.err, "");
    EXPECT_NO_THROW(EXPECT_EQ(read_png(folder.file("picture.png")).rgba.size(), 4u * 64u * 64u));
  } else {
    EXPECT_EQ(finished.code, 1) << finished.err;
    expect_a_sentence(finished.err, file.filename().string());
    EXPECT_TRUE(folder.names().empty());
  }
  return finished.code == 0;
}

/// A test suite's files, and how many of them must give an image.
struct Suite {
  const char* folder;
  std::ptrdiff_t pictures;
};

/// Each suite is a separate test, so that ctest can run two at once.
class OddFiles : public ::testing::TestWithParam<Suite> {};

TEST_P(OddFiles, GiveAPictureOrASentence) {
  RAYSHEAF_SCENE_OR_SKIP(folder, std::string("bad_inputs/") + GetParam().folder);
  const auto files = scene_files_below(folder);
  EXPECT_GE(std::count_if(files.begin(), files.end(), renders), GetParam().pictures)
      << "of " << files.size();
}

INSTANTIATE_TEST_SUITE_P(Suites, OddFiles,
                         ::testing::Values(Suite{"assimp_invalid", 1}, Suite{"gltf_assimp", 2},
                                           Suite{"gltf_tinygltf", 9},
                                           Suite{"gltf_tinygltf_tests", 0},
                                           Suite{"gltf_validator_base", 6}, Suite{"obj_assimp", 17},
                                           Suite{"obj_tinyobjloader", 37}, Suite{"ply_assimp", 4}),
                         [](const auto& test) { return std::string(test.param.folder); });

}  // namespace
}  // namespace raysheaf::test
