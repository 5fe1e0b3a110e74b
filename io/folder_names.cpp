#include "io/folder_names.h"

#include <dirent.h>

#include <memory>

#include "io/text_lines.h"

namespace raysheaf::io {

/// Uses POSIX functions: the directory iterator of libstdc++ 12 terminates the program if memory
/// runs out.
FolderNames::Names FolderNames::names_in(const std::string& folder) {
  Names names;
  const auto close = [](DIR* opened) { closedir(opened); };
  const std::unique_ptr<DIR, decltype(close)> open(opendir(folder.c_str()), close);
  if (open == nullptr) return names;
  while (const dirent* const entry = readdir(open.get())) {
    const auto [it, fresh] = names.try_emplace(in_lower_case(entry->d_name), entry->d_name);
    if (!fresh) it->second.clear();
  }
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
