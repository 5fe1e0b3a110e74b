// Totals follow the paper's counting rule, and the JSON matches docs/statistics.md.
#include "raysheaf/statistics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace raysheaf {
namespace {

BatchStatistics two_level_batch() {
  BatchStatistics batch;
  batch.kind = RayKind::kReflection;
  batch.bounce = 2;
  batch.rays = 1000;
  batch.triangles = 100;
  batch.chunks = 40;
  batch.mesh_sphere_tests = 77;
  batch.levels = {{2, 1600, 500}, {1, 4000, 900}};
  batch.final_tests = 7200;
  batch.hits = 640;
  batch.times_ms = {1, 2, 3, 4, 5};
  return batch;
}

TEST(Statistics, TotalLeavesMeshSpheresOut) {
  const BatchStatistics batch = two_level_batch();
  EXPECT_EQ(batch.total_tests(), 1600u + 4000u + 7200u);
  EXPECT_EQ(batch.brute_force_tests(), 100000u);
  EXPECT_DOUBLE_EQ(batch.relative(), 0.128);
}

TEST(Statistics, TotalHoldsTestsWithBounds) {
  BatchStatistics batch;
  batch.rays = batch.triangles = 10;
  batch.bound_tests = 5;
  batch.ray_bound_tests = 7;
  batch.final_tests = 13;
  EXPECT_EQ(batch.total_tests(), 25u);
  EXPECT_DOUBLE_EQ(batch.relative(), 0.25);
}

TEST(Statistics, BruteForceIsExactlyOne) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 1000; ++i) {
    BatchStatistics batch;
    batch.rays = 1 + random() % 1'000'000;
    batch.triangles = 1 + random() % 100'000;
    batch.final_tests = batch.brute_force_tests();
    EXPECT_EQ(batch.relative(), 1.0);
  }
}

TEST(Statistics, NoTestsMeansNoDivisionByZero) {
  EXPECT_EQ(BatchStatistics{}.relative(), 0.0);
  BatchStatistics no_triangles;
  no_triangles.rays = 5;
  EXPECT_EQ(no_triangles.relative(), 0.0);
}

TEST(Statistics, KindsHaveDistinctNames) {
  EXPECT_STREQ(to_string(RayKind::kPrimary), "primary");
  EXPECT_STREQ(to_string(RayKind::kShadow), "shadow");
  EXPECT_STREQ(to_string(RayKind::kReflection), "reflection");
  EXPECT_STREQ(to_string(RayKind::kRefraction), "refraction");
}

TEST(Statistics, JsonHoldsEveryNumber) {
  FrameStatistics frame;
  frame.scene = "hall";
  frame.triangles = 100;
  frame.meshes = 3;
  frame.width = 40;
  frame.height = 30;
  frame.method = "crsh";
  frame.device = "cpu";
  frame.key = "five-hilbert";
  frame.bound = "shaft";
  frame.primary = "raster";
  frame.threads = 2;
  frame.batches = {two_level_batch()};
  frame.batches[0].bound_tests = 11;
  frame.batches[0].ray_bound_tests = 9;
  frame.batches[0].plan = {"rays: sorted", "bundles: streams"};
  frame.samples = {{1000, 12820, 640, 5}};
  frame.raster_ms = 6;
  frame.shade_ms = 7;
  frame.total_ms = 8;
  const auto json = nlohmann::json::parse(to_json(frame, 9));
  const auto expected = nlohmann::json::parse(R"({
    "scene": "hall", "triangles": 100, "meshes": 3, "width": 40, "height": 30,
    "method": "crsh", "key": "five-hilbert", "bound": "shaft", "device": "cpu", "primary": "raster", "threads": 2,
    "batches": [{"kind": "reflection", "bounce": 2, "rays": 1000, "triangles": 100, "chunks": 40,
      "mesh_sphere_tests": 77,
      "levels": [{"level": 2, "tests": 1600, "hits": 500, "misses": 1100},
                 {"level": 1, "tests": 4000, "hits": 900, "misses": 3100}],
      "bound_tests": 11, "ray_bound_tests": 9,
      "final_tests": 7200, "total_tests": 12820, "brute_force_tests": 100000, "relative": 0.1282,
      "hits": 640, "plan": ["rays: sorted", "bundles: streams"],
      "times_ms": {"raygen": 1.0, "order": 2.0, "hierarchy": 3.0, "traverse": 4.0, "intersect": 5.0}}],
    "samples": [{"rays": 1000, "total_tests": 12820, "hits": 640, "ms": 5.0}],
    "times_ms": {"load": 9.0, "raster": 6.0, "shade": 7.0, "total": 8.0}})");
  EXPECT_EQ(json, expected) << json.dump(2);
}

TEST(Statistics, CountsAbove32BitsAreExact) {
  FrameStatistics frame;
  frame.batches.resize(1);
  frame.batches[0].rays = frame.batches[0].triangles = 0xffffffffull;
  frame.batches[0].final_tests = 0xfffffffe00000001ull;
  const auto batch = nlohmann::json::parse(to_json(frame)).at("batches").at(0);
  EXPECT_EQ(batch.at("brute_force_tests").get<std::uint64_t>(), 0xfffffffe00000001ull);
  EXPECT_EQ(batch.at("total_tests").get<std::uint64_t>(), 0xfffffffe00000001ull);
}

TEST(Statistics, NamesThatAreNotUtf8DoNotThrow) {
  FrameStatistics frame;
  frame.scene = "b\xff\xfe\"\n";
  const auto json = nlohmann::json::parse(to_json(frame));
  EXPECT_EQ(json.at("scene").get<std::string>(), "b\xef\xbf\xbd\xef\xbf\xbd\"\n");
}

}  // namespace
}  // namespace raysheaf
