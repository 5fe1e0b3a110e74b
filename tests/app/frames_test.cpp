// `render` over the frames of animated scenes: file names, ranges, resuming, films, and refused
// arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "raysheaf/error.h"
#include "render/frames.h"
#include "tests/support/gltf_triangle.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

std::string box_at(float x) {
  std::string text = "o box\n";
  for (int i = 0; i < 8; ++i) {
    text += "v " + std::to_string(x + static_cast<float>(i & 1)) + " " +
            std::to_string(i >> 1 & 1) + " " + std::to_string(i >> 2) + "\n";
  }
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// A floor, and a box that moves over it in six frames.
class Frames : public ::testing::Test {
 protected:
  Frames() {
    write_file(folder_.path() / "floor.obj", "v -5 0 -5\nv 9 0 -5\nv 9 0 5\nv -5 0 5\nf 4 3 2 1\n");
    for (int i = 0; i < 6; ++i) {
      write_file(folder_.path() / ("box_" + std::to_string(i) + ".obj"),
                 box_at(0.4f * static_cast<float>(i)));
    }
  }
  Finished render(std::vector<std::string> arguments, std::chrono::milliseconds interrupt = {}) {
    arguments.insert(arguments.begin(), {"render", "--size", "24x24", "--primary", "trace"});
    return raysheaf_app(arguments, folder_, interrupt);
  }
  Finished walk(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"floor.obj", "--sequence", "box_*.obj"});
    return render(arguments);
  }
  [[nodiscard]] bool is_there(const std::string& name) const {
    return fs::exists(folder_.path() / name);
  }
  [[nodiscard]] std::string content(const std::string& name) const {
    return read_file(folder_.path() / name);
  }
  [[nodiscard]] std::size_t count_of(const std::string& part) const {
    std::size_t count = 0;
    for (const std::string& name : folder_.names()) count += name.find(part) != name.npos ? 1 : 0;
    return count;
  }
  TemporaryFolder folder_;
};

TEST(FrameNames, TakeTheNumber) {
  EXPECT_EQ(app::with_frame("a_%d.png", 7), "a_7.png");
  EXPECT_EQ(app::with_frame("a_%04d.png", 7), "a_0007.png");
  EXPECT_EQ(app::with_frame("%02d/x", 12345), "12345/x");
  EXPECT_EQ(app::with_frame("plain.png", 7), "plain.png");
  EXPECT_EQ(app::with_frame("50%_%d.png", 7), "50%_7.png");
  for (const char* name : {"%s.png", "%", "a%.png", "100%", "%0", "50%_d.png"}) {
    EXPECT_EQ(app::with_frame(name, 1), name) << "letters";
    EXPECT_FALSE(app::has_frame_field(name)) << name;
  }
  for (const char* name : {"%d_%d.png", "a%4d.png", "%0d.png", "%099999999d.png", "%d%3d",
                           "%099999999999999999999999d.png"}) {
    EXPECT_THROW(static_cast<void>(app::with_frame(name, 1)), Error) << name;
    EXPECT_TRUE(app::has_frame_field(name)) << name;
  }
}

TEST_F(Frames, AreTheSameWherePreloaded) {
  ASSERT_EQ(walk({"-o", "f_%d.png"}).code, 0);
  const Finished finished = walk({"-o", "p_%d.png", "--preload"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  for (const char* frame : {"0", "3", "5"})
    EXPECT_EQ(content(std::string("p_") + frame + ".png"),
              content(std::string("f_") + frame + ".png"));
}

TEST_F(Frames, AreWrittenByTheirNumbers) {
  const Finished finished = walk({"-o", "f_%03d.png", "--stats", "s_%d.json"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(is_there("f_00" + std::to_string(i) + ".png")) << i;
  EXPECT_NE(content("f_000.png"), content("f_005.png"));
  EXPECT_NE(finished.err.find("6 frames"), std::string::npos) << finished.err;
  const Json stats = Json::parse(content("s_3.json"));
  EXPECT_EQ(stats["frame"], 3);
  EXPECT_EQ(stats["time"], 0.125);
  EXPECT_EQ(stats["update"]["deformed_meshes"], 1);
  EXPECT_EQ(stats["update"]["replaced_meshes"], 0);
  EXPECT_EQ(stats["update"]["placed_triangles"], 12);
  EXPECT_EQ(stats["picture"]["triangles"], 14);
  for (const char* time : {"seek", "render", "write"})
    EXPECT_GE(stats["times_ms"][time].get<double>(), 0) << time;
}

TEST_F(Frames, OfARangeAreThoseOfAll) {
  ASSERT_EQ(walk({"-o", "all_%d.png"}).code, 0);
  ASSERT_EQ(walk({"-o", "some_%d.png", "--frames", "2:3"}).code, 0);
  EXPECT_EQ(count_of("some_"), 2u);
  for (const char* i : {"2", "3"})
    EXPECT_EQ(content(std::string("some_") + i + ".png"),
              content(std::string("all_") + i + ".png"));
  ASSERT_EQ(walk({"-o", "last.png", "--frames", "5"}).code, 0);
  EXPECT_EQ(content("last.png"), content("all_5.png"));
  ASSERT_EQ(walk({"-o", "end_%d.png", "--frames", "4:"}).code, 0);
  EXPECT_EQ(count_of("end_"), 2u);
}

TEST_F(Frames, EachMethodGivesTheSamePictures) {
  ASSERT_EQ(walk({"-o", "brute_%d.png", "--method", "brute"}).code, 0);
  for (const std::string method : {"rah", "crsh", "gl10", "dual"}) {
    ASSERT_EQ(walk({"-o", method + "_%d.png", "--method", method}).code, 0);
    for (const char* i : {"0", "3", "5"})
      EXPECT_EQ(content(method + "_" + i + ".png"), content(std::string("brute_") + i + ".png"));
  }
}

TEST_F(Frames, ResumeMakesThoseThatAreMissing) {
  ASSERT_EQ(walk({"-o", "a_%d.png"}).code, 0);
  const std::string third = content("a_3.png");
  fs::remove(folder_.path() / "a_3.png");
  write_file(folder_.path() / "a_1.png", "not touched");
  const Finished finished = walk({"-o", "a_%d.png", "--resume"});
  ASSERT_EQ(finished.code, 0);
  EXPECT_EQ(content("a_3.png"), third);
  EXPECT_EQ(content("a_1.png"), "not touched");
  EXPECT_NE(finished.err.find("5 of 6 frames exist already"), std::string::npos) << finished.err;
  EXPECT_EQ(walk({"-o", "a_%d.png", "--resume", "-q"}).err, "");
}

TEST_F(Frames, AnInterruptedRunLeavesWholePicturesAndGoesOn) {
  // So many frames around the floor that the run is still going when it is interrupted.
  const std::vector<std::string> turn = {"floor.obj", "--turntable", "20000", "-o", "t_%05d.png"};
  Finished finished;
  for (int ms = 300; count_of("t_") < 2 && ms < 20000; ms *= 3) {
    finished = render(turn, std::chrono::milliseconds(ms));
    EXPECT_EQ(finished.code, 130) << finished.err;
  }
  const std::size_t made = count_of("t_");
  ASSERT_GT(made, 1u);
  ASSERT_LT(made, 20000u);
  EXPECT_EQ(folder_.names().size(), made + 7) << "something half-written";
  std::vector<std::string> resumed = turn;
  const std::string last = std::to_string(made + 3);
  resumed.insert(resumed.end(), {"--resume", "--frames", ":" + last});
  finished = render(resumed);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(count_of("t_"), made + 4);
  std::vector<std::string> uninterrupted = turn;
  uninterrupted[4] = "u_%05d.png";
  uninterrupted.insert(uninterrupted.end(), {"--frames", ":" + last});
  ASSERT_EQ(render(uninterrupted).code, 0);
  for (std::size_t i = 0; i < made + 4; ++i) {
    EXPECT_EQ(content(app::with_frame("t_%05d.png", i)), content(app::with_frame("u_%05d.png", i)))
        << i;
  }
}

TEST_F(Frames, ASinglePictureIsTakenAtATime) {
  ASSERT_EQ(walk({"-o", "third.png", "--time", "0.13", "--exposure", "1", "--ambient", "0.1"}).code,
            0);
  ASSERT_EQ(walk({"-o", "a_%d.png", "--exposure", "1", "--ambient", "0.1"}).code, 0);
  EXPECT_EQ(content("third.png"), content("a_3.png"));
  ASSERT_EQ(render({"box_?.obj", "-o", "b_%d.png"}).code, 0) << "a scene that is a pattern";
  EXPECT_EQ(count_of("b_"), 6u);
}

TEST_F(Frames, WarningsOfAllFramesAreReportedOnce) {
  for (const int i : {2, 3, 5})
    write_file(folder_.path() / ("box_" + std::to_string(i) + ".obj"), "usemtl zzz\n" + box_at(1));
  const std::string warning = "warning: There is no material \"zzz\"";
  for (const bool streamed : {false, true}) {
    std::vector<std::string> arguments = {"-o", "w_%d.png"};
    if (streamed) arguments.emplace_back("--stream");
    const Finished finished = walk(arguments);
    ASSERT_EQ(finished.code, 0) << finished.err;
    const std::size_t at = finished.err.find(warning);
    ASSERT_NE(at, std::string::npos) << finished.err;
    EXPECT_EQ(finished.err.find("warning", at + 1), std::string::npos) << finished.err;
  }
  EXPECT_EQ(walk({"-o", "w_%d.png", "-q"}).err, "");
}

TEST_F(Frames, NameTheFileWhereTimeLeadsTooFar) {
  write_file(folder_.path() / "m.bin", moving_triangle_numbers(1, 1e30f));
  write_file(folder_.path() / "away.gltf", kMovingGltfTriangle);
  for (const char* option : {"--exposure=1", "--stream"}) {
    const Finished finished = render({"away.gltf", "-o", "f.png", "--time", "0.5", "-q", option});
    EXPECT_EQ(finished.code, 1);
    EXPECT_TRUE(finished.err.starts_with("raysheaf: away.gltf: instances[0].to_world: "))
        << finished.err;
  }
}

TEST_F(Frames, OneWithoutTrianglesIsNamed) {
  write_file(folder_.path() / "box_2.obj", "v 0 0 0\n");
  for (const char* option : {"--exposure=1", "--stream"}) {
    const Finished finished = render({"box_?.obj", "-o", "e_%d.png", "-q", option});
    EXPECT_EQ(finished.code, 1);
    EXPECT_EQ(finished.err, "raysheaf: box_?.obj: the scene has no triangles\n");
  }
}

TEST_F(Frames, FollowAPath) {
  write_file(folder_.path() / "path.json", R"({"keys": [
      {"time": 0, "position": [0, 3, 9], "look_at": [1, 0, 0]},
      {"time": 1, "position": [9, 3, 0], "look_at": [1, 0, 0], "fov": 40}]})");
  ASSERT_EQ(
      render({"floor.obj", "--camera-path", "path.json", "--fps", "4", "-o", "p_%d.png"}).code, 0);
  EXPECT_EQ(count_of("p_"), 5u);
  EXPECT_NE(content("p_0.png"), content("p_2.png"));
  const Finished finished = render({"floor.obj", "--camera-path", "floor.obj", "-o", "q_%d.png"});
  EXPECT_EQ(finished.code, 1);
  EXPECT_NE(finished.err.find("floor.obj: JSON"), std::string::npos) << finished.err;
  write_file(folder_.path() / "over.json", R"({"keys": [
    {"time": 0, "position": [0, 1, 3], "look_at": [0, 1, 0]},
    {"time": 1, "position": [0, 1, -3], "look_at": [0, 1, 0]}]})");
  const Finished over =
      render({"floor.obj", "--camera-path", "over.json", "--fps", "2", "-o", "q_%d.png"});
  EXPECT_EQ(over.code, 1);
  EXPECT_NE(over.err.find("over.json: at 0.5"), std::string::npos) << over.err;
}

// A script in place of ffmpeg that stores its arguments and its input.
TEST_F(Frames, BecomeAFilm) {
  const fs::path bin = folder_.path() / "bin";
  fs::create_directory(bin);
  write_file(bin / "ffmpeg",
             "#!/bin/sh\nfor last; do :; done\necho \"$@\" > words\nexec cat > \"$last\"\n");
  fs::permissions(bin / "ffmpeg", fs::perms::owner_all);
  const std::string old = std::getenv("PATH");
  setenv("PATH", (bin.string() + ":" + old).c_str(), 1);
  const Finished finished = walk({"-o", "film.mp4", "--fps", "12"});
  setenv("PATH", old.c_str(), 1);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(content("film.mp4").size(), 6u * 24 * 24 * 4);
  EXPECT_NE(content("words").find("-s 24x24 -r 12"), std::string::npos) << content("words");
  EXPECT_NE(content("words").find(" ./film.mp4"), std::string::npos) << content("words");
  EXPECT_EQ(count_of(".part"), 0u);

  write_file(bin / "ffmpeg", "#!/bin/sh\nexit 3\n");
  setenv("PATH", (bin.string() + ":" + old).c_str(), 1);
  const Finished failed = walk({"-o", "broken.mp4"});
  setenv("PATH", old.c_str(), 1);
  EXPECT_EQ(failed.code, 1);
  EXPECT_NE(failed.err.find("broken.mp4: ffmpeg"), std::string::npos) << failed.err;
  EXPECT_FALSE(is_there("broken.mp4"));
  EXPECT_EQ(count_of(".part"), 0u);

  setenv("PATH", bin.parent_path().c_str(), 1);
  const Finished none = walk({"-o", "none.mp4"});
  setenv("PATH", old.c_str(), 1);
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.err.find("none.mp4: MP4 is made by ffmpeg, which is not installed"),
            std::string::npos)
      << none.err;
}

// The chunks of the file follow each other exactly, and one frame lasts a twelfth of a second.
TEST_F(Frames, BecomeAWebpFilmWithoutFfmpeg) {
  const std::string old = std::getenv("PATH");
  setenv("PATH", folder_.path().c_str(), 1);
  const Finished finished = walk({"-o", "film.webp", "--fps", "12"});
  setenv("PATH", old.c_str(), 1);
  if (finished.err.find("no libwebp") != std::string::npos) GTEST_SKIP() << finished.err;
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::string film = content("film.webp");
  const auto number = [&](std::size_t at, int bytes) {
    std::size_t value = 0;
    for (int i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(film.at(at + i));
    return value;
  };
  EXPECT_EQ(film.substr(0, 4) + film.substr(8, 4), "RIFFWEBP");
  EXPECT_EQ(number(4, 4), film.size() - 8);
  std::size_t frames = 0, duration = 0;
  std::size_t at = 12;
  for (; at < film.size(); at += 8 + number(at + 4, 4)) {
    if (film.substr(at, 4) != "ANMF") continue;
    ++frames;
    EXPECT_EQ(number(at + 14, 3), 23u);
    EXPECT_EQ(number(at + 17, 3), 23u);
    duration += number(at + 20, 3);
  }
  EXPECT_EQ(at, film.size());
  EXPECT_EQ(frames, 6u);
  EXPECT_EQ(duration, 500u);
}

TEST_F(Frames, ErrorsAreOneSentence) {
  const auto refused = [&](const std::vector<std::string>& arguments, int code,
                           const std::string& words) {
    const Finished finished = walk(arguments);
    EXPECT_EQ(finished.code, code) << finished.err;
    EXPECT_NE(finished.err.find(words), std::string::npos) << words << " in: " << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  };
  refused({"-o", "f.png", "--frames", "0:3"}, 2, "no place for the frame's number");
  refused({"-o", "f_%d_%d.png"}, 2, "one place");
  refused({"-o", "f_%03d.mp4"}, 2, "-o: 'f_%03d.mp4' is one film of all frames");
  refused({"-o", "f_%d.png", "--frames", "3:1"}, 2, "3:1 goes backwards");
  refused({"-o", "f_%d.png", "--frames", "0:6"}, 2, "there are 6 frames, 0 to 5");
  refused({"-o", "f_%d.png", "--frames", "a:b"}, 2, "FIRST:LAST");
  refused({"-o", "f_%d.png", "--fps", "0"}, 2, "--fps");
  refused({"-o", "f_%d.png", "--time", "1"}, 2, "--time");
  refused({"-o", "f.png", "--resume"}, 2, "--resume");
  refused({"-o", "f.mp4", "--resume"}, 2, "--resume");
  refused({"-o", "f_%d.png", "--turntable", "3", "--camera-path", "x"}, 2, "--turntable");
  refused({"-o", "f_%d.png", "--camera-path", "x", "--camera", "0"}, 2, "--camera");
  refused({"-o", "f_%d.png", "--clip", "walk"}, 1, "no clip \"walk\"");
  refused({"-o", "no_folder/f_%d.png"}, 1, "no_folder");
  write_file(folder_.path() / "far.json", R"({"keys": [{"time": 0, "position": [0, 0, 9],
      "look_at": [0, 0, 0]}, {"time": 1e30, "position": [9, 0, 0], "look_at": [0, 0, 0]}]})");
  refused({"-o", "f_%d.png", "--camera-path", "far.json"}, 1, "more than 2^32 - 1 frames");
  write_file(folder_.path() / "long.json", R"({"keys": [{"time": 0, "position": [0, 0, 9],
      "look_at": [0, 0, 0]}, {"time": 1e6, "position": [9, 0, 0], "look_at": [0, 0, 0]}]})");
  refused({"-o", "f_%d.png", "--camera-path", "long.json"}, 2,
          "one run makes at most 250000: choose a range");
  Finished finished = render({"floor.obj", "--sequence", "tree_*.obj", "-o", "f_%d.png"});
  EXPECT_EQ(finished.code, 1);
  EXPECT_NE(finished.err.find("tree_*.obj: no file has such a name"), std::string::npos)
      << finished.err;
  finished = render({"floor.obj", "-o", "f_%d.png", "--frames", "0:3"});
  EXPECT_NE(finished.err.find("nothing moves"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace raysheaf::test
