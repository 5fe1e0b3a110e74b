// Environments from files, and the errors for truncated or invalid files.
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/io/io_support.h"
#include "tests/support/pictures.h"

namespace raysheaf::test {
namespace {

using enum ErrorCode;
using EnvironmentFile = IoTest;

void expect_no_environment(const std::string& path, ErrorCode code, const std::string& words) {
  try {
    static_cast<void>(load_environment(path));
    ADD_FAILURE() << path << " was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_EQ(error.place(), path);
    EXPECT_NE(error.sentence().find(words), std::string::npos) << error.what();
  }
}

const std::string kHead = "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n\n";

std::string pixels(std::initializer_list<std::array<int, 4>> list) {
  std::string text;
  for (const auto& pixel : list) {
    for (const int byte : pixel) text += static_cast<char>(byte);
  }
  return text;
}

/// A row of 8 pixels in the new run-length encoding: red 1 to 8, green all 5, blue all 0, one
/// exponent.
std::string row_of_runs() {
  std::string row = pixels({{2, 2, 0, 8}});
  row += static_cast<char>(8);
  for (char c = 1; c <= 8; ++c) row += c;
  for (const int value : {5, 0, 136}) {
    row += static_cast<char>(128 + 8);
    row += static_cast<char>(value);
  }
  return row;
}

TEST_F(EnvironmentFile, RadianceIsReadPlainAndInRuns) {
  write("plain.hdr",
        kHead + "-Y 1 +X 3\n" + pixels({{128, 64, 0, 129}, {255, 0, 1, 136}, {9, 9, 9, 0}}));
  const Environment plain = load_environment(path("plain.hdr"));
  EXPECT_EQ(plain.width, 3u);
  EXPECT_EQ(plain.height, 1u);
  EXPECT_EQ(plain.name, "plain.hdr");
  EXPECT_EQ(plain.radiance[0].x, 1);
  EXPECT_EQ(plain.radiance[0].y, 0.5f);
  EXPECT_EQ(plain.radiance[1].x, 255);
  EXPECT_EQ(plain.radiance[1].z, 1);
  EXPECT_EQ(plain.radiance[2].x, 0);  // black, because the exponent is 0

  write("runs.hdr", kHead + "-Y 2 +X 8\n" + row_of_runs() + row_of_runs());
  const Environment runs = load_environment(path("runs.hdr"));
  ASSERT_EQ(runs.radiance.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_EQ(runs.radiance[i].x, static_cast<float>(i % 8 + 1));
    EXPECT_EQ(runs.radiance[i].y, 5);
    EXPECT_EQ(runs.radiance[i].z, 0);
  }

  write("old.hdr", "#?RGBE\nEXPOSURE=2\nEXPOSURE= 2\n\n-Y 1 +X 5\n" +
                       pixels({{8, 4, 4, 136}, {1, 1, 1, 3}, {4, 4, 4, 136}}));
  const Environment old = load_environment(path("old.hdr"));
  EXPECT_EQ(old.radiance[3].x, 2);
  EXPECT_EQ(old.radiance[4].x, 1);
}

TEST_F(EnvironmentFile, OpenExrIsReadAsItWasWritten) {
  std::vector<float> r, g, b;
  for (int i = 0; i < 12; ++i) {
    r.push_back(static_cast<float>(i) * 1000.5f);
    g.push_back(static_cast<float>(i));
    b.push_back(0.25f);
  }
  write_exr(4, 3, {{"R", r}, {"G", g}, {"B", b}}, path("sky.exr"));
  const Environment sky = load_environment(path("sky.exr"));
  ASSERT_EQ(sky.radiance.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(sky.radiance[i].x, r[i]);
    EXPECT_EQ(sky.radiance[i].y, g[i]);
    EXPECT_EQ(sky.radiance[i].z, b[i]);
  }
  EXPECT_TRUE(sky.warnings.empty());
}

TEST_F(EnvironmentFile, RadianceThatCannotBeIsClampedWithAWarning) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<float> one(4, 1);
  const auto red = [&](const std::vector<float>& values) {
    write_exr(2, 2, {{"R", values}, {"G", one}, {"B", one}}, path("sky.exr"));
    const Environment sky = load_environment(path("sky.exr"));
    std::vector<float> read;
    for (const Vec3& v : sky.radiance) read.push_back(v.x);
    return std::pair(read, sky.warnings.empty() ? "" : sky.warnings.at(0));
  };
  const auto [clamped, warning] = red({-1, NAN, kInfinity, 2});
  EXPECT_EQ(clamped, (std::vector<float>{0, 0, 65504, 2}));
  EXPECT_NE(warning.find("sky.exr is clamped: 1 pixel is negative, 2 pixels are not finite"),
            std::string::npos)
      << warning;
  EXPECT_EQ(red({-kInfinity, kInfinity, 1e6f, 2}).first, (std::vector<float>{0, 1e6f, 1e6f, 2}));
  write("sky.hdr", "#?RADIANCE\nEXPOSURE=1e-9\n\n-Y 1 +X 1\n" + pixels({{255, 0, 0, 255}}));
  const Environment bright = load_environment(path("sky.hdr"));
  EXPECT_EQ(bright.radiance[0].x, 65504);
  EXPECT_EQ(bright.warnings.size(), 1u);
}

TEST_F(EnvironmentFile, RadianceIsReadInAllOrientations) {
  // three columns and two rows, seen upright: 1 2 3 over 4 5 6
  const struct {
    const char* size;
    std::array<int, 6> stored;
  } cases[] = {{"-Y 2 +X 3", {1, 2, 3, 4, 5, 6}}, {"-Y 2 -X 3", {3, 2, 1, 6, 5, 4}},
               {"+Y 2 +X 3", {4, 5, 6, 1, 2, 3}}, {"+Y 2 -X 3", {6, 5, 4, 3, 2, 1}},
               {"+X 3 -Y 2", {1, 4, 2, 5, 3, 6}}, {"+X 3 +Y 2", {4, 1, 5, 2, 6, 3}},
               {"-X 3 -Y 2", {3, 6, 2, 5, 1, 4}}, {"-X 3 +Y 2", {6, 3, 5, 2, 4, 1}}};
  for (const auto& one : cases) {
    std::string file = kHead + one.size + "\n";
    for (const int value : one.stored) file += pixels({{value, 0, 0, 136}});
    write("turned.hdr", file);
    const Environment map = load_environment(path("turned.hdr"));
    EXPECT_EQ(map.width, 3u) << one.size;
    ASSERT_EQ(map.radiance.size(), 6u) << one.size;
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(map.radiance[i].x, static_cast<float>(i + 1)) << one.size;
  }
}

TEST_F(EnvironmentFile, EveryCutIsRefused) {
  const std::string whole = kHead + "-Y 2 +X 8\n" + row_of_runs() + row_of_runs();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write("cut.hdr", whole.substr(0, length));
    EXPECT_THROW((void)load_environment(path("cut.hdr")), Error) << length;
  }
  write("cut.hdr", whole.substr(0, whole.size() - 1));
  expect_no_environment(path("cut.hdr"), kInvalidData, "the file ends within row 1");
}

TEST_F(EnvironmentFile, ErrorsNameTheirPlace) {
  const auto refused = [&](const std::string& text, ErrorCode code, const std::string& sentence) {
    write("wrong.hdr", text);
    expect_no_environment(path("wrong.hdr"), code, sentence);
  };
  refused("P6\n1 1\n", kInvalidData, "#?RADIANCE");
  refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", kUnsupported, "32-bit_rle_xyze");
  refused("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", kInvalidData, "EXPOSURE");
  refused(kHead + "+X 1 -X 1\n", kUnsupported, "the size is \"+X 1 -X 1\"");
  refused(kHead + "-Z 1 +X 1\n", kUnsupported, "the size is \"-Z 1 +X 1\"");
  refused(kHead + "-Y 0 +X 1\n", kUnsupported, "the size");
  refused(kHead + "-Y 60000 +X 60000\n", kOutOfMemory, "2^26");
  refused(kHead + "-Y 8000 +X 8000\n", kInvalidData, "too short");
  refused(kHead + "-Y 1 +X 8\n" + pixels({{2, 2, 0, 9}}), kInvalidData, "says that it has 9");
  refused(kHead + "-Y 1 +X 8\n" + pixels({{2, 2, 0, 8}, {137, 1, 1, 1}}), kInvalidData,
          "a run leaves row 0");
  refused(kHead + "-Y 1 +X 2\n" + pixels({{1, 1, 1, 9}}), kInvalidData, "a run leaves row 0");
  write("sky.png", "x");
  expect_no_environment(path("sky.png"), kUnsupported, ".hdr or .exr");
  write("damaged.exr", std::string("\x76\x2f\x31\x01\x02\0\0\0garbage", 15));
  expect_no_environment(path("damaged.exr"), kInvalidData, "");
  write_exr(1, 1, {{"R", {1}}, {"G", {1}}, {"B", {1}}}, path("cut.exr"));
  write("cut.exr", read("cut.exr").substr(0, 100));
  try {
    static_cast<void>(load_environment(path("cut.exr")));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_TRUE(error.sentence().starts_with("is truncated or damaged: ")) << error.sentence();
  }
  expect_no_environment(path("nowhere.hdr"), kNotFound, "");
}

TEST_F(EnvironmentFile, SizesOfLightsAndLensesGoThroughGltf) {
  SceneDescription scene = ball_on_floor();
  scene.lights[0].radius = 0.25f;
  Light lamp;
  lamp.type = Light::Type::kRectangle;
  lamp.position = {1, 5, 2};
  lamp.direction = {0, -1, 0};
  lamp.right = {0.6f, 0, 0.8f};
  lamp.width = 2;
  lamp.height = 0.5f;
  scene.lights.push_back(lamp);
  scene.cameras[0].aperture = 0.125f;
  scene.cameras[0].focus = 3;
  save_glb(scene, path("lamp.glb"));
  const SceneDescription back = load_scene(path("lamp.glb"));
  EXPECT_EQ(back.lights[0].type, Light::Type::kPoint);
  EXPECT_EQ(back.lights[0].radius, 0.25f);
  EXPECT_EQ(back.lights[1].type, Light::Type::kRectangle);
  EXPECT_EQ(back.lights[1].width, 2);
  EXPECT_EQ(back.lights[1].height, 0.5f);
  EXPECT_NEAR(back.lights[1].right.x, 0.6f, 1e-6f);
  EXPECT_NEAR(back.lights[1].right.z, 0.8f, 1e-6f);
  EXPECT_NEAR(back.lights[1].direction.y, -1, 1e-6f);
  EXPECT_EQ(back.cameras[0].aperture, 0.125f);
  EXPECT_EQ(back.cameras[0].focus, 3);
}

}  // namespace
}  // namespace raysheaf::test
