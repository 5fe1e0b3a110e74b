#include "io/named_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "io/refuse.h"
#include "io/text_lines.h"
#include "system/paths.h"

namespace raysheaf::io {
namespace {

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

std::string last_part(const std::string& name) {
  const std::string turned = with_slashes(name);
  return turned.substr(turned.rfind('/') + 1);
}

/// Searches one folder after the other.
class Finder {
 public:
  Finder(const SceneFile& from, const std::string& named_in)
      : from_(from), root_(folder_of(from.path)), folders_{folder_of(named_in)} {
    if (folders_[0] != root_) folders_.push_back(root_);
  }

  /// The path of the name in the folder, if it is allowed there.
  [[nodiscard]] std::optional<std::string> place_of(const std::string& folder,
                                                    const std::string& name) const {
    if (name.empty() || name.find('\0') != name.npos || name.find(':') != name.npos)
      return std::nullopt;
    const std::filesystem::path named = system::path_of(name),
                                joined = system::path_of(folder) / named;
    if (system::has_special_name(named)) return std::nullopt;
    const std::filesystem::path path = joined.lexically_normal();
    const std::filesystem::path inside =
        path.lexically_relative(system::path_of(root_).lexically_normal());
    const bool leaves = named.has_root_path() || inside.empty() || *inside.begin() == "..";
    if (leaves && !from_.allow_external) return std::nullopt;
    // Keeps the folder as the caller wrote it, unless the name has "..".
    return system::text_of(name.find("..") == name.npos ? joined : path);
  }
  [[nodiscard]] std::optional<std::string> exact(const std::string& name) const {
    for (const std::string& folder : folders_) {
      auto path = place_of(folder, name);
      if (path && file_exists(*path)) return path;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::string> in_any_case(const std::string& name) const {
    for (const std::string& folder : folders_) {
      if (!place_of(folder, name)) continue;
      if (auto path = path_in_any_case(folder, name)) return path;
    }
    return std::nullopt;
  }
  /// The first path that is tried.
  [[nodiscard]] std::optional<std::string> first_place(const std::string& name) const {
    for (const std::string& folder : folders_)
      if (auto path = place_of(folder, name)) return path;
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<std::string> path_in_any_case(const std::string& folder,
                                                            const std::string& name) const {
    std::filesystem::path path = system::path_of(folder);
    for (const std::filesystem::path& part : system::path_of(name)) {
      std::error_code failed;
      if (!std::filesystem::exists(path / part, failed)) {
        const auto entry = from_.folders->only_entry(system::text_of(path), system::text_of(part));
        if (!entry) return std::nullopt;
        path /= system::path_of(*entry);
      } else {
        path /= part;
      }
    }
    std::string found = system::text_of(path);
    return file_exists(found) ? std::optional(std::move(found)) : std::nullopt;
  }

  const SceneFile& from_;
  std::string root_;
  std::vector<std::string> folders_;
};

NamedFile standing_in(const std::string& name, const std::string& path) {
  return {path, true,
          "There is no file \"" + printable(name) + "\"; \"" + printable(last_part(path)) +
              "\" is read instead."};
}

NamedFile look_for(const Finder& finder, const std::string& name, const std::string& place) {
  const std::string turned = with_slashes(name);
  if (const auto path = finder.exact(name)) return {*path, true, {}};
  if (turned != name)
    if (const auto path = finder.exact(turned)) return {*path, true, {}};
  if (const auto path = finder.in_any_case(turned)) return standing_in(name, *path);
  if (const auto path = finder.first_place(turned)) return {*path, false, {}};
  const std::string last = last_part(name);
  if (const auto path = finder.exact(last)) return standing_in(name, *path);
  if (const auto path = finder.in_any_case(last)) return standing_in(name, *path);
  refuse("\"" + printable(name, 200) + "\" does not stay inside the file's folder", place,
         ErrorCode::kUnsupported);
}

}  // namespace

NamedFile find_named(const SceneFile& from, const std::string& name, const std::string& named_in,
                     const std::string& place) {
  NamedFile file = look_for(Finder(from, named_in), name, place);
  if (from.names != nullptr) from.names->insert(file.path);
  return file;
}

std::vector<std::string> names_on(std::string_view line) {
  std::vector<std::string> names;
  for (line = trim(line); !line.empty(); line = trim(line)) {
    if (line.front() == '"') {
      const std::size_t end = std::min(line.find('"', 1), line.size());
      names.emplace_back(line.substr(1, end - 1));
      line.remove_prefix(std::min(end + 1, line.size()));
    } else {
      names.emplace_back(take_word(line));
    }
  }
  return names;
}

std::string unquoted(std::string_view line) {
  line = trim(line);
  const bool is_quoted = line.size() > 1 && line.front() == '"' && line.back() == '"';
  return std::string(is_quoted ? trim(line.substr(1, line.size() - 2)) : line);
}

}  // namespace raysheaf::io
