// `raysheaf bench compare`: its JSON, refused arguments, and how it compares hits.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "lab/commands/compare/case.h"
#include "lab/commands/compare/compare.h"
#include "lab/commands/compare/frames.h"
#include "lab/commands/compare/scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "tests/app/peers.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;
using app::CompareCase;
using app::CompareFrames;
using app::CompareKind;
using app::CompareMode;
using app::CompareReport;

const std::vector<std::string> kTinyRun = {"bench",  "compare", "--scene", "builtin:cornell",
                                           "--size", "16x16",   "--runs",  "1",
                                           "--json", "c.json"};

void expect_case(const Json& c) {
  for (const char* field : {"update", "order", "hierarchy", "trace", "total"})
    EXPECT_GE(c["ours_ms"][field].get<double>(), 0) << field;
  for (const char* field : {"build", "trace", "total"})
    EXPECT_GE(c["peer_ms"][field].get<double>(), 0) << field;
  EXPECT_EQ(c["scene"], "cornell");
  EXPECT_EQ(c["triangles"], 792);
  EXPECT_GT(c["rays"].get<int>(), 0);
  EXPECT_GT(c["ratio"].get<double>(), 0);
  EXPECT_GT(c["cpu_ratio"].get<double>(), 0);
  if (c["mode"] == "rebuild")
    EXPECT_EQ(c["worst_frame"], 0);
  else
    EXPECT_GE(c["worst_frame"].get<double>(), 1);
  EXPECT_TRUE(c["hits_equal"].get<bool>()) << c;
  EXPECT_GT(c["hits"]["compared"].get<int>(), 0);
  EXPECT_EQ(c["hits"]["brute_force_mismatches"], 0);
  EXPECT_TRUE(c["peer"].get<std::string>().starts_with("embree "));
  EXPECT_EQ(c["peer_name"], "Embree");
  EXPECT_GE(c["peer_trials"].size(), 5u);
  EXPECT_EQ(c["size"], "16x16");
  EXPECT_FALSE(c["plan_short"].get<std::string>().empty());
  double largest = 0;
  std::set<std::string> versions;
  for (const Json& peer : c["peers"]) {
    largest = std::max(largest, peer["ratio"].get<double>());
    versions.insert(peer["version"]);
  }
  EXPECT_EQ(c["ratio"], largest);
  EXPECT_EQ(versions.count(c["peer_version"]), 1u);
}

TEST(Compare, AHallWithoutANumberIsAUsageError) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app({"bench", "compare", "--scene", "hall:x"}, folder);
  EXPECT_EQ(finished.code, 2);
  EXPECT_TRUE(finished.err.starts_with("raysheaf: --scene: 'x' is not a whole number"))
      << finished.err;
}

TEST(Compare, MeasuresEveryKindAndMode) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app(kTinyRun, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Json all = Json::parse(read_file(folder.file("c.json")));
  std::set<std::pair<std::string, std::string>> seen;
  for (const Json& c : all["cases"]) {
    expect_case(c);
    seen.emplace(c["mode"], c["kind"]);
  }
  EXPECT_EQ(seen.size(), 15u);
  EXPECT_EQ(all["cases"].size(), 15u);
  for (const char* mode : {"rebuild", "refit", "static"})
    EXPECT_EQ(all["geomean"][mode].size(), 6u) << mode;
  EXPECT_GT(all["peak_bytes"].get<double>(), 0);
  EXPECT_EQ(all["command"], "raysheaf bench compare --scene builtin:cornell --size 16x16 --runs 1");
  EXPECT_NE(finished.out.find("cornell"), std::string::npos);
}

TEST(Compare, GrowsInHalls) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"bench", "compare", "--growth", "--most", "10000", "--size", "8x8", "--runs",
                    "1", "--mode", "static", "--kind", "random", "--json", "g.json"},
                   folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Json all = Json::parse(read_file(folder.file("g.json")));
  ASSERT_EQ(all["growth"].size(), 2u);
  EXPECT_EQ(all["growth"][0]["along"], "triangles");
  EXPECT_EQ(all["growth"][1]["rays"], 10000);
  EXPECT_TRUE(all["cases"].empty());
}

TEST(Compare, RefusesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto code = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"bench", "compare"});
    const Finished finished = raysheaf_app(arguments, folder);
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    return finished.code;
  };
  EXPECT_EQ(code({"--kind", "refraction"}), 2);
  EXPECT_EQ(code({"--mode", "frozen"}), 2);
  EXPECT_EQ(code({"--runs", "0"}), 2);
  EXPECT_EQ(code({"--growth", "--scene", "builtin:cornell"}), 2);
  EXPECT_EQ(code({"--growth", "--size", "8x8", "--size", "16x16"}), 2);
  EXPECT_EQ(code({"--size", "8x8", "--size", "0x16"}), 2);
  if (!has_peer()) return;
  EXPECT_EQ(code({"--scene", "sponza"}), 2);
  EXPECT_EQ(code({"--scene", "builtin:nowhere"}), 2);
  EXPECT_EQ(code({"--scene", "hall:many"}), 2);
  EXPECT_EQ(code({"--scene", "hall:12"}), 2);
  EXPECT_EQ(code({"--scenes", folder.file("nothing")}), 1);
  EXPECT_EQ(code({"--scene", "nothing.glb"}), 1);
  EXPECT_TRUE(folder.names().empty());
}

TEST(CompareFrames, DifferInEveryMesh) {
  CompareFrames frames(builtin_scene("cornell"), true);
  const auto first = frames.meshes(0, false), second = frames.meshes(1, false);
  const auto refitted = frames.meshes(1, true);
  ASSERT_EQ(first.size(), 7u);
  ASSERT_EQ(second.size(), 7u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].positions.size(), second[i].positions.size());
    EXPECT_NE(first[i].positions[0].x, second[i].positions[0].x);
    EXPECT_EQ(first[i].triangles.front(), second[i].triangles.back());
    EXPECT_EQ(first[i].triangles.data(), refitted[i].triangles.data());
    EXPECT_EQ(second[i].positions.data(), refitted[i].positions.data());
  }
}

TEST(CompareFrames, RaysAreAsManyAsPixels) {
  CompareFrames frames(builtin_scene("cornell"), true);
  frames.make_rays(app::all_compare_kinds(), 16, 16, 1);
  for (std::size_t frame = 0; frame < 2; ++frame) {
    for (const CompareKind kind : app::all_compare_kinds()) {
      const std::vector<Ray>& rays = frames.rays(frame, kind);
      EXPECT_GT(rays.size(), 128u) << to_string(kind);
      EXPECT_LE(rays.size(), 256u) << to_string(kind);
      for (const Ray& ray : rays) {
        EXPECT_GT(std::hypot(ray.direction.x, ray.direction.y, ray.direction.z), 0);
        EXPECT_LE(ray.t_min, ray.t_max);
      }
    }
  }
  const Ray& shadow = frames.rays(0, CompareKind::kShadow).front();
  EXPECT_EQ(shadow.origin.y, 52);  // the lamp
  EXPECT_EQ(shadow.t_max, 1);
}

TEST(CompareFrames, ASingleFrameIsTheSceneItself) {
  CompareFrames frames(builtin_scene("office"), false);
  EXPECT_EQ(frames.frame_count(), 1u);
  EXPECT_EQ(frames.triangle_count(), builtin_scene("office").triangle_count());
}

TEST(CompareHits, TellsEdgesFromErrors) {
  const std::vector<Ray> rays(5, Ray{{0, 0, 0}, 0, {0, 0, 2}, 10});
  std::vector<Hit> ours(5), theirs(5);
  ours[0] = theirs[0] = {1, 0.25f, 0.25f, 3, 0, 0};
  ours[1] = {1, 0, 0, 3, 0, 0};
  theirs[1] = {1.00001f, 0, 0, 4, 0, kInvalidId};  // the neighbouring triangle, at a shared edge
  ours[2] = {1, 0, 0, 3, 0, 0};
  theirs[2] = {1.01f, 0, 0, 3, 0, kInvalidId};
  ours[3] = {1, 0, 0, 3, 0, 0};  // the peer misses
  const app::HitCheck check = app::compare_hits(rays, ours, theirs, 0);
  EXPECT_EQ(check.compared, 5u);
  EXPECT_EQ(check.mismatches, 2u);
  EXPECT_EQ(check.other_triangles, 1u);
  EXPECT_FALSE(check.equal());
  EXPECT_EQ(app::compare_hits(rays, ours, theirs, 0.05f).mismatches, 1u);
  EXPECT_EQ(
      app::compare_flags(std::vector<std::uint8_t>{0, 1, 1}, std::vector<std::uint8_t>{0, 1, 0})
          .mismatches,
      1u);
}

/// Two rays hit the square at t = 2; one passes next to it, one ends in front of it.
TEST(CompareHits, ExactArithmeticDecides) {
  const std::vector<Vec3> positions{{-1, -1, 4}, {1, -1, 4}, {1, 1, 4}, {-1, 1, 4}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<app::MeshView> meshes{{positions, triangles}};
  const Ray at{{0, 0, 0}, 0, {0, 0, 2}, 10}, beside{{3, 0, 0}, 0, {0, 0, 2}, 10};
  const Ray short_of{{0, 0, 0}, 0, {0, 0, 2}, 1.5f};
  const std::vector<Ray> rays{at, beside, short_of, at};
  const Hit there{2, 0, 0, 0, 0, 0}, wrong{2.5f, 0, 0, 0, 0, 0}, none;
  const std::vector<Hit> ours{there, none, none, there}, theirs{wrong, there, there, none};
  app::HitCheck check = app::compare_hits(rays, ours, theirs, 0);
  EXPECT_EQ(check.differing, (std::vector<std::size_t>{0, 1, 2, 3}));
  app::settle_hits(meshes, rays, ours, theirs, 0, &check);
  EXPECT_EQ(check.settled, 4u);
  EXPECT_EQ(check.ours_right, 4u);
  EXPECT_EQ(check.peer_right, 0u);
  const std::vector<std::uint8_t> our_flags{1, 0, 1, 1}, their_flags{0, 1, 0, 1};
  app::HitCheck flags = app::compare_flags(our_flags, their_flags);
  app::settle_flags(meshes, rays, our_flags, their_flags, &flags);
  EXPECT_EQ(flags.settled, 3u);
  EXPECT_EQ(flags.ours_right, 2u);
  EXPECT_EQ(flags.peer_right, 1u);
}

TEST(CompareHits, OneInTenThousandMayDiffer) {
  app::HitCheck check;
  check.compared = 20'000;
  check.mismatches = 2;
  EXPECT_TRUE(check.equal());
  check.mismatches = 3;
  EXPECT_FALSE(check.equal());
  check.mismatches = 0;
  check.sample_mismatches = 1;
  EXPECT_FALSE(check.equal());
}

CompareCase made_case(const std::string& scene, std::uint64_t triangles, CompareMode mode,
                      double ratio) {
  CompareCase c;
  c.scene = scene;
  c.triangles = triangles;
  c.rays = 1000;
  c.mode = mode;
  c.ours_ms.total = ratio;
  c.peer.ms.total = 1;
  c.peer.ratio = ratio;
  return c;
}

TEST(Compare, LimitsAreThoseOfTheRow) {
  EXPECT_EQ(app::limit_of(made_case("s", 66'450, CompareMode::kRebuild, 1)), 0.5);
  EXPECT_EQ(app::limit_of(made_case("s", 999'638, CompareMode::kRebuild, 1)), 0.25);
  EXPECT_EQ(app::limit_of(made_case("s", 792, CompareMode::kRebuild, 1)), std::nullopt);
  EXPECT_EQ(app::limit_of(made_case("s", 792, CompareMode::kStatic, 1)), 1.0);
  EXPECT_TRUE(app::misses_limit(made_case("s", 66'450, CompareMode::kRefit, 0.81)));
  EXPECT_FALSE(app::misses_limit(made_case("s", 66'450, CompareMode::kRefit, 0.8)));
}

TEST(CompareScenes, KnownNamesAndHalls) {
  EXPECT_EQ(app::compare_scene_from_string("hall:1m", "").name, "hall_1m");
  EXPECT_EQ(app::compare_scene_from_string("hall_10m", "").source, "hall:10000000");
  EXPECT_EQ(app::compare_scene_from_string("hall:4500", "").name, "hall_4500");
  EXPECT_EQ(app::compare_scene_from_string("sponza", "dir").source, "dir/paper/sponza.glb");
  EXPECT_EQ(app::compare_scene_from_string("a/model.glb", "").name, "model");
  EXPECT_EQ(app::compare_scene_from_string("hall_1m.obj", "").source, "hall_1m.obj");
  const auto apart = app::compare_scenes_from_strings(
      {"office", "builtin:office", "builtin:cornell", "a/bunny.ply", "b/bunny.ply"}, "dir");
  std::vector<std::string> names;
  for (const app::CompareScene& scene : apart) names.push_back(scene.name);
  EXPECT_EQ(names, (std::vector<std::string>{"office", "builtin:office", "cornell", "a/bunny.ply",
                                             "b/bunny.ply"}));
  std::vector<std::string> notes;
  const auto all = app::default_compare_scenes("", &notes);
  EXPECT_EQ(all.size() + notes.size(), builtin_scene_names().size() + 2);
}

}  // namespace
}  // namespace raysheaf::test
