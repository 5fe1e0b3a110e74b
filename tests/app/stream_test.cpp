// Packing and rendering scenes that stream.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/raysheaf/render/stream.h"
#include "support/process.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(StreamCommand, PicturesAreTheSameFiles) {
  const TemporaryFolder folder;
  for (const std::string name : {"office", "cornell", "atrium"}) {
    const std::string scene = "builtin:" + name;
    ASSERT_EQ(
        raysheaf_app({"pack", scene, "-o", "a.rsb", "--block-triangles", "2000"}, folder).code, 0);
    const auto render = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), "render");
      for (const char* more : {"-o", "a.png", "--size", "60x40", "-q", "--samples", "1"})
        arguments.emplace_back(more);
      const Finished finished = raysheaf_app(arguments, folder);
      EXPECT_EQ(finished.code, 0) << finished.err;
      return read_file(folder.file("a.png"));
    };
    const std::string memory = render({scene, "--primary", "trace"});
    EXPECT_EQ(render({"a.rsb", "--memory", "256M", "--threads", "1"}), memory) << name;
    EXPECT_EQ(render({"a.rsb", "--threads", "3"}), memory) << name;
    EXPECT_EQ(render({scene, "--stream"}), memory) << name;
  }
}

/// Compares `render` of a scene in memory, of the same scene streamed, and of its block file.
class StreamCommandSees : public ::testing::Test {
 protected:
  StreamCommandSees() {
    EXPECT_EQ(raysheaf_app({"pack", "builtin:cornell", "-o", "a.rsb", "-q"}, folder_).code, 0);
  }

  /// All files that one of the renders writes.
  std::vector<std::string> files_of(std::vector<std::string> scene,
                                    const std::vector<std::string>& more) {
    scene.insert(scene.begin(), "render");
    for (const char* each : {"--size", "40x30", "-q", "-o", "out_%02d.png"})
      scene.emplace_back(each);
    scene.insert(scene.end(), more.begin(), more.end());
    const Finished finished = raysheaf_app(scene, folder_);
    EXPECT_EQ(finished.code, 0) << finished.err;
    std::vector<std::string> files;
    for (const std::string& name : folder_.names()) {
      if (!name.starts_with("out_")) continue;
      files.push_back(read_file(folder_.file(name)));
      std::filesystem::remove(folder_.file(name));
    }
    return files;
  }

  void expect_the_same(const std::vector<std::string>& more, std::size_t count) {
    const auto memory = files_of({"builtin:cornell", "--primary", "trace"}, more);
    EXPECT_EQ(memory.size(), count);
    EXPECT_EQ(files_of({"builtin:cornell", "--stream"}, more), memory);
    EXPECT_EQ(files_of({"a.rsb"}, more), memory);
  }

  const TemporaryFolder folder_;
};

TEST_F(StreamCommandSees, TheLightOfTheCommandLine) {
  std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (int i = 0; i < 8; ++i) sky += {char(40 + 9 * i), 100, char(120 - 7 * i), char(-128)};
  write_file(folder_.file("sky.hdr"), sky);
  expect_the_same({"--frames", "0:0", "--samples", "2", "--light-size", "4"}, 1);
  expect_the_same({"--frames", "0:0", "--samples", "2", "--env", "sky.hdr", "--env-rotation", "40"},
                  1);
}

TEST_F(StreamCommandSees, CamerasThatMove) {
  expect_the_same({"--turntable", "3", "--samples", "2"}, 3);
  write_file(folder_.file("path.json"), R"({"keys": [
    {"time": 0, "position": [278, 273, -800], "look_at": [278, 273, 0], "fov": 40},
    {"time": 1, "position": [300, 200, -700], "look_at": [278, 273, 0], "fov": 50}]})");
  expect_the_same({"--camera-path", "path.json", "--fps", "2", "--samples", "2"}, 3);
}

TEST_F(StreamCommandSees, WhatMovesFrameByFrame) {
  const auto square = [](double x) {
    std::string text;
    for (const char* corner : {" 0 0", " 1 0", " 1 1"})
      text += "v " + std::to_string(x += 0.5) + corner + "\n";
    return text + "f 1 2 3\n";
  };
  write_file(folder_.file("floor.obj"), "v -5 0 -5\nv 9 0 -5\nv 9 0 5\nf 3 2 1\n");
  for (const int i : {0, 1})
    write_file(folder_.file("step_" + std::to_string(i) + ".obj"), square(i));
  const std::vector<std::string> moves = {"--sequence", "step_*.obj", "--stats", "out_%d.json"};
  const std::vector<std::string> memory = files_of({"floor.obj", "--primary", "trace"}, moves);
  const std::vector<std::string> streams = files_of({"floor.obj", "--stream"}, moves);
  ASSERT_EQ(memory.size(), 4u);  // out_0.json, out_00.png, out_01.png, out_1.json
  ASSERT_EQ(streams.size(), 4u);
  EXPECT_EQ(streams[1], memory[1]);
  EXPECT_EQ(streams[2], memory[2]);
  EXPECT_NE(streams[1], streams[2]);
  EXPECT_TRUE(contains(streams[0], "\"stream\": {")) << streams[0];
}

// 200 000 random triangles, which need more memory than --memory allows.
TEST(StreamCommand, AFileThatIsLargerThanMemoryIsPackedOnTheWay) {
  const TemporaryFolder folder;
  constexpr std::uint32_t kTriangles = 200'000;
  std::string stl(80, ' ');
  const auto put = [&stl](const auto& value) {
    stl.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(kTriangles);
  Random random(5);
  for (std::uint32_t t = 0; t < kTriangles; ++t) {
    const Vec3 place = random.in_box(10);
    put(Vec3{});
    for (int corner = 0; corner < 3; ++corner) put(place + random.in_box(0.1f));
    put(std::uint16_t{0});
  }
  write_file(folder.file("soup.stl"), stl);
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "soup.stl", "--size", "32x24", "-q", "-o", "a.png"});
    Finished finished = raysheaf_app(more, folder);
    EXPECT_EQ(finished.code, 0) << finished.err;
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.png", "soup.stl"}));
    return std::pair(read_file(folder.file("a.png")), finished.memory_bytes);
  };
  const auto [whole, held] = render({"--primary", "trace"});
  const auto [streamed, packed] = render({"--stream", "--memory", "90M", "--threads", "2"});
  EXPECT_EQ(streamed, whole);
  EXPECT_LT(packed, std::size_t{130} << 20) << "of " << held << " for all of them";
}

TEST(StreamCommand, ResumesWithTheSameImage) {
  const TemporaryFolder folder;
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", "builtin:cornell", "--stream", "--size", "40x30", "-q"});
    return raysheaf_app(more, folder);
  };
  ASSERT_EQ(render({"-o", "a.png"}).code, 0);
  write_file(folder.file("b.png.resume"), "of something else");
  const Finished finished = render({"-o", "b.png", "--resume"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")));
  EXPECT_EQ(folder.names().size(), 2u);
  EXPECT_EQ(render({"--explain", "--resume"}).code, 2);
}

TEST(StreamCommand, ResumesOnlyTheSameTimeAndFiles) {
  const TemporaryFolder folder;
  const std::vector<std::string> files{folder.file("a.gltf"), folder.file("a.bin")};
  for (const std::string& file : files) write_file(file, "of a scene");
  app::RenderCommand command;
  command.pictures = {folder.file("a.png")};
  command.frames.resume = true;
  command.frames.time = 1;
  const StreamBatch batch;
  std::vector<std::byte> answers(8);
  std::vector<std::uint8_t> done(2);
  const auto restored = [&] {
    return app::open_checkpoint(command, nullptr, files)->restore(batch, answers, done);
  };
  {
    const auto checkpoint = app::open_checkpoint(command, nullptr, files);
    // Results of less than a second are not stored.
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    checkpoint->keep(batch, answers, done, true);
  }
  EXPECT_TRUE(restored());
  command.frames.time = 2;
  EXPECT_FALSE(restored()) << "moving objects are elsewhere";
  command.frames.time = 1;
  command.frames.clip = "walk";
  EXPECT_FALSE(restored());
  command.frames.clip.clear();
  EXPECT_TRUE(restored());
  write_file(files[1], "of a scene, otherwise");
  EXPECT_FALSE(restored()) << "its buffer was overwritten";
}

TEST(StreamCommand, AHallIsWrittenInBlocksAndAsGltf) {
  const TemporaryFolder folder;
  for (const char* output : {"hall.glb", "hall.rsb"}) {
    const Finished finished =
        raysheaf_app({"scene", "hall", "--triangles", "20K", "-o", output}, folder);
    EXPECT_EQ(finished.code, 0) << finished.err;
  }
  const Finished info = raysheaf_app({"info", "hall.rsb", "--json"}, folder);
  EXPECT_TRUE(contains(info.out, "\"blocks\"")) << info.out;
  // glTF rounds lights and cameras, so the scene that was read from it is packed again.
  EXPECT_EQ(raysheaf_app({"pack", "hall.glb", "-o", "hall.rsb"}, folder).code, 0);
  const auto picture = [&](std::vector<std::string> arguments) {
    for (const char* more : {"-o", "a.png", "--size", "64x64"}) arguments.emplace_back(more);
    EXPECT_EQ(raysheaf_app(arguments, folder).code, 0);
    return read_file(folder.file("a.png"));
  };
  EXPECT_EQ(picture({"render", "hall.glb", "--primary", "trace"}), picture({"render", "hall.rsb"}));
}

TEST(StreamCommand, ErrorsAreOneSentence) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      raysheaf_app({"pack", "builtin:cornell", "-o", "a.rsb", "--block-triangles", "50"}, folder)
          .code,
      0);
  const std::string good = read_file(folder.file("a.rsb"));
  const auto error = [&](std::vector<std::string> arguments, int code) {
    const Finished finished = raysheaf_app(std::move(arguments), folder);
    EXPECT_EQ(finished.code, code) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    return finished.err;
  };
  std::string bad = good;
  bad[300] = static_cast<char>(bad[300] ^ 4);  // in the first block's geometry
  write_file(folder.file("bad.rsb"), bad);
  EXPECT_TRUE(contains(error({"render", "bad.rsb", "-o", "p.png", "-q"}, 1),
                       "bad.rsb: block 0: its bytes are damaged"));
  write_file(folder.file("short.rsb"), good.substr(0, good.size() / 2));
  EXPECT_TRUE(contains(error({"render", "short.rsb", "-o", "p.png", "-q"}, 1), "short.rsb"));
  EXPECT_TRUE(
      contains(error({"render", "a.rsb", "-o", "p.png", "--memory", "1M", "-q"}, 1), "memory"));
  error({"render", "a.rsb", "-o", "p.png", "--primary", "raster"}, 2);
  error({"render", "a.rsb", "-o", "p.png", "--method", "rah"}, 2);
  error({"render", "builtin:cornell", "-o", "p.png", "--memory", "1G"}, 2);
  error({"render", "a.rsb", "-o", "p_%d.png", "--sequence", "b_*.obj"}, 2);
  error({"render", "a.rsb", "-o", "p.png", "--clip", "walk"}, 2);
  error({"render", "a.rsb", "-o", "p.png", "--env", "none.hdr"}, 1);
  error({"pack", "builtin:cornell", "-o", "a.glb"}, 2);
  EXPECT_TRUE(contains(error({"pack", "a.rsb", "--block-triangles", "10", "-o", "b.rsb"}, 2),
                       "--block-triangles: the blocks of a .rsb file keep their size"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("b.rsb")));
  error({"scene", "hall", "--triangles", "many", "-o", "a.rsb"}, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("p.png")));
}

}  // namespace
}  // namespace raysheaf::test
