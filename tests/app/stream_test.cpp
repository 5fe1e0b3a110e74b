// Scenes that stream, as a user packs and renders them.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/process.h"

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
      for (const char* more : {"-o", "a.png", "--size", "60x40", "-q"})
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

TEST(StreamCommand, ResumesAndLeavesThePictureAlone) {
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

TEST(StreamCommand, AHallIsWrittenInBlocksAndAsGltf) {
  const TemporaryFolder folder;
  for (const char* output : {"hall.glb", "hall.rsb"}) {
    const Finished finished =
        raysheaf_app({"scene", "hall", "--triangles", "20K", "-o", output}, folder);
    EXPECT_EQ(finished.code, 0) << finished.err;
  }
  const Finished info = raysheaf_app({"info", "hall.rsb", "--json"}, folder);
  EXPECT_TRUE(contains(info.out, "\"blocks\"")) << info.out;
  // glTF rounds lights and cameras: what was read from it is packed again.
  EXPECT_EQ(raysheaf_app({"pack", "hall.glb", "-o", "hall.rsb"}, folder).code, 0);
  const auto picture = [&](std::vector<std::string> arguments) {
    for (const char* more : {"-o", "a.png", "--size", "64x64"}) arguments.emplace_back(more);
    EXPECT_EQ(raysheaf_app(arguments, folder).code, 0);
    return read_file(folder.file("a.png"));
  };
  EXPECT_EQ(picture({"render", "hall.glb", "--primary", "trace"}), picture({"render", "hall.rsb"}));
}

TEST(StreamCommand, WhatIsWrongIsOneSentence) {
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
                       "bad.rsb: block 0: its bytes have changed"));
  write_file(folder.file("short.rsb"), good.substr(0, good.size() / 2));
  EXPECT_TRUE(contains(error({"render", "short.rsb", "-o", "p.png", "-q"}, 1), "short.rsb"));
  EXPECT_TRUE(
      contains(error({"render", "a.rsb", "-o", "p.png", "--memory", "1M", "-q"}, 1), "memory"));
  error({"render", "a.rsb", "-o", "p.png", "--primary", "raster"}, 2);
  error({"render", "a.rsb", "-o", "p.png", "--method", "rah"}, 2);
  error({"render", "builtin:cornell", "-o", "p.png", "--memory", "1G"}, 2);
  error({"pack", "builtin:cornell", "-o", "a.glb"}, 2);
  error({"scene", "hall", "--triangles", "many", "-o", "a.rsb"}, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("p.png")));
}

}  // namespace
}  // namespace raysheaf::test
