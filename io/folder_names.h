// Folders whose names are looked up without regard to case.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>

namespace raysheaf::io {

/// Lists each folder once, when it is first asked about.
class FolderNames {
 public:
  /// The only entry of the folder whose name equals `name` case-insensitively, as it is spelt.
  [[nodiscard]] std::optional<std::string> only_entry(const std::string& folder,
                                                      const std::string& name);

 private:
  /// By the name in lower case; empty if several names are equal.
  using Names = std::unordered_map<std::string, std::string>;
  static Names names_in(const std::string& folder);

  std::unordered_map<std::string, Names> folders_;
};

}  // namespace raysheaf::io
