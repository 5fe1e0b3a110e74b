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

/// The image between the bar and the notes.
Image without_status(Image image) {
  const std::size_t bar = 30, notes = 60, row = std::size_t{4} * image.width;
  image.height -= static_cast<std::uint32_t>(bar + notes);
  image.rgba.erase(image.rgba.begin(), image.rgba.begin() + static_cast<std::ptrdiff_t>(bar * row));
  image.rgba.resize(row * image.height);
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
      "press v\nright-method rah\nassert split is on\nwait-for-refined\n"
      "assert right-rays > 0\nassert tests is-not 0\nscreenshot split.png\npress v\n"
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

/// The laboratory stays closed; a scene fills the window below the bar.
TEST_F(WindowTest, BeginsWithTheBarAlone) {
  const Finished finished = play(
      "assert bar is on\nassert panel is off\nassert plots is off\nassert help is off\n"
      "wait-for-refined\nassert shown is picture\nscreenshot clean.png\n"
      "bar off\nscreenshot bare.png\nbar on\npress tab\nassert panel is on\n");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(difference(without_status(picture("clean.png")), without_status(picture("bare.png"))),
            0);
  EXPECT_GT(difference(picture("clean.png"), picture("bare.png")), 0.02);
}

TEST_F(WindowTest, OpensWithoutASceneAndLoadsFromItsDialog) {
  write_file(folder.file("box.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  write_file(folder.file("s"),
             "size 420 300\nsamples 1\nassert scene is nothing\nscreenshot start.png\n"
             "press ctrl+o\nassert dialog-entry is box.obj\nscreenshot dialog.png\n"
             "press enter\nassert dialog is closed\nwait-for-picture\nassert triangles is 1\n"
             "press ctrl+o\npress escape\nwait-for-refined\nscreenshot box.png\n");
  const Finished finished = raysheaf_app({"view", "--script", "s", "--size", "420x300"}, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_GT(difference(picture("start.png"), picture("dialog.png")), 0.1);
  EXPECT_GT(difference(picture("start.png"), picture("box.png")), 0.1);
  const Finished viewpoint = raysheaf_app({"view", "--view", "top", "--script", "s"}, folder);
  EXPECT_EQ(viewpoint.code, 2);
  EXPECT_NE(viewpoint.err.find("needs a scene"), std::string::npos) << viewpoint.err;
}

TEST_F(WindowTest, BeginsFromTheViewOfTheCommandLine) {
  write_file(folder.file("s"), "assert pitch < -89\nassert orthographic is on\nassert up is z\n");
  const Finished finished =
      raysheaf_app({"view", "builtin:cornell", "--script", "s", "--view", "top", "--up", "z",
                    "--orthographic", "--size", "320x240"},
                   folder);
  EXPECT_EQ(finished.code, 0) << finished.err;
}

/// Runs all drawing code of the preview and of the lines.
TEST_F(WindowTest, DrawsThePreviewAndLines) {
  const Finished finished = play(
      "wait-for-refined\nscreenshot plain.png\n"
      "press z\nscreenshot edges.png\npress z\n"
      "press x\nscreenshot axes.png\npress x\nscreenshot again.png\n"
      "press 1\nassert yaw < 0.001\npress 5\nassert orthographic is on\nwait-for-refined\n"
      "press g\npress z\npress x\nscreenshot front.png\n"
      "press z\npress x\npress g\npress 9\nwait-for-refined\nscreenshot iso.png\n"
      "press g\nscreenshot grid.png\npress z\n"
      "orbit 20 10\nwait-for-refined\nbackground white\nwait-for-refined\nscreenshot white.png\n"
      "press 7\nwait-for-refined\nassert pitch < -89\nmeasure-latency 0.5\n"
      "assert least-part >= 0.25\nmoving trace\nmeasure-latency 0.5\nassert least-part >= 0.25\n"
      "split on\nwait-for-refined\nscreenshot split.png\n",
      "builtin:office");
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Image plain = without_status(picture("plain.png"));
  EXPECT_GT(difference(plain, without_status(picture("edges.png"))), 0.01);
  EXPECT_GT(difference(picture("iso.png"), picture("grid.png")), 0.01);
  EXPECT_EQ(difference(plain, without_status(picture("again.png"))), 0);
  EXPECT_GT(difference(picture("plain.png"), picture("axes.png")), 0.001);
  EXPECT_NE(finished.out.find(" show the preview"), std::string::npos) << finished.out;
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
      "assert latency-median > 0\nassert latency-largest < 5000\nassert least-part >= 0.25\n");
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
