#include "io/folder_names.h"

#include "io/text_lines.h"
#include "system/files.h"

namespace raysheaf::io {

FolderNames::Names FolderNames::names_in(const std::string& folder) {
  Names names;
  system::for_each_name(folder, [&names](const char* name) {
    const auto [it, fresh] = names.try_emplace(in_lower_case(name), name);
    if (!fresh) it->second.clear();
  });
  return names;
}

std::optional<std::string> FolderNames::only_entry(const std::string& folder,
                                                   const std::string& name) {
  auto known = folders_.find(folder);
  if (known == folders_.end()) known = folders_.emplace(folder, names_in(folder)).first;
  const auto found = known->second.find(in_lower_case(name));
  if (found == known->second.end() || found->second.empty()) return std::nullopt;
  return found->second;
}

}  // namespace raysheaf::io
