#include "lab/commands/gpu/counts.h"

#include <fmt/format.h>

#include "apps/support/console.h"
#include "lab/commands/ablation/ablation.h"

namespace raysheaf::app {
namespace {

double quotient(std::uint64_t sum, std::uint64_t count) {
  return static_cast<double>(sum) / static_cast<double>(count);
}

std::string row_of(const std::string& scene, std::uint64_t triangles, const DeviceWalks& walks) {
  return fmt::format(
      "| {} | {} | {} | {} | {:.1f} % | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n",
      printable(scene), triangles, to_string(walks.rays), walks.count,
      100 * quotient(walks.hits, walks.count), quotient(walks.nodes, walks.count),
      quotient(walks.leaves, walks.count), quotient(walks.triangles, walks.count),
      quotient(walks.warp_turns, walks.warps()), quotient(walks.sorted_warp_turns, walks.warps()));
}

}  // namespace

std::string counts_table(const std::vector<SceneWalks>& scenes) {
  std::string text =
      "| Scene | Triangles | Rays | Number of rays | Hits | Nodes per ray | Leaves per ray | "
      "Triangles per ray | Iterations per warp, unsorted rays | Iterations per warp, sorted rays "
      "|\n|---|--:|---|--:|--:|--:|--:|--:|--:|--:|\n";
  for (const SceneWalks& scene : scenes)
    for (const DeviceWalks& walks : scene.report.batches)
      if (walks.count != 0) text += row_of(scene.scene, scene.report.triangles, walks);
  return text;
}

nlohmann::ordered_json counts_json(const std::vector<SceneWalks>& scenes) {
  auto all = nlohmann::ordered_json::array();
  for (const SceneWalks& scene : scenes) {
    auto batches = nlohmann::ordered_json::array();
    for (const DeviceWalks& walks : scene.report.batches)
      batches.push_back({{"rays", to_string(walks.rays)},
                         {"count", walks.count},
                         {"hits", walks.hits},
                         {"nodes", walks.nodes},
                         {"leaves", walks.leaves},
                         {"triangles", walks.triangles},
                         {"warps", walks.warps()},
                         {"warp_turns", walks.warp_turns},
                         {"sorted_warp_turns", walks.sorted_warp_turns}});
    all.push_back(
        {{"scene", scene.scene}, {"triangles", scene.report.triangles}, {"batches", batches}});
  }
  return all;
}

}  // namespace raysheaf::app
