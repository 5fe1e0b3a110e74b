// Errors print one sentence that names the file or the option, exit with code 1 or 2, and leave no
// files behind.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

// Expects one line from raysheaf that names `place`.
void expect_sentence(const Finished& finished, int code, const std::string& place) {
  EXPECT_EQ(finished.code, code) << finished.err;
  EXPECT_TRUE(finished.err.starts_with("raysheaf: ")) << finished.err;
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  EXPECT_NE(finished.err.find(place), std::string::npos) << place << " in " << finished.err;
  EXPECT_EQ(finished.out, "");
}

// Expects that rendering and listing the file both fail with this place.
void expect_refused(const TemporaryFolder& folder, const std::string& name,
                    const std::string& place) {
  const std::size_t before = folder.names().size();
  expect_sentence(raysheaf_app({"render", name, "-o", "a.png", "--stats", "a.json"}, folder), 1,
                  name);
  const Finished info = raysheaf_app({"info", name}, folder);
  expect_sentence(info, 1, name);
  EXPECT_NE(info.err.find(place), std::string::npos) << place << " in " << info.err;
  EXPECT_EQ(folder.names().size(), before);
}

void expect_usage_error(const std::vector<std::string>& arguments, const std::string& place) {
  const TemporaryFolder folder;
  expect_sentence(raysheaf_app(arguments, folder), 2, place);
  EXPECT_TRUE(folder.names().empty());
}

TEST(Errors, MissingFile) {
  const TemporaryFolder folder;
  expect_refused(folder, "nowhere.glb", "nowhere.glb");
}

TEST(Errors, UnknownEnding) {
  const TemporaryFolder folder;
  write_file(folder.file("scene.txt"), "v 0 0 0\n");
  expect_refused(folder, "scene.txt", "scene.txt");
}

TEST(Errors, FolderInsteadOfAFile) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "folder.glb");
  expect_refused(folder, "folder.glb", "folder.glb");
}

TEST(Errors, TruncatedGlb) {
  const TemporaryFolder folder;
  ASSERT_EQ(raysheaf_app({"scene", "cornell", "-o", "whole.glb"}, folder).code, 0);
  const std::string whole = read_file(folder.file("whole.glb"));
  ASSERT_GT(whole.size(), 1000u);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{3}, std::size_t{12}, std::size_t{19},
                                 std::size_t{200}, whole.size() / 2, whole.size() - 1}) {
    write_file(folder.file("cut.glb"), whole.substr(0, kept));
    expect_refused(folder, "cut.glb", "cut.glb");
  }
}

TEST(Errors, IndexOutOfRange) {
  const TemporaryFolder folder;
  write_file(folder.file("far.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  expect_refused(folder, "far.obj", "far.obj");
  write_file(folder.file("far.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  expect_refused(folder, "far.ply", "far.ply");
}

TEST(Errors, VertexThatIsNotANumber) {
  const TemporaryFolder folder;
  write_file(folder.file("nan.obj"), "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refused(folder, "nan.obj", "nan.obj");
  write_file(folder.file("nan.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n");
  expect_refused(folder, "nan.ply", "nan.ply");
}

TEST(Errors, EmptyScene) {
  const TemporaryFolder folder;
  write_file(folder.file("empty.obj"), "# nothing\n");
  expect_refused(folder, "empty.obj", "empty.obj");
  write_file(folder.file("points.obj"), "v 0 0 0\nv 1 0 0\n");
  expect_refused(folder, "points.obj", "points.obj");
  write_file(folder.file("empty.gltf"), R"({"asset": {"version": "2.0"}})");
  expect_refused(folder, "empty.gltf", "empty.gltf");
}

TEST(Errors, UnknownOptionsAndValues) {
  const std::string scene = "builtin:cornell";
  expect_usage_error({"paint"}, "paint");
  expect_usage_error({"render", scene, "-o", "a.png", "--shiny"}, "--shiny");
  expect_usage_error({"render", "-o", "a.png"}, "SCENE");
  expect_usage_error({"render", scene, "-o", "a.gif"}, "a.gif");
  expect_usage_error({"render", scene, "-o", "a.png", "-o", "a.png"}, "a.png");
  expect_usage_error({"render", scene, "-o", "a.png", "--size", "0x0"}, "--size");
  expect_usage_error({"render", scene, "-o", "a.png", "--size", "512"}, "--size");
  expect_usage_error({"render", scene, "-o", "a.png", "--size", "70000x2"}, "--size");
  expect_usage_error({"render", scene, "-o", "a.png", "--method", "guess"}, "--method");
  expect_usage_error({"render", scene, "-o", "a.png", "--bounces", "-1"}, "--bounces");
  expect_usage_error({"render", scene, "-o", "a.png", "--levels", "0"}, "--levels");
  expect_usage_error({"render", scene, "-o", "a.png", "--branching", "1"}, "--branching");
  expect_usage_error({"render", scene, "-o", "a.png", "--threads", "many"}, "--threads");
  expect_usage_error({"render", scene, "-o", "a.png", "--primary", "guess"}, "--primary");
  expect_usage_error({"render", scene, "-o", "a.png", "--exposure", "0"}, "--exposure");
  expect_usage_error({"render", scene, "-o", "a.png", "--ambient", "1,2"}, "--ambient");
  expect_usage_error({"render", scene, "-o", "a.png", "--device", "abacus"}, "--device");
  expect_usage_error({"render", "builtin:castle", "-o", "a.png"}, "castle");
  expect_usage_error({"scene", "castle", "-o", "a.glb"}, "castle");
  expect_usage_error({"scene", "cornell"}, "-o");
  expect_usage_error({"scene", "cornell", "--triangles", "5K", "-o", "a.glb"}, "--triangles");
  expect_usage_error({"scene", "hall", "--compress", "-o", "a.glb"}, "--compress");
}

TEST(Errors, SentencesSayWhatAndWhere) {
  const std::string scene = "builtin:cornell";
  expect_usage_error({"render", "", "-o", "a.png"}, "SCENE: it is empty");
  expect_usage_error({"pack", "", "-o", "a.rsb"}, "SCENE: it is empty");
  for (const char* option : {"--stats", "--heatmap", "--camera", "--env", "--clip", "--size"})
    expect_usage_error({"render", scene, "-o", "a.png", option, ""},
                       std::string(option) + ": it is empty");
  expect_usage_error({"bench", "paper", "--scenes", ""}, "--scenes: it is empty");
  expect_usage_error({"bench", "ablation", ""}, "SCENE: it is empty");
  expect_usage_error({"manual", "-o", ""}, "--output: it is empty");
  expect_usage_error({"bench", "compare", "--most", "10000"}, "--most: it is only for --growth");
  expect_usage_error({"report", scene, "-o", "a.html", "--samples", "2"},
                     "'--samples' is not an option of raysheaf report");
  expect_usage_error({"bench", "foo"},
                     "'foo' is not a command of bench; the commands are paper, ablation, compare");
  expect_usage_error({"bench"}, "give a command of bench; the commands are paper");
  expect_usage_error({"render", scene, "-o", "a.png", "--memory", "99999999999G"},
                     "'99999999999G' is too large");
  expect_usage_error({"render", scene, "-o", "a.png", "--exposure", "1e39"},
                     "'1e39' is too large or too small for this option");
  expect_usage_error({"render", scene, "-o", "a.png", "--exposure", "bright"},
                     "'bright' is not a number above 0");
}

TEST(Errors, OptionsWithoutEffect) {
  const std::string scene = "builtin:cornell";
  const auto refused = [&](std::vector<std::string> options) {
    const std::string option = options.front();
    options.insert(options.begin(), {"render", scene});
    expect_usage_error(options, option);
    expect_usage_error(options, "has no effect");
  };
  refused({"--time", "1"});
  refused({"--fps", "12"});
  refused({"--fps", "12", "-o", "a_%d.png"});
  refused({"--fps", "12", "-o", "a_%d.png", "--turntable", "2"});
  refused({"--preload"});
  refused({"--levels", "3"});
  refused({"--branching", "4", "--method", "gl10"});
  refused({"--bound", "shaft", "--method", "brute"});
  refused({"--mesh-culling", "on"});
  refused({"--key", "crsh"});
  refused({"--key-bits", "64", "--method", "brute"});
  refused({"--early-out"});
  refused({"--exposure", "2", "-o", "a.exr"});
  refused({"--background", "white", "--heatmap", "h.png"});
  refused({"--bounces", "3", "--no-reflections", "--no-refractions"});
  refused({"--light-size", "1", "--samples", "1"});
  refused({"--aperture", "1", "--samples", "1"});
  expect_usage_error({"report", scene, "-o", "a.html", "--levels", "3", "--method", "dual"},
                     "--levels: it has no effect");
  expect_usage_error({"info", scene, "--json", "--all"}, "--all: it has no effect");
  expect_usage_error({"scene", "--list", "-o", "a.glb"}, "--output: it has no effect");
  expect_usage_error({"scene", "cornell", "-o", "a.glb", "--threads", "2"},
                     "--threads: it has no effect");
}

TEST(Errors, NamesFromElsewhereGetAHint) {
  const std::string scene = "builtin:cornell";
  expect_usage_error({"-v"}, "-V prints the version");
  expect_usage_error({"render", scene, "-v"}, "-q turns them off");
  expect_usage_error({"render", scene, "--width", "640"}, "give both sides, as in --size 640x480");
  expect_usage_error({"render", scene, "--height=480"}, "give both sides, as in --size 640x480");
  expect_usage_error({"render", scene, "--spp", "4"}, "give --samples N");
  expect_usage_error({"render", "--input", "a.glb"}, "the scene is given without an option");
  expect_usage_error({"render", scene, "-o", "out/"}, "'out/' is a folder: give a file");
  expect_usage_error({"render", scene, "-o", "."}, "'.' is a folder: give a file");
  expect_usage_error({"scene", "cornell", "-o", "."}, "such as ./cornell.glb");
  expect_usage_error({"pack", scene, "-o", "."}, "such as ./scene.rsb");
  expect_usage_error({"report", scene, "-o", "."}, "such as ./report.html");
}

TEST(Errors, StandardOutputTakesOneThing) {
  const std::string scene = "builtin:cornell";
  expect_usage_error({"render", scene, "--stats", "-", "-o", "-"}, "--stats: it would mix");
  expect_usage_error({"render", scene, "--stats", "-", "--explain"}, "--explain: it would mix");
  expect_usage_error({"render", scene, "--stats", "-", "-o", "a_%d.png"}, "--stats: '-'");
  expect_usage_error({"verify", "--json", "-"}, "--json: standard output has a table");
  expect_usage_error({"bench", "paper", "--json", "-"}, "--json: standard output has a table");
  expect_usage_error({"bench", "ablation", "--csv", "-"}, "--csv: standard output has a table");
}

TEST(Errors, JsonIsQuotedWhereItIsWrong) {
  const TemporaryFolder folder;
  write_file(folder.file("a.gltf"), R"({"asset": {"version": "2.0"}, x})");
  expect_refused(folder, "a.gltf", "last read: '\"2.0\"}, x'; expected string literal");
}

TEST(Errors, AllEndingsAreNamed) {
  const TemporaryFolder folder;
  write_file(folder.file("a.txt"), "text");
  write_file(folder.file("a.rsb"), "text");
  expect_sentence(raysheaf_app({"info", "a.txt"}, folder), 1, ".rsb (blocks) or .json");
  expect_sentence(raysheaf_app({"report", "a.rsb", "-o", "a.html"}, folder), 1, "block files");
}

TEST(Errors, NoDeviceInThisMachine) {
  const TemporaryFolder folder;
  const Finished on_cuda = raysheaf_app(
      {"render", "builtin:cornell", "-o", "a.png", "--size", "16x16", "--device", "cuda"}, folder);
  if (on_cuda.code == 0) GTEST_SKIP() << "there is a CUDA device";
  expect_sentence(on_cuda, 1, "CUDA device");
}

TEST(Errors, BenchOfAMissingDevice) {
  const TemporaryFolder folder;
  const Finished bench = raysheaf_app(
      {"bench", "gpu", "-q", "--scene", "builtin:cornell", "--size", "16x16", "--runs", "1"},
      folder);
  if (bench.code == 0) GTEST_SKIP() << "there is a CUDA device";
  expect_sentence(bench, 1, "CUDA device");
}

TEST(Errors, MethodThatNoDeviceSupports) {
  const TemporaryFolder folder;
  expect_sentence(raysheaf_app({"render", "builtin:cornell", "-o", "a.png", "--device", "cuda",
                                "--method", "gl10"},
                               folder),
                  1, "");
}

TEST(Errors, MissingCamera) {
  const TemporaryFolder folder;
  for (const char* camera : {"nobody", "99"}) {
    expect_sentence(raysheaf_app({"render", "builtin:cornell", "-o", "a.png", "--size", "16x16",
                                  "--camera", camera},
                                 folder),
                    1, camera);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(Errors, OutputThatCannotBeWritten) {
  const TemporaryFolder folder;
  write_file(folder.file("file"), "not a folder");
  std::filesystem::create_directory(folder.path() / "folder.png");
  for (const char* output : {"nowhere/a.png", "file/a.png", "/proc/a.png"}) {
    expect_sentence(raysheaf_app({"render", "builtin:cornell", "-o", output}, folder), 1, output);
  }
  expect_sentence(raysheaf_app({"render", "builtin:cornell", "-o", "folder.png"}, folder), 2,
                  "'folder.png' is a folder: give a file");
  expect_sentence(
      raysheaf_app({"render", "builtin:cornell", "-o", "a.png", "--stats", "no/s.json"}, folder), 1,
      "no/s.json");
  expect_sentence(raysheaf_app({"scene", "cornell", "-o", "nowhere/a.glb"}, folder), 1,
                  "nowhere/a.glb");
  EXPECT_EQ(folder.names().size(), 2u);  // the two original files
}

TEST(Errors, DevicesAreNotReplacedByFiles) {
  const TemporaryFolder folder;
  expect_sentence(raysheaf_app({"render", "builtin:cornell", "--stats", "/dev/null"}, folder), 1,
                  "/dev/null");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(Errors, FullStandardOutput) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const TemporaryFolder folder;
  const std::string app = RAYSHEAF_APP;
  expect_sentence(
      run_program({"sh", "-c", "'" + app + "' info builtin:cornell > /dev/full"}, folder.path()), 1,
      "standard output");
}

TEST(Errors, ClosedStandardOutput) {
  const TemporaryFolder folder;
  const std::string app = RAYSHEAF_APP;
  for (const char* arguments : {"info builtin:cornell", "--help", "scene --list"})
    expect_sentence(run_program({"sh", "-c", "'" + app + "' " + arguments + " >&-"}, folder.path()),
                    1, "standard output");
}

TEST(Errors, AClosedPipeIsNotAnError) {
  const TemporaryFolder folder;
  const std::string app = RAYSHEAF_APP;
  const Finished finished = run_program(
      {"bash", "-c",
       "set -o pipefail; '" + app + "' info builtin:office --json | head -c 10 > /dev/null"},
      folder.path());
  EXPECT_EQ(finished.code, 0);
  EXPECT_EQ(finished.err, "");
}

TEST(Errors, InterruptLeavesNothing) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"render", "builtin:atrium", "-o", "a.png", "--method", "brute", "--size",
                    "2048x2048", "--quiet", "--primary", "trace"},
                   folder, std::chrono::milliseconds(1500));
  expect_sentence(finished, 130, "interrupted");
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace raysheaf::test
