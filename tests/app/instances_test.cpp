// `raysheaf bench instances`: its CSV, and the answers of its sides.
#include <gtest/gtest.h>

#include "tests/app/peers.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

TEST(Instances, MeasuresMovedAndStillScenes) {
  if (!has_peer()) GTEST_SKIP() << "there is no Embree";
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"bench", "instances", "--shape", "5x100", "--rays", "7", "--rays", "3000",
                    "--flat", "--runs", "1", "--threads", "1", "--csv", "i.csv", "-q"},
                   folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  const std::vector<CsvRow> rows = csv_rows(read_file(folder.file("i.csv")));
  EXPECT_EQ(rows.size(), 8u);
  for (const CsvRow& row : rows) {
    EXPECT_EQ(row.size(), 26u) << "docs/bench.md names them";
    EXPECT_EQ(row.at("triangles"), "100");
    EXPECT_EQ(row.at("hits_equal"), "1");
    EXPECT_EQ(row.at("our_mismatches"), "0");
    for (const char* column : {"ours_ms", "levels_ms", "flat_ms", "flat_ratio", "first_ms",
                               "peer_ms", "ratio", "levels_bytes", "flat_bytes", "peer_bytes"})
      EXPECT_GT(std::stod(row.at(column)), 0) << column;
    EXPECT_TRUE(row.at("plan") == "levels" || row.at("plan") == "flat");
  }
}

TEST(Instances, WrongShapesAreUsageErrors) {
  const TemporaryFolder folder;
  for (const char* shape : {"50", "x1024", "50x3", "0x100"})
    EXPECT_EQ(raysheaf_app({"bench", "instances", "--shape", shape}, folder).code, 2) << shape;
}

}  // namespace
}  // namespace raysheaf::test
