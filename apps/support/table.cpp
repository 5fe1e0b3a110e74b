#include "apps/support/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace raysheaf::app {
namespace {

// Letters on the screen, which are the bytes that do not continue a UTF-8 sequence.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789.+-e~") == std::string::npos;
}

}  // namespace

std::string Table::text() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 0);
  std::vector<bool> numbers(columns, true);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < columns; ++c) {
      widths[c] = std::max(widths[c], width(row[c]));
      if (&row != &rows_.front()) numbers[c] = numbers[c] && is_number(row[c]);
    }
  }
  std::string all;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string blanks(widths[c] - width(row[c]), ' ');
      line += "  " + (numbers[c] ? blanks + row[c] : row[c] + blanks);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    all += line + "\n";
  }
  return all;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string grouped(const std::string& cell) {
  const std::size_t first = cell.starts_with("~") ? 1 : 0;
  if (first == cell.size() || cell.find_first_not_of("0123456789", first) != std::string::npos)
    return cell;
  std::string all = cell.substr(0, first);
  for (std::size_t i = first; i < cell.size(); ++i) {
    if (i > first && (cell.size() - i) % 3 == 0) all += ' ';
    all += cell[i];
  }
  return all;
}

std::string shown_count(std::uint64_t count) {
  return grouped(std::to_string(count));
}

std::string count_text(std::uint64_t count, const char* one, const char* many) {
  return shown_count(count) + " " + (count == 1 ? one : many);
}

std::string three_digits(double value) {
  if (!(value > 0)) return "0";
  const int before_the_point = static_cast<int>(std::floor(std::log10(value))) + 1;
  return fmt::format("{:.{}f}", value, std::clamp(3 - before_the_point, 0, 12));
}

std::string short_number(double value) {
  if (value < 1e4) return fmt::format("{:.0f}", value);
  if (value < 999.5e3) return fmt::format("{:.3g} k", value / 1e3);
  if (value < 999.5e6) return fmt::format("{:.3g} M", value / 1e6);
  return fmt::format("{:.3g} G", value / 1e9);
}

}  // namespace raysheaf::app
