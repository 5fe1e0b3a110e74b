// Aligned columns, and numbers for people.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::app {

/// Rows of cells; the first row is the heading. Columns that contain only numbers below the heading
/// are aligned to the right, others to the left.
class Table {
 public:
  explicit Table(std::vector<std::string> heading) : rows_{std::move(heading)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] bool empty() const { return rows_.size() == 1; }
  /// Each row on its own line, with two blanks before it and between columns.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// A field of a line of CSV: in quotes if it contains a comma, a quote or the end of a line.
[[nodiscard]] std::string csv_field(const std::string& text);

/// "1 234 567" for "1234567", "~1 234" for "~1234": digits in groups of three, if the whole cell is
/// a number.
[[nodiscard]] std::string grouped(const std::string& cell);

/// "1 234 567".
[[nodiscard]] std::string shown_count(std::uint64_t count);

/// "1 mesh", "2 meshes", "12 345 meshes".
[[nodiscard]] std::string count_text(std::uint64_t count, const char* one, const char* many);

/// Three significant digits, without an exponent.
[[nodiscard]] std::string three_digits(double value);

/// Three digits and a unit: "9876", "12.3 k", "1.5 M", "2 G".
[[nodiscard]] std::string short_number(double value);

}  // namespace raysheaf::app
