// `raysheaf bench ablation`: its files, its winners, and refused arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/support/table.h"
#include "lab/commands/ablation/ablation.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;
using app::AblationReport;
using app::AblationRow;
using app::BenchAblationCommand;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

const std::vector<std::string> kTiny = {"bench",
                                        "ablation",
                                        "builtin:cornell",
                                        "--size",
                                        "24x24",
                                        "--rays",
                                        "shadow,reflection1",
                                        "--keys",
                                        "raster,five-hilbert",
                                        "--bounds",
                                        "sphere-cone,shaft",
                                        "--mesh-culling",
                                        "both",
                                        "--levels",
                                        "1,2",
                                        "--check",
                                        "--json",
                                        "a.json",
                                        "--csv",
                                        "a.csv"};
// raster once, five-hilbert with 32 and with 64 bits; 2 bounds, 2 cullings, 2 heights
constexpr std::size_t kTinyRowsABatch = 3 * 2 * 2 * 2;

void expect_least(const Json& all, const Json& best) {
  const auto tests = [](const Json& row) { return row["total"].get<std::uint64_t>(); };
  const auto time = [](const Json& row) { return row["times_ms"]["total"].get<double>(); };
  std::size_t rows = 0;
  for (const Json& row : all) {
    if (row["scene"] != best["scene"] || row["batch"] != best["batch"]) continue;
    EXPECT_LE(tests(best["fewest_tests"]), tests(row));
    EXPECT_LE(time(best["least_time"]), time(row));
    ++rows;
  }
  EXPECT_EQ(rows, kTinyRowsABatch);
  EXPECT_NE(std::find(all.begin(), all.end(), best["fewest_tests"]), all.end());
}

void expect_row(const Json& row) {
  EXPECT_EQ(row["key_bits"].is_null(), row["key"] == "raster");
  EXPECT_EQ(row["per_level"].size(), row["levels"].get<std::size_t>());
  std::uint64_t total = row["final_tests"];
  for (const Json& level : row["per_level"]) {
    total += level["tests"].get<std::uint64_t>();
    EXPECT_EQ(level["tests"],
              level["hits"].get<std::uint64_t>() + level["misses"].get<std::uint64_t>());
  }
  EXPECT_EQ(row["total"], total);
  EXPECT_EQ(row["brute_force"],
            row["rays"].get<std::uint64_t>() * row["triangles"].get<std::uint64_t>());
  EXPECT_NEAR(row["relative"].get<double>(),
              static_cast<double>(total) / row["brute_force"].get<double>(), 1e-12);
}

TEST(Ablation, FilesHoldEveryMeasurementAndTheMinimum) {
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app(kTiny, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Json json = Json::parse(read_file(folder.file("a.json")));
  ASSERT_EQ(json["results"].size(), 2 * kTinyRowsABatch);
  for (const Json& row : json["results"]) expect_row(row);
  ASSERT_EQ(json["best"].size(), 2u);
  for (const Json& best : json["best"]) expect_least(json["results"], best);

  const std::vector<std::string> csv = lines_of(read_file(folder.file("a.csv")));
  ASSERT_EQ(csv.size(), 1 + json["results"].size());
  for (const std::string& line : csv) EXPECT_EQ(count_of(line, ","), count_of(csv[0], ",")) << line;
  EXPECT_EQ(std::set<std::string>(csv.begin(), csv.end()).size(), csv.size());
  EXPECT_TRUE(csv[1].starts_with("cornell,shadow,raster,,sphere-cone,1,8,off,")) << csv[1];

  EXPECT_EQ(folder.names().size(), 2u);
  EXPECT_EQ(
      json["command"],
      "raysheaf bench ablation builtin:cornell --rays shadow,reflection1 --keys "
      "raster,five-hilbert --bounds sphere-cone,shaft --levels 1,2 --mesh-culling both --size "
      "24x24 --check");
  EXPECT_EQ(json["reasons"].size(), 4u) << "two keys and two bounds";
  // A table for each kind of rays, in which one cell has the fewest tests and one the least time.
  EXPECT_EQ(count_of(finished.out, "*"), 2u * 2 + 1) << finished.out;
  EXPECT_EQ(count_of(finished.out, "five-hilbert"), 2u * 2 * 4) << finished.out;
}

BenchAblationCommand small_command() {
  BenchAblationCommand command;
  command.scene = "builtin:cornell";
  command.width = command.height = 48;
  command.rays = {LabRays::kShadow};
  command.keys = {RayKey::kRaster, RayKey::kPixelMorton};
  command.bounds = {BundleBound::kSphereCone, BundleBound::kShaft};
  command.branching = {4, 8};
  return command;
}

AblationReport measured(const BenchAblationCommand& command) {
  return app::measure_ablation(command, [](const std::string&, std::uint64_t, std::uint64_t) {});
}

TEST(Ablation, EachSettingReachesTheLaboratory) {
  const AblationReport report = measured(small_command());
  ASSERT_EQ(report.rows.size(), 8u);
  Laboratory laboratory(builtin_scene("cornell"), 48, 48, 1);
  std::set<std::uint64_t> totals;
  for (const AblationRow& row : report.rows) {
    const BatchStatistics again = laboratory.measure(row.rays, row.settings, false);
    EXPECT_EQ(row.counts.total_tests(), again.total_tests());
    totals.insert(row.counts.total_tests());
  }
  EXPECT_EQ(totals.size(), report.rows.size()) << "every combination counts something else";
}

TEST(Ablation, FilesWithEqualNamesAreDifferentScenes) {
  const TemporaryFolder folder;
  write_file(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_file(folder.file("a.stl"),
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
             "vertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\n"
             "vertex 1 0 1\nvertex 0 1 1\nendloop\nendfacet\nendsolid a\n");
  std::filesystem::create_directory(folder.file("b.obj"));  // a folder instead of a scene
  BenchAblationCommand command = small_command();
  command.scene.clear();
  command.scenes = folder.path().string();
  const AblationReport report = measured(command);
  EXPECT_EQ(report.scenes, (std::vector<std::string>{"a.obj", "a.stl"}));
  for (const AblationRow& row : report.rows)
    EXPECT_EQ(row.counts.triangles, row.scene == "a.obj" ? 1u : 2u);
  EXPECT_EQ(app::fewest_tests(report, "a.ply", LabRays::kShadow), nullptr);
}

TEST(Ablation, NumbersHaveThreeDigits) {
  EXPECT_EQ(app::three_digits(0), "0");
  EXPECT_EQ(app::three_digits(0.00123456), "0.00123");
  EXPECT_EQ(app::three_digits(1.005), "1.00");
  EXPECT_EQ(app::three_digits(36.61), "36.6");
  EXPECT_EQ(app::three_digits(12345), "12345");
}

TEST(Ablation, RefusesWhatItCannotDo) {
  const auto refused = [](std::vector<std::string> arguments, int code, const std::string& place) {
    const TemporaryFolder folder;
    arguments.insert(arguments.begin(), {"bench", "ablation"});
    const Finished finished = raysheaf_app(arguments, folder);
    EXPECT_EQ(finished.code, code) << place;
    EXPECT_TRUE(finished.err.starts_with("raysheaf: ")) << finished.err;
    EXPECT_NE(finished.err.find(place), std::string::npos) << place << " in " << finished.err;
    EXPECT_TRUE(folder.names().empty());
  };
  refused({"--rays", "sun"}, 2, "--rays");
  refused({"--keys", "raster,,crsh"}, 2, "--keys");
  refused({"--bounds", "egg"}, 2, "--bounds");
  refused({"--key-bits", "48"}, 2, "--key-bits");
  refused({"--levels", "1,9"}, 2, "--levels");
  refused({"--branching", "all"}, 2, "--branching");
  refused({"--mesh-culling", "maybe"}, 2, "--mesh-culling");
  refused({"--repeat", "0"}, 2, "--repeat");
  refused({"--json", "a", "--csv", "a"}, 2, "a: this output is written twice");
  refused({"builtin:cornell", "--scenes", "."}, 2, "--scenes");
  refused({"builtin:castle"}, 2, "castle");
  refused({"--scenes", "nowhere"}, 1, "nowhere");
  refused({"--scenes", "."}, 1, "no scene");
  refused({"builtin:cornell", "--json", "nowhere/a.json"}, 1, "nowhere/a.json");
}

}  // namespace
}  // namespace raysheaf::test
