// Files that a command will write: known to be writable before the work starts.
#pragma once

#include <map>
#include <set>
#include <string>

#include "raysheaf/render.h"

namespace raysheaf::app {

/// Where writing to `path` ends: symbolic links followed, so that replacing the file keeps the
/// link. Throws `Error` (kIo, place `path`) where a file could not be made or replaced there, or
/// where something other than a plain file stands. Nothing is left behind.
[[nodiscard]] std::string writable_path(const std::string& path);

/// The files that a run writes: none of them twice, and none that it reads. Names are compared by
/// the files that they lead to.
class OutputFiles {
 public:
  /// An empty name is none.
  void reads(const std::string& path);
  /// SCENE, and the files that its own names.
  void reads_scene(const std::string& scene);
  /// Throws `Error` (kInvalidArgument, place `path`) for a file that was claimed before, or is
  /// read. An empty name is none.
  void claim(const std::string& path);
  /// Claims it, and gives its `writable_path`.
  [[nodiscard]] std::string open(const std::string& path);

 private:
  [[nodiscard]] std::string file_of(const std::string& path);
  void read_what_scene_names();

  std::string scene_;         ///< its file
  std::string still_closed_;  ///< SCENE, until what it names is looked for
  std::set<std::string> read_, written_;
  std::map<std::string, std::string> folders_;
};

/// PNG (tone-mapped) or OpenEXR (linear, with layers), by the ending of `name`.
void write_picture(const RenderResult& result, const std::string& name, const std::string& path);

}  // namespace raysheaf::app
