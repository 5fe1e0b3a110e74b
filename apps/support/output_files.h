// The files that a command will write, checked for being writable before the work starts.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace raysheaf::app {

/// The file that writing to `path` replaces: symbolic links are followed, so that the link is kept.
/// Throws `Error` (kIo, place `path`) if no file can be made or replaced there, or if `path` is not
/// a plain file. Leaves no files behind.
[[nodiscard]] std::string writable_path(const std::string& path);

/// The files that a run writes. It refuses to write a file twice, or one that the run reads. Names
/// are compared by the files that they lead to; empty names are ignored. A collision throws `Error`
/// (kInvalidArgument), whose place is the name of the output, in whichever order the two were
/// added.
class OutputFiles {
 public:
  void reads(const std::string& path);
  /// Adds a file that the run reads. Call it before anything is claimed.
  void reads_scene(const std::string& scene);
  /// Adds the files of a loaded scene: `SceneDescription::files`.
  void reads(const std::vector<std::string>& files);
  void claim(const std::string& path);
  /// Claims the file and returns its `writable_path`.
  [[nodiscard]] std::string open(const std::string& path);

 private:
  [[nodiscard]] std::string file_of(const std::string& path);
  [[nodiscard]] std::string file_that_is_read(const std::string& path);

  std::string scene_;  ///< its file
  std::set<std::string> read_;
  std::map<std::string, std::string> written_;  ///< names of the outputs, by their files
  std::map<std::string, std::string> folders_;
};

}  // namespace raysheaf::app
