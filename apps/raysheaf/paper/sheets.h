// The findings of a bench, as tables of cells that text and Markdown share.
#pragma once

#include <string>
#include <vector>

#include "paper/paper.h"

namespace raysheaf::app {

struct Sheet {
  std::string title, note;  ///< `note` is a sentence above the table, or empty
  std::vector<std::string> heading;
  std::vector<std::vector<std::string>> rows;
};

/// `--as-published` adds the tables of the combinations.
[[nodiscard]] std::vector<Sheet> paper_sheets(const PaperReport& report, bool times);
[[nodiscard]] std::vector<Sheet> combination_sheets(const PaperReport& report);

/// The title on a line, then aligned columns.
[[nodiscard]] std::string sheet_text(const Sheet& sheet);
/// A heading of the second level and a table; whole numbers in groups of three digits.
[[nodiscard]] std::string sheet_markdown(const Sheet& sheet);

/// "OFFICE", as the paper writes its own, or "builtin:office".
[[nodiscard]] std::string shown_scene(const std::string& scene, bool builtin);
/// "shadow", "reflection 1", "reflection 1 + 2".
[[nodiscard]] std::string shown_rays(const BatchStatistics& counts);

/// "142 726 748".
[[nodiscard]] std::string shown_count(std::uint64_t count);
/// Three decimals, or "-" for 0, which stands for an unknown figure.
[[nodiscard]] std::string shown_ratio(double ratio);
/// A fraction as a percentage: "1.86".
[[nodiscard]] std::string shown_percent(double fraction);

/// Whether it differs by more than the 10 % above which the page explains the cause; false if one
/// figure is not known.
[[nodiscard]] bool is_far(double ratio);

/// All kinds of rays of one scene by one method.
struct SceneTotal {
  std::string scene;
  bool builtin = false;
  Method method = Method::kBrute;
  std::uint64_t total = 0, brute_force = 0;
  std::uint64_t published_total = 0, published_brute_force = 0;  ///< 0 if a kind is unpublished
  [[nodiscard]] double relative() const;
  [[nodiscard]] double published_relative() const;
};
[[nodiscard]] std::vector<SceneTotal> scene_totals(const std::vector<Measured>& tables);

}  // namespace raysheaf::app
