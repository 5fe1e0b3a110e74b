// `raysheaf bench paper`: figures, and refused arguments.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

Finished bench(const TemporaryFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments{"bench", "paper"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return raysheaf_app(arguments, folder);
}

TEST(Bench, JsonHoldsEveryFigure) {
  const TemporaryFolder folder;
  const Finished finished = bench(folder, {"--size", "24x24", "--check", "--json", "f.json"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.err.find("built-in"), std::string::npos);
  const Json all = Json::parse(read_file(folder.file("f.json")));
  int reflections = 0;
  for (const Json& r : all["results"]) {
    std::uint64_t total = r["final_tests"].get<std::uint64_t>() +
                          r["bound_tests"].get<std::uint64_t>() +
                          r["ray_bound_tests"].get<std::uint64_t>();
    for (const Json& level : r["levels"]) {
      EXPECT_EQ(level["tests"],
                level["hits"].get<std::uint64_t>() + level["misses"].get<std::uint64_t>());
      total += level["tests"].get<std::uint64_t>();
    }
    EXPECT_EQ(r["total"], total);
    EXPECT_EQ(r["brute_force"],
              r["rays"].get<std::uint64_t>() * r["triangles"].get<std::uint64_t>());
    EXPECT_NEAR(r["relative"].get<double>(),
                static_cast<double>(total) / r["brute_force"].get<double>(), 1e-9);
    EXPECT_TRUE(r["paper"].is_null());
    EXPECT_TRUE(r["times_ms"].contains("traverse"));
    EXPECT_TRUE(r.contains("mesh_sphere_tests"));
    if (r["kind"] == "reflection") {
      EXPECT_EQ(r["scene"], "cornell");
      ++reflections;
    }
  }
  EXPECT_GE(reflections, 6);  // two bounces by three methods
  EXPECT_GE(all["totals"].size(), 9u);
  for (const Json& t : all["totals"]) EXPECT_TRUE(t["paper_relative"].is_null());
}

TEST(Bench, MethodsAreChosen) {
  const TemporaryFolder folder;
  const Finished finished =
      bench(folder, {"--size", "16x16", "--method", "rah", "--json", "f.json", "--quiet"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  for (const Json& r : Json::parse(read_file(folder.file("f.json")))["results"])
    EXPECT_EQ(r["method"], "rah");
}

TEST(Bench, AMethodThatIsRepeatedCountsOnce) {
  const TemporaryFolder folder;
  const auto totals = [&](std::vector<std::string> methods) {
    for (const char* word : {"--size", "16x16", "--json", "f.json", "--quiet"})
      methods.emplace_back(word);
    const Finished finished = bench(folder, methods);
    EXPECT_EQ(finished.code, 0) << finished.err;
    EXPECT_NE(finished.out.find("builtin:office"), std::string::npos) << finished.out;
    EXPECT_EQ(finished.out.find("OFFICE"), std::string::npos) << "that is the paper's";
    return Json::parse(read_file(folder.file("f.json")))["totals"];
  };
  EXPECT_EQ(totals({"--method", "rah", "--method", "rah"}), totals({"--method", "rah"}));
}

TEST(Bench, RefusesInOneSentence) {
  const TemporaryFolder folder;
  EXPECT_EQ(bench(folder, {"--size", "0x4"}).code, 2);
  EXPECT_EQ(bench(folder, {"--method", "magic"}).code, 2);
  EXPECT_EQ(raysheaf_app({"bench"}, folder).code, 2);
  EXPECT_EQ(raysheaf_app({"bench", "cake"}, folder).code, 2);
  const Finished missing = bench(folder, {"--scenes", "nowhere", "--quiet"});
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("nowhere/office.glb"), std::string::npos) << missing.err;
  EXPECT_EQ(bench(folder, {"--json", "no/such/folder.json", "--quiet"}).code, 1);
}

TEST(Bench, ThePapersScenesCompareOnlyAtThePapersSize) {
  RAYSHEAF_SCENE_OR_SKIP(path, "paper/cornell.glb");
  const std::string scenes = scenes_directory().string();
  const TemporaryFolder folder;
  for (const std::string size : {"512x512", "64x64"}) {
    const Finished finished = bench(folder, {"--scenes", scenes, "--size", size, "--method", "crsh",
                                             "--quiet", "--json", "f.json"});
    ASSERT_EQ(finished.code, 0) << finished.err;
    for (const Json& t : Json::parse(read_file(folder.file("f.json")))["totals"]) {
      EXPECT_EQ(t["paper_relative"].is_null(), size == "64x64");
      if (size == "512x512") {
        EXPECT_LE(t["relative"], t["paper_relative"]);
      }
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
