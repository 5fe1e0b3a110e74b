// `raysheaf bench ablation`: its files, its winners, its plots, and refused arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "ablation/ablation.h"
#include "ablation/findings.h"
#include "ablation/pivot.h"
#include "ablation/plots.h"
#include "plot/plots.h"
#include "plot/svg.h"
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

void expect_svg(const std::string& text) {
  EXPECT_TRUE(text.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_TRUE(text.ends_with("</svg>\n"));
  EXPECT_EQ(count_of(text, "<text "), count_of(text, "</text>"));
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf\""), std::string::npos);
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
                                        "a.csv",
                                        "--svg",
                                        "a.svg",
                                        "--markdown",
                                        "a.md"};
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

  const std::string page = read_file(folder.file("a.md"));
  for (const char* what : {"tests", "time"}) {
    const std::string plot = std::string("a-cornell-") + what + ".svg";
    expect_svg(read_file(folder.file(plot)));
    EXPECT_NE(page.find("(" + plot + ")"), std::string::npos);
  }
  EXPECT_EQ(folder.names().size(), 5u);
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
  EXPECT_EQ(app::batches_of(report).size(), 2u);
}

TEST(Ablation, TablesTakeTheMinimumOverTheOtherSettings) {
  const AblationReport report = measured(small_command());
  const app::Pivot keys = app::key_pivot(report, "cornell", LabRays::kShadow, app::percent_of);
  ASSERT_EQ(keys.lines.size(), 2u);
  ASSERT_EQ(keys.columns.size(), 2u);
  for (const app::Pivot::Line& line : keys.lines) {
    for (std::size_t c = 0; c < keys.columns.size(); ++c) {
      for (const AblationRow& row : report.rows) {
        if (to_string(row.settings.key) != line.name ||
            to_string(row.settings.bound) != keys.columns[c])
          continue;
        EXPECT_LE(line.cells[c]->percent(), row.percent());
      }
      EXPECT_GE(line.cells[c]->percent(), keys.least->percent());
    }
  }
  const std::string text = app::pivot_text(keys, app::percent_of);
  EXPECT_EQ(count_of(text, "*"), 1u) << text;
  const app::Pivot trees = app::tree_pivot(report, "cornell", LabRays::kShadow, app::percent_of);
  EXPECT_EQ(trees.columns.size(), 2u);
  EXPECT_EQ(trees.least, keys.least);
}

TEST(Ablation, MeansAreOverTheScenes) {
  AblationReport report;
  report.scenes = {"a", "b"};
  const auto add = [&report](const char* scene, BundleBound bound, std::uint64_t tests, double ms) {
    AblationRow row;
    row.scene = scene;
    row.settings.bound = bound;
    row.counts.rays = row.counts.triangles = 100;
    row.counts.final_tests = tests;
    row.counts.times_ms.traverse = ms;
    report.rows.push_back(row);
  };
  add("a", BundleBound::kSphereCone, 100, 1);
  add("a", BundleBound::kShaft, 50, 2);
  add("b", BundleBound::kSphereCone, 400, 4);
  add("b", BundleBound::kShaft, 50, 8);
  const std::vector<app::Pairing> all = app::pairings(report, LabRays::kShadow);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_NEAR(all[0].percent, 2, 1e-9);
  EXPECT_NEAR(all[1].percent, 0.5, 1e-9);
  EXPECT_NEAR(app::against_sphere_cone(all, BundleBound::kShaft, &app::Pairing::percent), 0.25,
              1e-9);
  EXPECT_NEAR(app::against_sphere_cone(all, BundleBound::kShaft, &app::Pairing::ms), 2, 1e-9);
  EXPECT_TRUE(app::pairings(report, LabRays::kReflection1).empty());
}

TEST(Ablation, PlotsAcceptAnyNumbers) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  expect_svg(app::heat_maps_svg("none", "", {}));
  expect_svg(app::heat_maps_svg("empty", "", {{"a", "b", {"c"}, {{"d", "", {0}}}}}));
  const std::string map = app::heat_maps_svg(
      "<&>", "one", {{"a", "b", {"c", "d"}, {{"r", "1", {nothing, 5}}, {"r", "2", {5, -1}}}}});
  expect_svg(map);
  EXPECT_NE(map.find("&lt;&amp;&gt;"), std::string::npos);
  const app::ScatterKey key{"x", "y", {"c"}, {"s"}};
  expect_svg(app::scatters_svg("none", "", key, {}));
  expect_svg(app::scatters_svg("empty", "", key, {{"p", {}}}));
  expect_svg(app::scatters_svg("one", "", key, {{"p", {{3, 4, 0, 0, "label"}}}}));
  expect_svg(app::scatters_svg("far", "", key,
                               {{"p", {{1e-9, 1e9, 6, 6, "a"}, {1e9, 1e-9, 99, 99, "b"}}}}));
}

TEST(Ablation, NumbersHaveThreeDigits) {
  EXPECT_EQ(app::three_digits(0), "0");
  EXPECT_EQ(app::three_digits(0.00123456), "0.00123");
  EXPECT_EQ(app::three_digits(1.005), "1.00");
  EXPECT_EQ(app::three_digits(36.61), "36.6");
  EXPECT_EQ(app::three_digits(12345), "12345");
  EXPECT_EQ(app::plot_path("d/a.svg", "x y/z", "time"), "d/a-x-y-z-time.svg");
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
  refused({"--svg", "a.png"}, 2, "--svg");
  refused({"--json", "a", "--csv", "a"}, 2, "a: this output is written twice");
  refused({"builtin:cornell", "--scenes", "."}, 2, "--scenes");
  refused({"builtin:castle"}, 2, "castle");
  refused({"--scenes", "nowhere"}, 1, "nowhere");
  refused({"--scenes", "."}, 1, "no scene");
  refused({"builtin:cornell", "--json", "nowhere/a.json"}, 1, "nowhere/a.json");
}

}  // namespace
}  // namespace raysheaf::test
