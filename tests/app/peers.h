// Whether `bench compare` finds a peer on this machine, and the file that it writes.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "lab/commands/compare/embree_library.h"
#include "raysheaf/error.h"

namespace raysheaf::test {

inline bool has_peer() {
  try {
    return !app::find_embree().empty();
  } catch (const Error&) {
    return false;
  }
}

using CsvRow = std::map<std::string, std::string>;  ///< the fields of a line by column

inline std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted)
      fields.emplace_back();
    else if (c != '"')
      fields.back() += c;
  }
  return fields;
}

/// The cases of `text`; the facts before the heading are skipped.
inline std::vector<CsvRow> csv_rows(const std::string& text) {
  std::vector<CsvRow> rows;
  std::vector<std::string> heading;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    const std::vector<std::string> fields = csv_fields(line);
    if (heading.empty()) {
      heading = fields;
    } else if (fields.size() == heading.size()) {
      for (CsvRow& row = rows.emplace_back(); const std::string& field : fields)
        row[heading[row.size()]] = field;
    }
  }
  return rows;
}

}  // namespace raysheaf::test
