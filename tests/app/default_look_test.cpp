// The defaults of an image: light, samples, background, file name; and standard streams.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/read_png.h"

namespace raysheaf::test {
namespace {

constexpr const char* kCube =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

Finished app(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  return raysheaf_app(arguments, folder);
}

/// Runs a shell command with pipes and redirections; $APP is the program.
Finished shell(const TemporaryFolder& folder, const std::string& line) {
  return run_program({"sh", "-c", "APP='" + std::string(RAYSHEAF_APP) + "'; " + line},
                     folder.path());
}

std::uint8_t brightness(const Image& picture, double x, double y) {
  const auto column = static_cast<std::uint32_t>(x * picture.width);
  const auto row = static_cast<std::uint32_t>(y * picture.height);
  return picture.rgba[4 * (std::size_t{row} * picture.width + column)];
}

TEST(DefaultLook, AModelWithoutLightsShowsItsShapeFromEverySide) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  for (const std::string up : {"x", "y", "-z"}) {
    const Finished finished = app(folder, {"render", "cube.obj", "--view", "iso", "--up", up,
                                           "--size", "96x96", "-o", "a.png", "--stats", "a.json"});
    ASSERT_EQ(finished.code, 0) << finished.err;
    EXPECT_NE(finished.err.find("4 samples per pixel"), std::string::npos) << finished.err;
    const auto statistics = nlohmann::json::parse(read_file(folder.file("a.json")));
    EXPECT_EQ(statistics.at("samples").size(), 4u);
    // The three visible faces, and the background.
    const Image picture = read_png(folder.file("a.png"));
    std::vector<int> levels{brightness(picture, 0.5, 0.25), brightness(picture, 0.3, 0.65),
                            brightness(picture, 0.7, 0.65), brightness(picture, 0.02, 0.02)};
    EXPECT_LT(*std::max_element(levels.begin(), levels.end()), 250);
    for (std::size_t face = 0; face < 3; ++face) EXPECT_GT(levels[face], 50);
    std::sort(levels.begin(), levels.end());
    for (std::size_t i = 1; i < levels.size(); ++i) EXPECT_GT(levels[i] - levels[i - 1], 8) << i;
  }
}

TEST(DefaultLook, ScenesHaveFourSamplesAndBuiltInOnesHaveOne) {
  const TemporaryFolder folder;
  const auto samples = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all{"render", "--size", "16x16", "-q", "--stats", "a.json"};
    all.insert(all.end(), words.begin(), words.end());
    const Finished finished = app(folder, all);
    EXPECT_EQ(finished.code, 0) << finished.err;
    return nlohmann::json::parse(read_file(folder.file("a.json"))).at("samples").size();
  };
  ASSERT_EQ(app(folder, {"scene", "cornell", "-o", "lit.glb"}).code, 0);
  EXPECT_EQ(samples({"builtin:cornell"}), 1u);
  EXPECT_EQ(samples({"lit.glb"}), 4u);
  EXPECT_EQ(samples({"lit.glb", "--samples", "1"}), 1u);
  EXPECT_EQ(samples({"lit.glb", "--aperture", "1"}), 16u);
  EXPECT_EQ(samples({"lit.glb", "--sun", "1,2,3"}), 16u);
}

TEST(DefaultLook, TheBackgroundIsTheSameGreyForEveryLightAndExposure) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  const auto corner = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all{"render", "cube.obj", "--size", "48x48", "-q", "-o", "a.png"};
    all.insert(all.end(), words.begin(), words.end());
    const Finished finished = app(folder, all);
    EXPECT_EQ(finished.code, 0) << finished.err;
    const Image image = read_png(folder.file("a.png"));
    return std::vector<std::uint8_t>(image.rgba.begin(), image.rgba.begin() + 4);
  };
  const std::vector<std::uint8_t> grey{226, 226, 226, 255};
  EXPECT_EQ(corner({}), grey);
  EXPECT_EQ(corner({"--exposure", "0.01"}), grey);
  EXPECT_EQ(corner({"--exposure", "10", "--samples", "1"}), grey);
  EXPECT_EQ(corner({"--ambient", "0"}), grey);
  EXPECT_EQ(corner({"--stream", "--primary", "trace"}), grey);
  EXPECT_NE(corner({"--sun", "1,2,3"}), grey);
}

TEST(DefaultLook, MirrorsShowTheSoftBoxesOfTheStudio) {
  const TemporaryFolder folder;
  write_file(folder.file("mirror.mtl"), "newmtl mirror\nKd 0.9 0.9 0.9\nPm 1\nPr 0.05\n");
  // A dome that faces the camera.
  std::string dome = "mtllib mirror.mtl\nusemtl mirror\n";
  constexpr int kSide = 24;
  for (int row = 0; row <= kSide; ++row) {
    for (int column = 0; column <= kSide; ++column) {
      const double x = 1.4 * column / kSide - 0.7, y = 1.4 * row / kSide - 0.7;
      dome += fmt::format("v {0} {1} {2}\nvn {0} {1} {2}\n", x, y, std::sqrt(1 - x * x - y * y));
    }
  }
  for (int row = 0; row < kSide; ++row) {
    for (int column = 1; column <= kSide; ++column) {
      const int a = row * (kSide + 1) + column, b = a + 1, c = b + kSide + 1, d = c - 1;
      dome += fmt::format("f {0}//{0} {1}//{1} {2}//{2} {3}//{3}\n", a, b, c, d);
    }
  }
  write_file(folder.file("dome.obj"), dome);
  const auto levels = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all{"render", "dome.obj", "--size", "96x96", "-q",
                                 "-o",     "a.png",    "--view", "front"};
    all.insert(all.end(), words.begin(), words.end());
    const Finished finished = app(folder, all);
    EXPECT_EQ(finished.code, 0) << finished.err;
    const Image image = read_png(folder.file("a.png"));
    // The pixels of the model's middle count.
    int bright = 0, dark = 0, all_pixels = 0;
    for (std::uint32_t y = 16; y < 80; ++y) {
      for (std::uint32_t x = 16; x < 80; ++x) {
        const std::uint8_t level = image.rgba[4 * (y * 96 + x)];
        bright += level > 235 ? 1 : 0;
        dark += level < 25 ? 1 : 0;
        ++all_pixels;
      }
    }
    return std::array<double, 2>{1.0 * bright / all_pixels, 1.0 * dark / all_pixels};
  };
  const auto [bright, dark] = levels({});
  EXPECT_GT(bright, 0.02);
  EXPECT_LT(bright, 0.3);
  EXPECT_EQ(dark, 0);
  EXPECT_LT(levels({"--ambient", "0.2"})[0], 0.02);
}

TEST(DefaultLook, ABackgroundStandsBehindTheModel) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  const auto picture = [&](const std::string& background, const std::string& name) {
    const Finished finished = app(folder, {"render", "cube.obj", "--size", "64x48", "-q", "-o",
                                           name, "--background", background});
    EXPECT_EQ(finished.code, 0) << finished.err;
    return read_png(folder.file(name));
  };
  const Image grey = picture("#204060", "a.png");
  EXPECT_EQ(std::vector<std::uint8_t>(grey.rgba.begin(), grey.rgba.begin() + 4),
            (std::vector<std::uint8_t>{0x20, 0x40, 0x60, 255}));
  const Image clear = picture("transparent", "b.png");
  EXPECT_EQ(clear.rgba[3], 0);
  EXPECT_EQ(clear.rgba[4 * (24 * 64 + 32) + 3], 255);
  EXPECT_TRUE(std::any_of(clear.rgba.begin(), clear.rgba.end(),
                          [](std::uint8_t byte) { return byte == 191; }));
  const Image white = picture("white", "c.jpg");
  EXPECT_GT(white.rgba[0], 250);
  const Finished frames = app(folder, {"render", "cube.obj", "--size", "32x32", "-q", "--turntable",
                                       "2", "-o", "f%d.png", "--background", "white"});
  EXPECT_EQ(frames.code, 0) << frames.err;
  EXPECT_EQ(read_png(folder.file("f1.png")).rgba[0], 255);
}

TEST(DefaultLook, AGroundCatchesTheShadow) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  const auto picture = [&](const std::vector<std::string>& more, const std::string& name) {
    std::vector<std::string> words{"render", "cube.obj", "--size", "64x48", "-q", "-o", name};
    words.insert(words.end(), more.begin(), more.end());
    const Finished finished = app(folder, words);
    EXPECT_EQ(finished.code, 0) << finished.err;
    return read_png(folder.file(name));
  };
  for (const std::string up : {"y", "-z"}) {
    const Image plain = picture({"--up", up, "--background", "transparent"}, up + "a.png");
    const Image clear =
        picture({"--up", up, "--background", "transparent", "--ground"}, up + "b.png");
    const Image white = picture({"--up", up, "--background", "white", "--ground"}, up + "c.png");
    std::size_t shaded = 0;
    for (std::size_t at = 0; at < plain.rgba.size(); at += 4) {
      const std::uint8_t alpha = clear.rgba[at + 3];
      ASSERT_GE(alpha, plain.rgba[at + 3]);
      if (plain.rgba[at + 3] == 255) {
        // The model is as it was.
        ASSERT_TRUE(std::equal(&plain.rgba[at], &plain.rgba[at] + 4, &clear.rgba[at]));
      } else if (plain.rgba[at + 3] == 0 && alpha > 0) {
        ASSERT_LT(alpha, 255);
        ASSERT_EQ(clear.rgba[at], 0);
        ASSERT_LT(white.rgba[at], 255);
        ++shaded;
      }
    }
    EXPECT_GT(shaded, 100u);
  }
  const Finished frames = app(folder, {"render", "cube.obj", "--size", "32x32", "-q", "--turntable",
                                       "2", "-o", "f%d.png", "--ground"});
  EXPECT_EQ(frames.code, 0) << frames.err;
  const Finished streamed = app(folder, {"render", "cube.obj", "--size", "64x48", "-q", "--stream",
                                         "--primary", "trace", "-o", "s.png", "--ground"});
  EXPECT_EQ(streamed.code, 0) << streamed.err;
  EXPECT_EQ(read_png(folder.file("s.png")).rgba,
            picture({"--primary", "trace", "--ground"}, "t.png").rgba);
  write_file(folder.file("dot.obj"), "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n");
  const Finished dot = app(folder, {"render", "dot.obj", "--ground", "-o", "dot.png"});
  EXPECT_NE(dot.code, 0);
  EXPECT_NE(dot.err.find("ground: the scene has no extent"), std::string::npos) << dot.err;
}

TEST(DefaultLook, AJpegIsThePictureOfThePng) {
  const TemporaryFolder folder;
  const Finished finished = app(folder, {"render", "builtin:cornell", "--size", "64x48", "-q", "-o",
                                         "a.png", "-o", "a.jpg", "-o", "b.JPEG"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_TRUE(read_file(folder.file("a.jpg")).starts_with("\xff\xd8"));
  EXPECT_EQ(read_file(folder.file("a.jpg")), read_file(folder.file("b.JPEG")));
  const Image png = read_png(folder.file("a.png")), jpg = read_png(folder.file("a.jpg"));
  ASSERT_EQ(png.rgba.size(), jpg.rgba.size());
  double sum = 0;
  for (std::size_t i = 0; i < png.rgba.size(); ++i) sum += std::abs(png.rgba[i] - jpg.rgba[i]);
  EXPECT_LT(sum / static_cast<double>(png.rgba.size()), 4);
}

TEST(DefaultLook, APictureWithoutANameIsCalledAsItsScene) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "models");
  write_file(folder.file("models/cube.obj"), kCube);
  for (int i = 0; i < 2; ++i) {
    const Finished finished = app(folder, {"render", "models/cube.obj", "--size", "8x8"});
    EXPECT_EQ(finished.code, 0) << finished.err;
    EXPECT_NE(finished.err.find(i == 0 ? "wrote cube.png" : "wrote cube-2.png"), std::string::npos);
  }
  EXPECT_EQ(app(folder, {"render", "builtin:cornell", "--size", "8x8", "-q"}).code, 0);
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"cornell.png", "cube-2.png", "cube.png", "models"}));
}

TEST(DefaultLook, APictureGoesThroughStandardOutput) {
  const TemporaryFolder folder;
  const Finished finished =
      shell(folder, "$APP render builtin:cornell --size 32x32 -o a.png -o - > b.png");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.err.find("wrote the image to standard output"), std::string::npos);
  EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")));
  const auto expect_refused = [&](const std::string& words, const std::string& part) {
    const Finished refused = shell(folder, "$APP render builtin:cornell --size 8x8 " + words);
    EXPECT_EQ(refused.code, 2) << refused.err;
    EXPECT_EQ(refused.out, "");
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused.err;
  };
  expect_refused("-o - -o -", "-o: '-' is given twice");
  expect_refused("-o - --explain", "--explain: it would mix");
  expect_refused("-o - --turntable 2", "-o: '-' is for a single image");
  expect_refused("--turntable 2", "nothing to write");
  expect_refused("-o a.gif", "-o: 'a.gif' ends in none of");
  expect_refused("-o a.jpg --background transparent", "--background: 'a.jpg' cannot be");
  expect_refused("-o a.png --background mauve", "--background: 'mauve' is none of");
  expect_refused("-o a.png --background '#12345g'", "--background: '#12345g' is none of");
}

/// Expects that a command renders the picture of a file.
void expect_same_picture(const TemporaryFolder& folder, const std::string& file,
                         const std::string& command) {
  const Finished named = shell(folder, "$APP render " + file + " --size 16x16 -q -o a.png");
  const Finished other = shell(folder, command + " --size 16x16 -q -o b.png");
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_EQ(other.code, 0) << command << ": " << other.err;
  EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png"))) << command;
}

TEST(DefaultLook, ASceneComesThroughStandardInput) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  ASSERT_EQ(app(folder, {"scene", "cornell", "-o", "cornell.glb"}).code, 0);
  write_file(folder.file("a.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write_file(folder.file("a.stl"),
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
             "endloop\nendfacet\nendsolid a\n");
  std::string stl(84 + 50, '\0');
  stl[80] = 1;
  stl[96 + 14] = stl[96 + 15] = stl[96 + 28] = stl[96 + 29] = 0x3f;
  write_file(folder.file("b.stl"), stl);
  for (const std::string name : {"cube.obj", "cornell.glb", "a.ply", "a.stl", "b.stl"}) {
    expect_same_picture(folder, name, "cat " + name + " | $APP render -");
  }
  EXPECT_EQ(shell(folder, "$APP info - < cube.obj").code, 0);
  for (const auto& [words, part] : std::vector<std::pair<std::string, std::string>>{
           {"</dev/null", "raysheaf: standard input: is empty\n"},
           {"<b.png", "raysheaf: standard input: is none of glTF"}}) {
    const Finished refused = shell(folder, "$APP render - -o c.png " + words);
    EXPECT_EQ(refused.code, 1) << refused.err;
    EXPECT_TRUE(refused.err.starts_with(part)) << refused.err;
  }
  const Finished wrong = shell(folder, "printf 'v 0 0 nan\\nf 1 1 1\\n' | $APP render - -o c.png");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_TRUE(wrong.err.starts_with("raysheaf: standard input")) << wrong.err;
}

TEST(Pipe, IsReadAsAFileIs) {
  const TemporaryFolder folder;
  write_file(folder.file("cube.obj"), kCube);
  ASSERT_EQ(app(folder, {"scene", "cornell", "-o", "cornell.glb"}).code, 0);
  ASSERT_EQ(shell(folder, "mkfifo pipe").code, 0);
  for (const std::string name : {"cube.obj", "cornell.glb"}) {
    expect_same_picture(folder, name, "cat " + name + " > pipe & $APP render pipe");
  }
  const Finished empty = shell(folder, ": > pipe & $APP info pipe");
  EXPECT_EQ(empty.code, 1);
  EXPECT_EQ(empty.err, "raysheaf: pipe: is empty\n");
}

TEST(Warnings, AreFewWithACountOfTheRest) {
  const TemporaryFolder folder;
  const std::string object = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::string materials;
  for (int i = 0; i < 20; ++i) {
    const std::string n = std::to_string(i);
    materials += "newmtl m" + n + "\nmap_Kd gone" + n + ".png\n";
  }
  write_file(folder.file("a.mtl"), materials);
  write_file(folder.file("a.obj"), object);
  const Finished drawn = shell(folder, "$APP render a.obj --size 16x16 -o 50%.png");
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_TRUE(std::filesystem::exists(folder.file("50%.png")));
  std::size_t lines = 0;
  for (std::size_t at = drawn.err.find("warning: "); at != std::string::npos;
       at = drawn.err.find("warning: ", at + 1))
    ++lines;
  EXPECT_EQ(lines, 9u) << drawn.err;
  EXPECT_NE(drawn.err.find("warning: 12 more; \"raysheaf info --all\" prints all"),
            std::string::npos)
      << drawn.err;
  EXPECT_EQ(shell(folder, "$APP render a.obj -q --size 16x16 -o b.png").err, "");
}

}  // namespace
}  // namespace raysheaf::test
