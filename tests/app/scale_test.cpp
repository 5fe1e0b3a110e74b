// The cost model of streamed frames, and its command.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/raysheaf/scale/model.h"
#include "support/process.h"

namespace raysheaf::test {
namespace {

using app::ScaleCost;
using app::ScaleForecast;
using app::ScaleMachines;
using app::ScaleModel;
using app::ScaleSample;

/// Samples on a straight line.
std::vector<ScaleSample> straight() {
  std::vector<ScaleSample> samples;
  for (const double triangles : {1e6, 8e6}) {
    for (const double pixels : {65536.0, 262144.0}) {
      ScaleSample s;
      s.triangles = triangles;
      s.pixels = pixels;
      s.batches = 2;
      s.cost.decode_s = 2e-8 * triangles;
      s.cost.trace_s = 0.01 + 3e-8 * triangles + 1e-6 * pixels;
      s.cost.rest_s = 2e-6 * pixels;
      s.cost.bytes = 12 * triangles;
      samples.push_back(s);
    }
  }
  return samples;
}

TEST(Scale, TheFitFindsStraightLines) {
  const ScaleModel model(straight());
  const ScaleCost cost = model.cost(1e9, 1e6);
  EXPECT_NEAR(cost.decode_s, 20, 1e-6);
  EXPECT_NEAR(cost.trace_s, 31.01, 1e-4);
  EXPECT_NEAR(cost.rest_s, 2, 1e-6);
  EXPECT_NEAR(cost.bytes, 12e9, 1);
  EXPECT_EQ(cost.cull_s, 0);
  for (const double k : model.coefficients(&ScaleCost::trace_s)) EXPECT_GE(k, 0);
}

TEST(Scale, MoreResourcesAreNoSlowerExceptTheNetwork) {
  const ScaleModel model(straight());
  ScaleMachines machines;
  machines.cores = 8;
  const auto geometry = [&] { return forecast_geometry(model, 1e9, 262144, 2, machines); };
  const ScaleForecast one = geometry();
  EXPECT_EQ(one.network_s, 0);
  EXPECT_NEAR(one.disk_s, 6, 1e-3);
  EXPECT_STREQ(one.bound_by, "cores");
  machines.ranks = 16;
  const ScaleForecast sixteen = geometry();
  EXPECT_LT(sixteen.total_s, one.total_s);
  EXPECT_GT(sixteen.network_s, 0);
  machines.disk_bytes_s = 1e6;
  EXPECT_STREQ(geometry().bound_by, "disk");
  machines.network_bytes_s = 1e3;
  EXPECT_STREQ(geometry().bound_by, "network");
  EXPECT_LT(forecast_rays(model, 1e9, 262144, 1, machines).total_s,
            forecast_rays(model, 1e9, 262144, 0, machines).total_s);
}

TEST(Scale, TheSpeedOfOneCoreIsRecovered) {
  ScaleMachines machines;
  for (const double cores : {2.0, 16.0}) {
    for (const double serial : {0.0, 0.1, 1.0}) {
      machines.cores = cores;
      machines.serial = serial;
      EXPECT_NEAR(app::serial_part(3, clock_seconds(3, machines), cores), serial, 1e-9);
    }
    EXPECT_EQ(app::serial_part(3, 0.1, cores), 0) << "faster than all cores can be";
  }
  EXPECT_EQ(app::serial_part(3, 3, 1), 0);
}

TEST(Scale, TheCommandMeasuresAndChecksItself) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"bench", "scale", "--measured", "400K", "--side", "64", "--triangles", "5M",
                    "--json", "s.json", "--markdown", "s.md", "-q"},
                   folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const auto json = nlohmann::json::parse(read_file(folder.file("s.json")));
  EXPECT_EQ(json["samples"].size(), 4u);
  for (const char* field : {"triangles", "pixels", "rays", "blocks", "read", "batches", "seconds",
                            "bytes", "decoding", "culling", "tracing", "shading", "rest"})
    EXPECT_TRUE(json["samples"][0].contains(field)) << field;
  EXPECT_EQ(json["samples"][0].size(), 13u) << "docs/bench.md names them";
  EXPECT_GT(json["check"]["seconds"].get<double>(), 0);
  EXPECT_GT(json["geometry_bytes"].get<double>(), 8);
  const std::string page = read_file(folder.file("s.md"));
  EXPECT_TRUE(page.starts_with("# Scale: what 5 M triangles would take\n")) << page.substr(0, 80);
  for (const char* heading : {"## Measured", "## Fitted", "## Processes", "## One machine",
                              "## Several machines", "## Where it saturates"})
    EXPECT_NE(page.find(heading), std::string::npos) << heading;
}

TEST(Scale, ProcessesThatCannotBeStartedAreASentence) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& mpirun) {
    return raysheaf_app(
        {"bench", "scale", "--measured", "100K", "--side", "32", "-q", "--mpirun", mpirun}, folder);
  };
  Finished finished = run("/nowhere/mpirun --oversubscribe");
  EXPECT_EQ(finished.code, 1);
  EXPECT_EQ(finished.err,
            "raysheaf: /nowhere/mpirun: cannot be started: No such file or directory\n");
  finished = run("false");
  EXPECT_EQ(finished.code, 1);
  EXPECT_EQ(finished.err, "raysheaf: false: ended with status 1\n");
  // A launcher that always starts a single process.
  write_file(folder.file("one"), "#!/bin/sh\nshift 2\nexec \"$@\"\n");
  finished = run("sh " + folder.file("one"));
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_NE(finished.out.find("processes  threads each"), std::string::npos) << finished.out;
}

}  // namespace
}  // namespace raysheaf::test
