// Names from files, shortened and cleaned for messages.
#pragma once

#include <string>

namespace raysheaf {

/// ` of "Chair"`, or nothing for an empty name. A file's name may contain anything: it is
/// truncated, and control characters are removed.
inline std::string of_name(const std::string& name) {
  constexpr std::size_t kLongest = 64;
  if (name.empty()) return {};
  std::string shown = name.substr(0, kLongest);
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return " of \"" + shown + (name.size() > kLongest ? "...\"" : "\"");
}

}  // namespace raysheaf
