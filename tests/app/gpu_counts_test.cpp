// `raysheaf bench gpu --counts`: its table and JSON agree, without a device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

TEST(GpuCounts, TableAndJsonAgree) {
  const TemporaryFolder folder;
  const Finished finished =
      raysheaf_app({"bench", "gpu", "--counts", "-q", "--scene", "builtin:cornell", "--rays",
                    "shadow", "--rays", "ao", "--size", "32x32", "--json", "f.json"},
                   folder);
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const auto all = nlohmann::json::parse(read_file(folder.file("f.json")));
  ASSERT_EQ(all.size(), 1u);
  const auto& batches = all[0]["batches"];
  ASSERT_EQ(batches.size(), 2u);
  EXPECT_EQ(std::count(finished.out.begin(), finished.out.end(), '\n'), 4) << finished.out;
  for (const auto& batch : batches) {
    const auto rays = batch["count"].get<std::uint64_t>();
    EXPECT_EQ(batch["warps"], (rays + 31) / 32);
    char nodes[64];
    std::snprintf(nodes, sizeof nodes, " | %.1f | ",
                  batch["nodes"].get<double>() / static_cast<double>(rays));
    const std::string row = "| " + all[0]["scene"].get<std::string>() + " | " +
                            std::to_string(all[0]["triangles"].get<int>()) + " | " +
                            batch["rays"].get<std::string>() + " | " + std::to_string(rays) + " | ";
    const std::size_t at = finished.out.find(row);
    ASSERT_NE(at, std::string::npos) << row << finished.out;
    EXPECT_NE(finished.out.find(nodes, at), std::string::npos) << nodes << finished.out;
  }
}

}  // namespace
}  // namespace raysheaf::test
