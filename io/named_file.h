// Finds files that a scene file names in the style of another system: material libraries of OBJ,
// and images of MTL and PLY.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/file.h"

namespace raysheaf::io {

struct NamedFile {
  std::string path;  ///< the file's path, or the first path tried if it is missing
  bool is_there = false;
  std::string remark;  ///< a warning if a file with another name replaces it, or empty
};

/// Searches `name` next to the file at `named_in`, then next to the scene's file: unchanged; with
/// "/" instead of "\\"; case-insensitively, if only one file matches; and, for a name outside the
/// scene's folder (a drive, "..", an absolute path), by its last component. Throws kUnsupported if
/// it lies outside and no such file exists.
[[nodiscard]] NamedFile find_named(const SceneFile& from, const std::string& name,
                                   const std::string& named_in, const std::string& place);

/// Splits a line into names; those with blanks may be in double quotes, which are removed.
[[nodiscard]] std::vector<std::string> names_on(std::string_view line);
/// A line with a single name, without double quotes around it.
[[nodiscard]] std::string unquoted(std::string_view line);

}  // namespace raysheaf::io
