// `raysheaf bench compare`: its CSV, refused arguments, and how it compares hits.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "lab/commands/compare/case.h"
#include "lab/commands/compare/frames.h"
#include "lab/commands/compare/scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "tests/app/peers.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using app::CompareFrames;
using app::CompareKind;

const std::vector<std::string> kTinyRun = {"bench",  "compare", "--scene", "builtin:cornell",
                                           "--size", "16x16",   "--runs",  "1",
                                           "--csv",  "c.csv"};

void expect_case(CsvRow c) {
  const auto number = [&](const char* column) { return std::stod(c.at(column)); };
  for (const char* column : {"update_ms", "order_ms", "hierarchy_ms", "trace_ms", "ours_ms",
                             "peer_build_ms", "peer_trace_ms", "peer_ms"})
    EXPECT_GE(number(column), 0) << column;
  for (const char* column : {"rays", "ratio", "cpu_ratio", "compared", "ours_bytes", "peer_bytes"})
    EXPECT_GT(number(column), 0) << column;
  EXPECT_EQ(c["scene"], "cornell");
  EXPECT_EQ(c["triangles"], "792");
  if (c["mode"] == "rebuild")
    EXPECT_EQ(c["worst_frame"], "0");
  else
    EXPECT_GE(number("worst_frame"), 1);
  EXPECT_EQ(c["hits_equal"], "1");
  EXPECT_EQ(c["brute_force_mismatches"], "0");
  EXPECT_EQ(c["size"], "16x16");
  EXPECT_EQ(c["along"], "");
  EXPECT_TRUE(c["plan"].starts_with("tree ")) << c["plan"];
  EXPECT_NE(c["peer_way"].find(", "), std::string::npos) << c["peer_way"];
  double largest = 0;
  std::istringstream versions(c["ratios"]);
  for (std::string each; std::getline(versions, each, ';');)
    largest = std::max(largest, std::stod(each.substr(each.rfind(' '))));
  EXPECT_NEAR(number("ratio"), largest, 1e-5 * largest);
  EXPECT_NE(c["ratios"].find(c["peer_version"] + " "), std::string::npos);
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
  const std::string text = read_file(folder.file("c.csv"));
  std::set<std::pair<std::string, std::string>> seen;
  const std::vector<CsvRow> cases = csv_rows(text);
  for (const CsvRow& c : cases) {
    expect_case(c);
    seen.emplace(c.at("mode"), c.at("kind"));
  }
  EXPECT_EQ(seen.size(), 15u);
  EXPECT_EQ(cases.size(), 15u);
  EXPECT_TRUE(
      text.starts_with("# command: raysheaf bench compare --scene builtin:cornell --size "
                       "16x16 --runs 1\n# peer: Embree "))
      << text;
  EXPECT_NE(text.find("\n# peak_bytes: "), std::string::npos);
  EXPECT_NE(finished.out.find("cornell"), std::string::npos);
}

TEST(Compare, GrowsInHalls) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"bench", "compare", "--growth", "--most", "10000", "--size", "8x8", "--runs",
                    "1", "--mode", "static", "--kind", "random", "--csv", "g.csv"},
                   folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::vector<CsvRow> growth = csv_rows(read_file(folder.file("g.csv")));
  ASSERT_EQ(growth.size(), 2u);
  EXPECT_EQ(growth[0].at("along"), "triangles");
  EXPECT_EQ(growth[1].at("along"), "rays");
  EXPECT_EQ(growth[1].at("rays"), "10000");
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
