// `raysheaf bench scale`: its frames, and processes that cannot be started.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/process.h"

namespace raysheaf::test {
namespace {

TEST(Scale, TheCommandMeasuresFrames) {
  const TemporaryFolder folder;
  const Finished finished = raysheaf_app(
      {"bench", "scale", "--measured", "400K", "--side", "64", "--json", "s.json", "-q"}, folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const auto json = nlohmann::json::parse(read_file(folder.file("s.json")));
  EXPECT_EQ(json["samples"].size(), 4u);
  for (const char* field : {"triangles", "pixels", "rays", "blocks", "read", "batches", "seconds",
                            "bytes", "decoding", "culling", "tracing", "shading", "rest"})
    EXPECT_TRUE(json["samples"][0].contains(field)) << field;
  EXPECT_EQ(json["samples"][0].size(), 13u) << "docs/bench.md names them";
  EXPECT_GT(json["check"]["seconds"].get<double>(), 0);
  EXPECT_GT(json["geometry_bytes"].get<double>(), 8);
}

TEST(Scale, ProcessesThatCannotBeStartedAreASentence) {
  const TemporaryFolder folder;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  if (run_program({self, "--gtest_list_tests"}, folder.path()).code != 0)
    GTEST_SKIP() << "programs of this processor only run in an emulator";
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
