// `raysheaf bench plan`: its table and JSON, and refused arguments.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/plan_bench.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

TEST(BenchPlan, TriesEveryWay) {
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app({"bench", "plan", "--scene", "builtin:cornell", "--size",
                                          "16x16", "--runs", "1", "--json", "p.json"},
                                         folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.out.find("15 cases"), std::string::npos) << finished.out;
  const Json all = Json::parse(read_file(folder.file("p.json")));
  ASSERT_EQ(all["cases"].size(), 15u);
  for (const Json& c : all["cases"]) {
    EXPECT_EQ(c["scene"], "cornell");
    EXPECT_GT(c["rays"].get<int>(), 0);
    EXPECT_FALSE(c["plan"].get<std::string>().empty());
    double largest = 0;
    for (const Json& way : c["ways"]) {
      EXPECT_GT(way["ms"].get<double>(), 0);
      largest = std::max(largest, way["loss"].get<double>());
    }
    EXPECT_EQ(c["loss"].get<double>(), largest);
    EXPECT_GE(c["ways"].size(), 3u);
  }
}

TEST(BenchPlan, RefusesWhatHasNoRays) {
  EXPECT_THROW(static_cast<void>(try_plans({}, PlanMode::kStatic, false, 1, 1)), Error);
  const std::vector<PlanFrame> nothing(1);
  EXPECT_THROW(static_cast<void>(try_plans(nothing, PlanMode::kStatic, false, 1, 1)), Error);
  const Ray ray{{0, 0, 0}, 0, {0, 0, 1}, 1};
  std::vector<PlanFrame> one(1);
  one[0].rays = {&ray, 1};
  EXPECT_THROW(static_cast<void>(try_plans(one, PlanMode::kStatic, false, 1, 0)), Error);
  EXPECT_EQ(try_plans(one, PlanMode::kStatic, false, 1, 1).ways.size(), 5u);
}

}  // namespace
}  // namespace raysheaf::test
