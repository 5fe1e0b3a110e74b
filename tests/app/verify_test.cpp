// `raysheaf verify` as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/raysheaf/verify/report.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

using Json = nlohmann::json;

TEST(Verify, ReportsWhatWasTried) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"verify", "--rounds", "2", "--json", "report.json"}, folder);
  EXPECT_EQ(finished.code, 0) << finished.out << finished.err;
  EXPECT_EQ(finished.err, "");
  EXPECT_NE(finished.out.find("Every promise was kept."), std::string::npos) << finished.out;
  const Json report = Json::parse(read_file(folder.file("report.json")));
  EXPECT_TRUE(report["kept"]);
  EXPECT_FALSE(report["simd_targets"].empty());
  ASSERT_EQ(report["promises"].size(), kPromises.size());
  for (const Json& promise : report["promises"]) {
    const std::string name = promise["promise"];
    EXPECT_NE(finished.out.find("  " + name), std::string::npos) << finished.out;
    EXPECT_GT(promise["tried"], 0) << name;
    EXPECT_EQ(promise["failed"], 0) << name;
    EXPECT_EQ(promise["rounds"], 2) << name;
  }
  for (const Json& errors : report["errors"])
    EXPECT_EQ(errors["counts"].size(), errors["limits"].size() + 1);
}

TEST(Verify, OnlySomeFromASeed) {
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app({"verify", "--only", "bounds", "--only", "exact",
                                          "--rounds", "1", "--seed", "18446744073709551615"},
                                         folder);
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.out.find("seed 18446744073709551615"), std::string::npos);
  EXPECT_NE(finished.out.find("bounds"), std::string::npos);
  EXPECT_EQ(finished.out.find("watertight"), std::string::npos) << finished.out;
}

TEST(Verify, ForSoManySeconds) {
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app(
      {"verify", "--only", "history", "--seconds", "1", "--json", "report.json"}, folder);
  EXPECT_EQ(finished.code, 0) << finished.out << finished.err;
  const Json report = Json::parse(read_file(folder.file("report.json")));
  ASSERT_EQ(report["promises"].size(), 1u);
  EXPECT_GE(report["promises"][0]["rounds"], 1);
  EXPECT_GE(report["promises"][0]["seconds"], 1.0);
}

TEST(Verify, AFailureComesWithTheCommandThatShowsItAgain) {
  VerifyReport report;
  report.seed = 5;
  PromiseReport promise;
  promise.promise = Promise::kWatertight;
  promise.unit = "rays";
  promise.cases = 1234567;
  promise.failures = 3;
  promise.first_failures = {{7, "a ray passes through a box"}};
  report.promises = {promise};
  const std::string text = app::verify_text(report);
  for (const char* const words :
       {"1 234 567 rays", "watertight: a ray passes through a box",
        "raysheaf verify --only watertight --seed 7 --rounds 1", "Not every promise was kept."})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  const Json json = Json::parse(app::verify_json(report));
  EXPECT_FALSE(json["kept"]);
  EXPECT_EQ(json["promises"][0]["first_failures"][0]["seed"], 7);
}

TEST(Verify, RefusesWhatMakesNoSense) {
  const TemporaryFolder folder;
  const auto refused = [&](std::vector<std::string> arguments, const std::string& words) {
    arguments.insert(arguments.begin(), "verify");
    const Finished finished = raysheaf_app(arguments, folder);
    EXPECT_EQ(finished.code, 2);
    EXPECT_NE(finished.err.find(words), std::string::npos) << finished.err;
  };
  refused({"--only", "speed"},
          "'speed' is not a promise; the promises are brute-force, determinism");
  refused({"--seed", "-1"}, "--seed: '-1' is not a whole number");
  refused({"--rounds", "many"}, "--rounds");
  refused({"--long", "--only", "bounds"}, "--long");
  refused({"--seconds", "soon"}, "--seconds");
  refused({"--seconds", "5", "--rounds", "1"}, "--seconds: it excludes --rounds and --long");
  refused({"--seconds", "5", "--long"}, "--seconds: it excludes --rounds and --long");
  refused({"--only", "watertight", "--long", "--rounds", "1"}, "--rounds: --long sets the number");
  refused({"--only", "exact", "--long", "--rounds", "1"}, "--rounds: --long sets the number");
  EXPECT_TRUE(folder.names().empty());
}

TEST(Verify, CtrlCStops) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"verify", "--only", "watertight", "--long", "--json", "report.json"}, folder,
                   std::chrono::milliseconds(500));
  EXPECT_EQ(finished.code, 130) << finished.err;
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace raysheaf::test
