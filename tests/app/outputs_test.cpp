// Output files: the program refuses to write a file twice or to overwrite its input, and each file
// keeps its mode and its link.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>

#include "tests/support/gltf_triangle.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

/// Expects one sentence about `place`: a usage error that is reported before the program does
/// anything.
void expect_refused(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                    const std::string& place, const std::string& why) {
  const std::vector<std::string> before = folder.names();
  const Finished finished = raysheaf_app(arguments, folder);
  EXPECT_EQ(finished.code, 2) << finished.err;
  EXPECT_EQ(finished.err, "raysheaf: " + place + ": this output is " + why + "\n");
  EXPECT_EQ(finished.out, "");
  EXPECT_EQ(folder.names(), before);
}

const std::string kTwice = "written twice", kRead = "read, too";

std::vector<std::string> render(const std::string& scene, std::vector<std::string> more) {
  more.insert(more.begin(), {"render", scene, "--size", "16x16", "-q"});
  return more;
}

TEST(Outputs, NoneIsWrittenTwice) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "d");
  fs::create_symlink("x.png", folder.path() / "link.png");
  fs::create_directory_symlink("d", folder.path() / "e");
  const std::string scene = "builtin:cornell";
  for (const char* other : {"x.png", "./x.png", "d/../x.png", "link.png"})
    expect_refused(folder, render(scene, {"-o", "x.png", "--heatmap", other}), other, kTwice);
  expect_refused(folder, render(scene, {"-o", "d/x.png", "-o", "e/x.png"}), "e/x.png", kTwice);
  expect_refused(folder, render(scene, {"-o", folder.file("x.png"), "--heatmap", "x.png"}), "x.png",
                 kTwice);
  expect_refused(folder, {"bench", "ablation", scene, "--json", "j.json", "--csv", "./j.json"},
                 "./j.json", kTwice);
}

TEST(Outputs, FramesDoNotOverwriteEachOther) {
  const TemporaryFolder folder;
  const std::string scene = "builtin:cornell";
  expect_refused(folder,
                 render(scene, {"-o", "f_%d.png", "--heatmap", "f_%01d.png", "--turntable", "2"}),
                 "f_0.png", kTwice);
  // Frame 11 of one output has the name of frame 1 of the other.
  expect_refused(folder,
                 render(scene, {"-o", "f_%d.png", "--heatmap", "f_1%d.png", "--turntable", "12"}),
                 "f_10.png", kTwice);
  EXPECT_EQ(
      raysheaf_app(render(scene, {"-o", "f_%d.png", "--heatmap", "f_1%d.png", "--turntable", "2"}),
                   folder)
          .code,
      0);
}

TEST(Outputs, InputsAreNotOverwritten) {
  const TemporaryFolder folder;
  const std::string scene = "builtin:cornell";
  ASSERT_EQ(raysheaf_app(render(scene, {"-o", "sky.exr"}), folder).code, 0);
  expect_refused(folder, render(scene, {"--env", "sky.exr", "-o", "./sky.exr"}), "./sky.exr",
                 kRead);
  write_file(folder.file("p2.json"), R"({"keys": [
    {"time": 0, "position": [0, 1, 3], "look_at": [0, 1, 0]},
    {"time": 1, "position": [1, 1, 3], "look_at": [0, 1, 0]}]})");
  expect_refused(folder,
                 render(scene, {"--camera-path", "p2.json", "--frames", "0", "-o", "f.png",
                                "--stats", "p2.json"}),
                 "p2.json", kRead);
}

TEST(Outputs, FilesOfTheSceneAreNotOverwritten) {
  const TemporaryFolder folder;
  ASSERT_EQ(raysheaf_app(render("builtin:cornell", {"-o", "a b.png"}), folder).code, 0);
  write_file(folder.file("c.bin"), gltf_triangle_corners());
  write_file(folder.file("c.gltf"), kGltfTriangle);
  expect_refused(folder, render("c.gltf", {"-o", "./a b.png"}), "./a b.png", kRead);
  expect_refused(folder, render("c.gltf", {"--stats", "c.bin"}), "c.bin", kRead);
  expect_refused(folder, render("c.gltf", {"--stats", "c.gltf"}), "c.gltf", "the scene itself");
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
  write_file(folder.file("o.obj"), "mtllib o.mtl\n" + triangle);
  write_file(folder.file("o.mtl"), "newmtl m\nmap_Kd -clamp on a b.png\nmap_d b.png\n");
  write_file(folder.file("b.png"), read_file(folder.file("a b.png")));
  expect_refused(folder, render("o.obj", {"--stats", "o.mtl"}), "o.mtl", kRead);
  expect_refused(folder, render("o.obj", {"-o", "b.png"}), "b.png", kRead);
  write_file(folder.file("f0.obj"), triangle);
  write_file(folder.file("s.json"), R"({"static": "o.obj", "frames": [{"file": "f0.obj"}]})");
  for (const char* name : {"f0.obj", "o.mtl", "b.png"}) {
    expect_refused(folder, render("s.json", {"--stats", name}), name, kRead);
    expect_refused(folder, render("s.json", {"--stats", name, "--frames", "0"}), name, kRead);
  }
  expect_refused(folder, render("f*.obj", {"--stats", "f0.obj"}), "f0.obj", kRead);
  expect_refused(folder, render("o.obj", {"--sequence", "f*.obj", "--stats", "f0.obj"}), "f0.obj",
                 kRead);
}

TEST(Outputs, KeepTheModeOfTheOldFile) {
  const TemporaryFolder folder;
  write_file(folder.file("a.png"), "old");
  ASSERT_EQ(chmod(folder.file("a.png").c_str(), 0600), 0);
  ASSERT_EQ(raysheaf_app(render("builtin:cornell", {"-o", "a.png"}), folder).code, 0);
  struct stat now {};
  ASSERT_EQ(stat(folder.file("a.png").c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 0777, 0600u);
  EXPECT_NE(read_file(folder.file("a.png")), "old");
}

TEST(Outputs, FollowLinks) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "there");
  fs::create_symlink("there/a.png", folder.path() / "a.png");
  for (int turn = 0; turn < 2; ++turn) {  // first without, then with an existing file
    ASSERT_EQ(raysheaf_app(render("builtin:cornell", {"-o", "a.png"}), folder).code, 0);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "a.png"));
    EXPECT_TRUE(fs::is_regular_file(folder.path() / "there" / "a.png"));
  }
  fs::create_symlink("gone/b.png", folder.path() / "b.png");
  const Finished finished = raysheaf_app(render("builtin:cornell", {"-o", "b.png"}), folder);
  EXPECT_EQ(finished.code, 1);
  EXPECT_TRUE(finished.err.starts_with("raysheaf: b.png: cannot write here: ")) << finished.err;
}

TEST(Outputs, ARefusedFrameLeavesNoCheckpoint) {
  const TemporaryFolder folder;
  ASSERT_EQ(raysheaf_app({"pack", "builtin:cornell", "-o", "c.rsb", "-q"}, folder).code, 0);
  const Finished finished = raysheaf_app(
      {"render", "c.rsb", "--memory", "64M", "--resume", "--size", "300x300", "-o", "rz.png"},
      folder);
  EXPECT_EQ(finished.code, 1) << finished.err;
  EXPECT_EQ(folder.names(), std::vector<std::string>{"c.rsb"});
  expect_refused(folder, {"render", "c.rsb", "--resume", "-o", "a.png", "--stats", "a.png.resume"},
                 "a.png.resume", kTwice);
}

}  // namespace
}  // namespace raysheaf::test
