// The first half of the page, and its tables. findings.cpp writes the explanations.
#include "paper/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "paper/findings.h"
#include "paper/sheets.h"

namespace raysheaf::app {
namespace {

std::string enumerated(const std::vector<std::string>& parts) {
  std::string all;
  for (std::size_t i = 0; i < parts.size(); ++i)
    all += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return all;
}

/// "0.572 % in OFFICE (paper: 1.862 %), ..."
std::string relatives(const PaperReport& report, Method method) {
  std::vector<std::string> parts;
  for (const SceneTotal& t : scene_totals(report.tables)) {
    if (t.method != method) continue;
    parts.push_back(
        fmt::format("{} % in {}", shown_percent(t.relative()), shown_scene(t.scene, t.builtin)));
    if (t.published_total != 0)
      parts.back() += fmt::format(" (paper: {} %)", shown_percent(t.published_relative()));
  }
  return enumerated(parts);
}

bool has(const PaperReport& report, Method method) {
  return std::find(report.methods.begin(), report.methods.end(), method) != report.methods.end();
}

std::string introduction(const PaperReport& report) {
  const char* scenes = report.builtin ? "the built-in scenes, for which nothing was published"
                                      : "the paper's scenes";
  return fmt::format(
      "Reis, Costa and Pereira (\"Coherent Ray-Space Hierarchy via Ray Hashing and Sorting\", "
      "2017) "
      "count the tests that their method `crsh` makes for shadow rays and mirror reflections, "
      "and compare them with brute force and with `rah`, the method that `crsh` extends. `raysheaf "
      "bench paper` repeats the experiment on "
      "{}, at {}x{} pixels, with two levels of branching 8, and writes this page. Every figure is "
      "measured, except those of the paper.\n\n",
      scenes, report.width, report.height);
}

std::string summary(const PaperReport& report) {
  std::string text;
  for (const Method method : {Method::kCrsh, Method::kRah, Method::kDual}) {
    if (!has(report, method)) continue;
    text += fmt::format("* **`{}`** makes {} of the tests of brute force.\n", to_string(method),
                        relatives(report, method));
  }
  if (report.checked)
    text +=
        "* **Hits** of every method and batch were compared with those of brute force; they are "
        "the same, bit for bit.\n";
  if (has_published(report)) text += findings_in_short(report);
  return text + "\n";
}

std::string command_of(const PaperReport& report, bool times) {
  std::string command = "raysheaf bench paper";
  if (!report.builtin) command += " --scenes DIR";
  if (report.width != 512 || report.height != 512)
    command += fmt::format(" --size {}x{}", report.width, report.height);
  if (report.methods != paper_methods())
    for (const Method method : report.methods)
      command += fmt::format(" --method {}", to_string(method));
  if (!report.combinations.empty()) command += " --as-published";
  if (report.checked) command += " --check";
  if (!times) command += " --no-times";
  return "<!-- not run -->\n```sh\n" + command + " --markdown FILE.md\n```\n\n";
}

/// Only prose: the figures are on the pages that it names.
constexpr const char* kKeysAndBounds = R"(
## Which keys and bounds win

[Keys and bounds, measured](ablation.md) has the cross product, and [bounds](../bounds.md) shows how many tests each bounding volume leaves of the shadow rays of these three scenes. In short, the bounding volume must fit the key. All bundles of one light start at one point, so a key of directions along a Hilbert curve with four planes around each bundle is as tight as the bundle itself. Mirror and occlusion rays are best sorted by both of their ends and bounded by the boxes of both. The paper's configuration, a hash of directions with spheres and cones, never makes the fewest tests: its cones have no end and are as wide as the larger of two spreads. In time it is competitive if no mesh can be culled: nearly all tests of SPONZA are then those of the top level with every triangle, and its test is the cheapest.

)";

}  // namespace

std::string paper_page(const PaperReport& report, bool times) {
  std::string page = report.builtin ? "# The paper's experiment on the built-in scenes\n\n"
                                    : "# The paper, reproduced\n\n";
  page += introduction(report) + summary(report) + command_of(report, times);
  for (const Sheet& sheet : paper_sheets(report, times)) page += sheet_markdown(sheet) + "\n";
  if (has_published(report)) page += findings(report);
  for (const Sheet& sheet : combination_sheets(report)) page += sheet_markdown(sheet) + "\n";
  if (!report.builtin) page += inconsistencies() + kKeysAndBounds;
  page.pop_back();
  return page;
}

}  // namespace raysheaf::app
