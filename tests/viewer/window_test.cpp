// `raysheaf view` as a user starts it, on a virtual display.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "display.h"
#include "tests/support/read_png.h"

namespace raysheaf::test {
namespace {

bool has_viewer() {
  return std::filesystem::exists(
      std::filesystem::path(RAYSHEAF_APP).replace_filename("raysheaf-view"));
}

class WindowTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_viewer()) GTEST_SKIP() << "this build has no viewer";
    if (display_.display.empty()) GTEST_SKIP() << "there is no Xvfb";
    display_variable_.emplace("DISPLAY", display_.display.c_str());
    config_.emplace("XDG_CONFIG_HOME", folder.file("config").c_str());
  }
  /// Runs `raysheaf view SCENE --script` with those lines.
  Finished play(const std::string& lines, const std::string& scene = "builtin:cornell") {
    write_file(folder.file("script"), "size 420 300\nplots off\npanel off\nsamples 2\n" + lines);
    return raysheaf_app({"view", scene, "--script", "script", "--size", "420x300"}, folder);
  }
  Image picture(const std::string& name) { return read_png(folder.file(name)); }

  const TemporaryFolder folder;

 private:
  const VirtualDisplay display_;
  std::optional<ScopedVariable> display_variable_, config_;
};

/// The fraction of the bytes that differ.
double difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  std::size_t other = 0;
  for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
    other += a.rgba[i] != b.rgba[i] ? 1 : 0;
  return static_cast<double>(other) / static_cast<double>(a.rgba.size());
}

/// The image above the status line and the notes.
Image without_status(Image image) {
  image.height -= 60;
  image.rgba.resize(std::size_t{4} * image.width * image.height);
  return image;
}

TEST_F(WindowTest, PicturesDifferAsTheyShould) {
  const Finished finished = play(
      "wait-for-refined\nscreenshot dual.png\n"
      "method crsh\nwait-for-refined\nscreenshot crsh.png\n"
      "orbit 20 5\nwait-for-refined\nscreenshot orbit.png\norbit -20 -5\n"
      "overlay tests\nwait-for-refined\nscreenshot crsh_tests.png\n"
      "method dual\nwait-for-refined\nscreenshot dual_tests.png\n"
      "overlay normal\nwait-for-refined\nscreenshot normal.png\n"
      "overlay beauty\npress f1\nwait-for-refined\nscreenshot help.png\npress f1\n"
      "panel on\nplots on\nwait-for-refined\nscreenshot panels.png\n");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const Image dual = without_status(picture("dual.png"));
  EXPECT_EQ(dual.width, 420u);
  EXPECT_EQ(difference(dual, without_status(picture("crsh.png"))), 0);
  for (const char* other :
       {"orbit.png", "crsh_tests.png", "dual_tests.png", "normal.png", "help.png", "panels.png"})
    EXPECT_GT(difference(dual, without_status(picture(other))), 0.1) << other;
  EXPECT_GT(difference(without_status(picture("crsh_tests.png")),
                       without_status(picture("dual_tests.png"))),
            0.1);
}

/// Nothing is compared: the test runs all drawing code under the sanitizers.
TEST_F(WindowTest, EveryMethodAndOverlayIsShown) {
  std::string lines = "wait-for-picture\n";
  for (const char* method : {"rah", "crsh", "gl10", "dual"})
    lines += std::string("method ") + method + "\norbit 10 5\nwait-for-picture\n";
  for (const char* overlay : {"tests", "normal", "albedo", "shadow", "ids"})
    lines +=
        std::string("overlay ") + overlay + "\nwait-for-picture\nscreenshot " + overlay + ".png\n";
  const Finished finished = play(lines);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  EXPECT_GT(difference(picture("albedo.png"), picture("ids.png")), 0.1);
}

TEST_F(WindowTest, UserInputMovesPicksSplitsAndSaves) {
  const Finished finished = play(
      "wait-for-refined\nclick 0.5 0.5\nwait 0.1\nassert pick-mesh is-not nothing\n"
      "assert pick-t > 0\nprint pick-mesh\nscreenshot picked.png\npress escape\n"
      "drag 0.5 0.5 0.7 0.5\nassert yaw is-not 0\npress r\n"
      "press x\nright-method rah\nassert split is on\nwait-for-refined\n"
      "assert right-rays > 0\nassert tests is-not 0\nscreenshot split.png\npress x\n"
      "bundle on\nbundle-rays reflection\nmethod crsh\nmove 0.4 0.6\nwait-for-bundle\n"
      "assert bundle-size >= 1\nassert bundle-bounds is 2\nscreenshot bundle.png\nbundle off\n"
      "hold w 0.2\nwait-for-picture\nsave saved.png\nassert note contains wrote\n"
      "size 300 260\nwait-for-refined\nassert picture-width is 300\nscreenshot small.png\n");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.out.substr(0, 10), "pick-mesh ");
  EXPECT_EQ(picture("saved.png").width, 420u);
  EXPECT_EQ(picture("small.png").width, 300u);
  EXPECT_GT(difference(picture("picked.png"), picture("bundle.png")), 0.005);
}

TEST_F(WindowTest, StaysOpenForABadFile) {
  write_file(folder.file("bad.glb"), "this is no scene");
  const Finished finished = play(
      "wait-for-picture\ndrop bad.glb\nassert note contains bad.glb\nassert scene is cornell\n"
      "drop nowhere.obj\nassert note contains nowhere.obj\nwait-for-refined\n"
      "drop builtin:office\nassert scene is office\nwait-for-picture\n");
  EXPECT_EQ(finished.code, 0) << finished.err;
}

TEST_F(WindowTest, ErrorsAreOneSentenceWithFileAndLine) {
  struct Case {
    std::string lines, said;
    int code;
  };
  for (const auto& [lines, said, code] : std::vector<Case>{
           {"jump\n", "raysheaf: script:5: 'jump' is neither a setting", 1},
           {"wait-for-picture\nassert rays < 0\n",
            "raysheaf: script:6: this comparison fails: rays < 0; it is ", 1},
           {"print weather\n", "raysheaf: script:5: 'weather' is neither a setting", 1}}) {
    const Finished finished = play(lines);
    EXPECT_EQ(finished.code, code);
    EXPECT_EQ(finished.err.substr(0, said.size()), said);
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }
  const Finished missing = play("", "nowhere.glb");
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("nowhere.glb"), std::string::npos) << missing.err;
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
}

TEST_F(WindowTest, RemembersInItsFileAndIgnoresABrokenOne) {
  write_file(folder.file("s"), "wait-for-picture\nmethod rah\nbounces 1\n");
  const std::vector<std::string> start = {"view", "builtin:cornell", "--script",
                                          "s",    "--settings",      "kept"};
  ASSERT_EQ(raysheaf_app(start, folder).code, 0);
  write_file(folder.file("s"), "assert method is rah\nassert bounces is 1\n");
  EXPECT_EQ(raysheaf_app(start, folder).code, 0);
  write_file(folder.file("kept"), "method fast\n");
  write_file(folder.file("s"), "assert method is dual\n");
  const Finished finished = raysheaf_app(start, folder);
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.err.find("settings are ignored: kept:1: method 'fast'"), std::string::npos)
      << finished.err;
}

TEST_F(WindowTest, ReportsAnOpenGlThatIsTooOld) {
  const ScopedVariable old("MESA_GL_VERSION_OVERRIDE", "2.1");
  const Finished finished = play("");
  EXPECT_EQ(finished.code, 1);
  EXPECT_NE(finished.err.find("OpenGL 3.3"), std::string::npos) << finished.err;
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
}

TEST_F(WindowTest, ScreenshotAloneWaitsForTheWholePicture) {
  write_file(folder.file("kept"), "samples 3\n");
  const Finished finished = raysheaf_app({"view", "builtin:cornell", "--screenshot", "one.png",
                                          "--size", "320x240", "--settings", "kept"},
                                         folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(picture("one.png").width, 320u);
}

TEST_F(WindowTest, ScreenshotIsTakenWhereAScriptQuits) {
  write_file(folder.file("s"), "wait-for-picture\nquit\n");
  const std::vector<std::string> start = {"view",         "builtin:cornell", "--script", "s",
                                          "--screenshot", "end.png",         "--size",   "320x240"};
  const Finished finished = raysheaf_app(start, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(picture("end.png").width, 320u);
}

TEST_F(WindowTest, MeasuresHowLongInputWaits) {
  const Finished finished = play(
      "wait-for-picture\nmeasure-latency 1\nassert latency-events > 20\n"
      "assert latency-median > 0\nassert latency-largest < 5000\n");
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.out.find("input to present: "), std::string::npos) << finished.out;
}

TEST(Display, AMissingOneIsReportedInASentence) {
  if (!has_viewer()) GTEST_SKIP() << "this build has no viewer";
  const TemporaryFolder folder;
  const ScopedVariable none("DISPLAY", nullptr), nor("WAYLAND_DISPLAY", nullptr);
  const Finished finished = raysheaf_app({"view", "builtin:cornell"}, folder);
  EXPECT_EQ(finished.code, 1);
  EXPECT_EQ(finished.err.substr(0, 33), "raysheaf: cannot open a window: X");
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
}

TEST(Viewer, AMissingViewerIsReportedInASentence) {
  const TemporaryFolder folder;
  const std::string alone = folder.file("raysheaf");
  std::filesystem::copy_file(RAYSHEAF_APP, alone);
  const Finished finished = run_program({alone, "view", "builtin:cornell"}, folder.path());
  EXPECT_EQ(finished.code, 1);
  EXPECT_EQ(finished.err.substr(0, 38), "raysheaf: the viewer is not available:");
  EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
}

}  // namespace
}  // namespace raysheaf::test
