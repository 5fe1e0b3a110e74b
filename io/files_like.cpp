// Finds files by a pattern and sorts them by the numbers in their names.
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "raysheaf/animation.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

namespace fs = std::filesystem;

/// Compares names with runs of digits as numbers: "f2" comes before "f10".
bool by_number(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (!digit(a[i]) || !digit(b[k])) {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i, ++k;
      continue;
    }
    const auto run = [&](const std::string& text, std::size_t& at) {
      const std::size_t first = std::min(text.find_first_not_of('0', at), text.size());
      at = first;
      while (at < text.size() && digit(text[at])) ++at;
      return std::string_view(text).substr(first, at - first);
    };
    const std::string_view x = run(a, i), y = run(b, k);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - k || (a.size() - i == b.size() - k && a < b);
}

}  // namespace

std::vector<std::string> files_like(const std::string& pattern) {
  const std::size_t slash = pattern.rfind('/') + 1;
  const std::string folder = pattern.substr(0, slash), wanted = pattern.substr(slash);
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, failed), end;
       !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (fnmatch(wanted.c_str(), name.c_str(), FNM_PERIOD) == 0 && entry->is_regular_file(failed))
      names.push_back(name);
  }
  if (failed)
    throw Error(ErrorCode::kNotFound, "the folder cannot be read: " + failed.message(), pattern);
  if (names.empty()) throw Error(ErrorCode::kNotFound, "no file has such a name", pattern);
  std::sort(names.begin(), names.end(), by_number);
  for (std::string& name : names) name.insert(0, folder);
  return names;
}

}  // namespace raysheaf
