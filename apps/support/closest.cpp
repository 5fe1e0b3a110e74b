#include "apps/support/closest.h"

#include <algorithm>
#include <cstddef>

namespace raysheaf::app {
namespace {

/// Optimal string alignment: insertions, deletions, replacements and swaps of neighbours.
std::size_t edits_between(const std::string& a, const std::string& b) {
  const std::size_t columns = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * columns);
  const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
    return cost[i * columns + j];
  };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({replaced, at(i - 1, j) + 1, at(i, j - 1) + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(a.size(), b.size());
}

std::string without_dashes(const std::string& word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

}  // namespace

std::string closest(const std::string& word, const std::vector<std::string>& known) {
  constexpr std::size_t kFewestLetters = 2, kLongestWord = 64;
  const std::string letters = without_dashes(word);
  if (letters.size() < kFewestLetters || letters.size() > kLongestWord) return "";
  std::string best;
  std::size_t fewest = std::max<std::size_t>(letters.size() / 3, 1) + 1;
  for (const std::string& candidate : known) {
    const std::string other = without_dashes(candidate);
    if (other.size() < kFewestLetters) continue;
    const std::size_t edits = other.starts_with(letters) ? 0 : edits_between(letters, other);
    if (edits >= fewest) continue;
    fewest = edits;
    best = candidate;
  }
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string best = closest(word, known);
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

}  // namespace raysheaf::app
