// The command line's options for the viewpoint of an image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "raysheaf/io.h"
#include "tests/support/process.h"
#include "tests/support/read_png.h"

namespace raysheaf::test {
namespace {

/// A tetrahedron of this size at this place.
std::string obj_model(float size, float x, float y, float z) {
  const float corners[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 3}};
  std::string text;
  for (const auto& c : corners) {
    text += "v " + std::to_string(x + size * c[0]) + " " + std::to_string(y + size * c[1]) + " " +
            std::to_string(z + size * c[2]) + "\n";
  }
  return text + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

Finished render_model(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"render"});
  return raysheaf_app(arguments, folder);
}

/// The fraction of the width or of the height, whichever is larger, in which the image differs from
/// its corner.
double spanned_part(const Image& picture) {
  std::uint32_t left = picture.width, right = 0, top = picture.height, bottom = 0;
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const std::uint8_t* const pixel = &picture.rgba[4 * (std::size_t{y} * picture.width + x)];
      if (std::equal(pixel, pixel + 3, picture.rgba.data())) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  if (left > right) return 0;
  return std::max((right - left + 1.0) / picture.width, (bottom - top + 1.0) / picture.height);
}

TEST(Viewpoint, AModelFillsThePictureWhereverAndHoweverLargeItIs) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), obj_model(1, 0, 0, 0));
  write_file(folder.file("b.obj"), obj_model(1000, -50000, 200000, 3e4f));
  write_file(folder.file("c.obj"), obj_model(0.01f, 0.3f, 0.2f, 0.1f));
  const std::vector<std::vector<std::string>> ways{
      {}, {"--view", "left"}, {"--up", "-z", "--orthographic"}};
  const std::string models[] = {"a.obj", "b.obj", "c.obj"};
  const std::string sizes[] = {"240x180", "90x200", "128x128"};
  for (std::size_t i = 0; i < 9; ++i) {  // each model with each size, and with each way
    const std::string &model = models[i % 3], &size = sizes[(i + i / 3) % 3];
    std::vector<std::string> arguments{model, "--size", size, "-q", "-o", "p.png"};
    arguments.insert(arguments.end(), ways[i / 3].begin(), ways[i / 3].end());
    const Finished finished = render_model(folder, arguments);
    ASSERT_EQ(finished.code, 0) << finished.err;
    const double part = spanned_part(read_png(folder.file("p.png")));
    EXPECT_GT(part, 0.85) << model << " " << size;
    EXPECT_LT(part, 1.0) << model << " " << size;
  }
}

TEST(Viewpoint, AScenesOwnCameraStandsUnlessTheCommandLineHasOne) {
  const TemporaryFolder folder;
  const auto picture = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"builtin:cornell", "--size", "24x24", "-q", "-o", "p.png"});
    const Finished finished = render_model(folder, more);
    EXPECT_EQ(finished.code, 0) << finished.err;
    return read_file(folder.file("p.png"));
  };
  const std::string own = picture({});
  EXPECT_EQ(picture({"--zoom", "1"}), own);
  EXPECT_EQ(picture({"--camera", "0"}), own);
  EXPECT_NE(picture({"--zoom", "2"}), own);
  EXPECT_NE(picture({"--view", "top"}), own);
  EXPECT_NE(picture({"--fov", "50"}), own);
  const std::string there = picture({"--camera-position", "-1,2,30", "--look-at", "0,-1e0,0"});
  EXPECT_NE(there, own);
  EXPECT_EQ(picture({"--camera-position", "-1,2,30", "--look-at", "0,-1,0", "--fov", "40"}), there);
}

/// A scene of one model whose only camera stands at this distance.
SceneDescription seen_from(float distance) {
  SceneDescription scene;
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.emplace_back();
  Camera camera;
  camera.to_world.m[2][3] = distance;
  scene.cameras.push_back(camera);
  return scene;
}

TEST(Viewpoint, ACameraThatShowsTheModelSmallIsReplaced) {
  const TemporaryFolder folder;
  save_glb(seen_from(3), folder.file("near.glb"));
  save_glb(seen_from(20), folder.file("far.glb"));
  const auto part_of = [&](std::vector<std::string> arguments, bool warns) {
    arguments.insert(arguments.end(), {"--size", "60x40", "--primary", "trace", "-o", "p.png"});
    const Finished finished = render_model(folder, arguments);
    EXPECT_EQ(finished.code, 0) << finished.err;
    EXPECT_EQ(finished.err.find("automatic camera") != std::string::npos, warns) << finished.err;
    return spanned_part(read_png(folder.file("p.png")));
  };
  EXPECT_LT(part_of({"near.glb"}, false), 0.7);
  EXPECT_GT(part_of({"far.glb"}, true), 0.85);
  EXPECT_LT(part_of({"far.glb", "--camera", "0"}, false), 0.2);
  EXPECT_GT(part_of({"far.glb", "--stream"}, true), 0.85);
  EXPECT_LT(part_of({"far.glb", "--zoom", "0.5"}, true), 0.5);
  const Finished packed = raysheaf_app({"pack", "far.glb", "-o", "far.rsb"}, folder);
  ASSERT_EQ(packed.code, 0) << packed.err;
  EXPECT_GT(part_of({"far.rsb"}, true), 0.85);
  EXPECT_LT(part_of({"far.rsb", "--camera", "0"}, false), 0.2);
}

TEST(Viewpoint, StreamedPicturesAreTheSame) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), obj_model(1, 0, 0, 0));
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--view", "iso", "--zoom", "1.5"}}) {
    for (const std::string name : {"resident.png", "stream.png"}) {
      std::vector<std::string> arguments{"a.obj",     "--size", "40x30", "-q",
                                         "--primary", "trace",  "-o",    name};
      arguments.insert(arguments.end(), more.begin(), more.end());
      if (name == "stream.png") arguments.emplace_back("--stream");
      const Finished finished = render_model(folder, arguments);
      ASSERT_EQ(finished.code, 0) << finished.err;
    }
    EXPECT_EQ(read_file(folder.file("stream.png")), read_file(folder.file("resident.png")));
  }
}

TEST(Viewpoint, ATurntableTurnsAboutWhatIsUp) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), obj_model(1, 0, 0, 0));
  for (const std::string up : {"y", "z"}) {
    const Finished finished = render_model(folder, {"a.obj", "--turntable", "3", "--up", up,
                                                    "--size", "40x40", "-q", "-o", up + "%d.png"});
    ASSERT_EQ(finished.code, 0) << finished.err;
    for (const std::string frame : {"0", "1", "2"}) {
      const double part = spanned_part(read_png(folder.file(up + frame + ".png")));
      EXPECT_GT(part, 0.4);
      EXPECT_LT(part, 1.0);
    }
  }
  EXPECT_NE(read_file(folder.file("y1.png")), read_file(folder.file("z1.png")));
}

TEST(Viewpoint, NonsenseIsOneSentence) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), obj_model(1, 0, 0, 0));
  const auto expect_sentence = [&](std::vector<std::string> arguments, int code,
                                   const std::string& part) {
    arguments.insert(arguments.begin(), {"a.obj", "--size", "8x8", "-o", "p.png"});
    const Finished finished = render_model(folder, arguments);
    EXPECT_EQ(finished.code, code) << finished.err;
    EXPECT_NE(finished.err.find(part), std::string::npos) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  };
  expect_sentence({"--view", "under"}, 2, "--view: 'under' is none of front, back, left");
  expect_sentence({"--up", "w"}, 2, "--up: 'w' is none of x, y, z, -x, -y, -z");
  for (const std::string zoom : {"0", "-1", "nan", "inf", "two"})
    expect_sentence({"--zoom", zoom}, 2, "--zoom: '" + zoom + "'");
  for (const std::string fov : {"0", "-5", "180", "nan"})
    expect_sentence({"--fov", fov}, 2, "--fov: '" + fov + "'");
  for (const std::string point : {"1,2", "nan,0,0", "1,2,3,4", "here"})
    expect_sentence({"--camera-position", point}, 2, "is not X,Y,Z");
  expect_sentence({"--fov", "40", "--orthographic"}, 2, "--fov: has no meaning");
  expect_sentence({"--look-at", "1,2,3"}, 2, "--look-at: needs --camera-position");
  expect_sentence({"--view", "top", "--camera-position", "9,9,9"}, 2,
                  "--view: and --camera-position both set");
  expect_sentence({"--camera-position", "1,2,3", "--look-at", "1,2,3"}, 2,
                  "--look-at: is the same point as --camera-position");
  expect_sentence({"--camera-position", "1,9,1", "--look-at", "1,2,1"}, 2, "--up: is parallel");
  expect_sentence({"--camera", "0", "--view", "top"}, 2, "--view: it replaces the scene's cameras");
  expect_sentence({"--zoom", "1e38"}, 2, "--zoom: is too large");
  write_file(folder.file("path.json"), R"({"keys":[{"position":[1,2,3],"look_at":[0,0,0]}]})");
  expect_sentence({"--camera-path", "path.json", "--frames", "0", "--fov", "30"}, 2,
                  "--fov: it contradicts --camera-path");
}

}  // namespace
}  // namespace raysheaf::test
