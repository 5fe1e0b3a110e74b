// Files that a scene's file names in the words of another system: OBJ's material libraries, and the
// images of MTL and PLY.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/file.h"

namespace raysheaf::io {

struct NamedFile {
  std::string path;  ///< where it is, or, where it is missing, where it would be
  bool is_there = false;
  std::string remark;  ///< a sentence where a file of another name stands in for it, or empty
};

/// Looks for `name` beside the file at `named_in`, then beside the scene's file: as it is; with "/"
/// for "\\"; in letters of another case, where a single file has such a name; and, of a name that
/// leads out of the scene's folder (a drive, "..", an absolute path), only its last part. Throws
/// kUnsupported where it leads out and no such file exists.
[[nodiscard]] NamedFile find_named(const SceneFile& from, const std::string& name,
                                   const std::string& named_in, const std::string& place);

/// The names on a line, where those with blanks may stand in double quotes, without these.
[[nodiscard]] std::vector<std::string> names_on(std::string_view line);
/// A line that is one name, without double quotes round it.
[[nodiscard]] std::string unquoted(std::string_view line);

}  // namespace raysheaf::io
