// Columns that line up.
#pragma once

#include <string>
#include <vector>

namespace raysheaf::app {

/// Rows of cells; the first row is the heading. Columns whose cells below the heading are all
/// numbers go to the right, others to the left.
class Table {
 public:
  explicit Table(std::vector<std::string> heading) : rows_{std::move(heading)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] bool empty() const { return rows_.size() == 1; }
  /// Each row on a line of its own, two blanks before it and between columns.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// "1 234 567" of "1234567", "~1 234" of "~1234": digits in groups of three, where the whole cell
/// is a number.
[[nodiscard]] std::string grouped(const std::string& cell);

}  // namespace raysheaf::app
