// The command line's options for samples, lights with a size, lenses and environments.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "raysheaf/io.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

Finished render(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"render", "--size", "24x24"});
  return raysheaf_app(arguments, folder);
}

void write_sky(const TemporaryFolder& folder, const std::string& name, float red) {
  std::vector<float> r(32, red), g(32, 0.5f), b(32, 0.7f);
  write_exr(8, 4, {{"R", r}, {"G", g}, {"B", b}}, folder.file(name));
}

TEST(Light, SamplesAreCountedEachAndTogether) {
  const TemporaryFolder folder;
  const Finished finished =
      render(folder, {"builtin:cornell", "--samples", "3", "--stats", "s.json", "-o", "a.exr"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.err.find("3 samples per pixel"), std::string::npos) << finished.err;
  const Json frame = Json::parse(read_file(folder.file("s.json")));
  ASSERT_EQ(frame.at("samples").size(), 3u);
  std::uint64_t rays = 0, of_batches = 0;
  for (const Json& sample : frame.at("samples")) rays += sample.at("rays").get<std::uint64_t>();
  for (const Json& batch : frame.at("batches")) of_batches += batch.at("rays").get<std::uint64_t>();
  EXPECT_EQ(rays, of_batches);
}

TEST(Light, MethodsWriteTheSameFileOfEverything) {
  const TemporaryFolder folder;
  write_sky(folder, "sky.exr", 0.4f);
  for (const std::string method : {"brute", "crsh", "dual"}) {
    const Finished finished = render(folder, {"builtin:cornell",
                                              "--method",
                                              method,
                                              "-o",
                                              method + ".png",
                                              "--samples",
                                              "2",
                                              "--light-size",
                                              "5",
                                              "--aperture",
                                              "2",
                                              "--focus",
                                              "80",
                                              "--env",
                                              "sky.exr",
                                              "--env-rotation",
                                              "-40",
                                              "--env-intensity",
                                              "0.5",
                                              "-q"});
    ASSERT_EQ(finished.code, 0) << finished.err;
  }
  const std::string brute = read_file(folder.file("brute.png"));
  EXPECT_EQ(read_file(folder.file("crsh.png")), brute);
  EXPECT_EQ(read_file(folder.file("dual.png")), brute);
}

TEST(Light, ALensAndSamplesAreExplained) {
  const TemporaryFolder folder;
  const Finished finished =
      render(folder, {"builtin:cornell", "--explain", "-q", "--aperture", "2", "--samples", "2"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_TRUE(finished.out.starts_with(
      "primary visibility: trace: a lens needs rays\nsamples: 2 per pixel"))
      << finished.out;
}

TEST(Light, ErrorsAreOneSentence) {
  const TemporaryFolder folder;
  write_sky(folder, "sky.exr", 1);
  write_file(folder.file("cut.hdr"), "#?RADIANCE\n\n-Y 4 +X 8\n\x01\x02");
  write_file(folder.file("lamp.gltf"), R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],
    "nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}],
    "extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[
      {"type":"spot","spot":{},"extras":{"width":1}}]}}})");
  const auto expect_sentence = [&](std::vector<std::string> arguments, int code,
                                   const std::string& part) {
    arguments.insert(arguments.end(), {"-o", "a.png"});
    const Finished finished = render(folder, arguments);
    EXPECT_EQ(finished.code, code) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_NE(finished.err.find(part), std::string::npos) << part << " in " << finished.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.png")));
  };
  const std::string scene = "builtin:cornell";
  for (const char* samples : {"0", "-3", "65537", "99999999999", "many", "1.5"})
    expect_sentence({scene, "--samples", samples}, 2, "--samples");
  expect_sentence({scene, "--light-size", "-1"}, 2, "--light-size");
  expect_sentence({scene, "--aperture", "nan"}, 2, "--aperture");
  expect_sentence({scene, "--focus", "0"}, 2, "--focus");
  expect_sentence({scene, "--focus", "3"}, 2, "--focus: the camera is a pinhole");
  expect_sentence({scene, "--env-intensity", "2"}, 2, "--env");
  expect_sentence({scene, "--env", "sky.exr", "--env-rotation", "inf"}, 2, "--env-rotation");
  expect_sentence({scene, "--env", "cut.hdr"}, 1, "cut.hdr: the file ends within row 0");
  expect_sentence({scene, "--env", "nowhere.hdr"}, 1, "nowhere.hdr");
  expect_sentence({"lamp.gltf"}, 1, "lights[0].extras.height");
}

TEST(Light, TheSunComesFromADirectionOrFromAPlaceAndATime) {
  const TemporaryFolder folder;
  const auto sun = [&](const std::string& value, const std::string& output) {
    return raysheaf_app({"render", "builtin:cornell", "--size", "16x16", "--samples", "2", "--sun",
                         value, "-o", output},
                        folder);
  };
  // Noon at the equator on the day of an equinox, within half a degree of the zenith and to the
  // north of it.
  ASSERT_EQ(sun("0,0,2024-03-20T12:07Z", "a.png").code, 0);
  ASSERT_EQ(sun("0,0,2024-03-20T14:07:00+02:00", "b.png").code, 0);
  ASSERT_EQ(sun("1,0.5,0", "c.png").code, 0);
  EXPECT_EQ(read_file(folder.file("a.png")), read_file(folder.file("b.png")));
  EXPECT_NE(read_file(folder.file("a.png")), read_file(folder.file("c.png")));
  for (const std::string wrong :
       {"noon", "1,2", "0,0,0", "0,-1,0", "91,0,2024-03-20T12:00Z", "0,0,2024-02-30T12:00Z",
        "0,0,2024-03-20T12:00", "0,0,2024-03-20T25:00Z", "0,0,2024-03-20T12:00Zulu",
        "0,0,2024-03-20T00:00Z"}) {
    const Finished refused = sun(wrong, "wrong.png");
    EXPECT_EQ(refused.code, 2) << wrong << ": " << refused.err;
    EXPECT_NE(refused.err.find("--sun"), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.file("wrong.png")));
}

}  // namespace
}  // namespace raysheaf::test
