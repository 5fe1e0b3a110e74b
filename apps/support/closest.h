// Suggestions for words that were mistyped.
#pragma once

#include <string>
#include <vector>

namespace raysheaf::app {

/// The known word that `word` is probably a mistyping of: it begins with `word`, or at most one
/// letter in three was inserted, left out, replaced or swapped with its neighbour. Empty if no
/// known word is that near. O(known words * length^2).
[[nodiscard]] std::string closest(const std::string& word, const std::vector<std::string>& known);

/// "; did you mean 'WORD'?" with the closest known word, or an empty string.
[[nodiscard]] std::string did_you_mean(const std::string& word,
                                       const std::vector<std::string>& known);

}  // namespace raysheaf::app
