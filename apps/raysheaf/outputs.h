// Files that a command will write: known to be writable before the work starts.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "raysheaf/render.h"
#include "raysheaf/studio.h"

namespace raysheaf::app {

/// Where writing to `path` ends: symbolic links followed, so that replacing the file keeps the
/// link. Throws `Error` (kIo, place `path`) where a file could not be made or replaced there, or
/// where something other than a plain file stands. Nothing is left behind.
[[nodiscard]] std::string writable_path(const std::string& path);

/// The files that a run writes: none of them twice, and none that it reads. Names are compared by
/// the files that they lead to; an empty one is none. Whatever collides throws `Error`
/// (kInvalidArgument), whose place is the output's name, whichever of the two is told first.
class OutputFiles {
 public:
  void reads(const std::string& path);
  /// Before anything is claimed.
  void reads_scene(const std::string& scene);
  /// What a scene that was loaded is made of: `SceneDescription::files`.
  void reads(const std::vector<std::string>& files);
  void claim(const std::string& path);
  /// Claims it, and gives its `writable_path`.
  [[nodiscard]] std::string open(const std::string& path);

 private:
  [[nodiscard]] std::string file_of(const std::string& path);
  [[nodiscard]] std::string file_that_is_read(const std::string& path);

  std::string scene_;  ///< its file
  std::set<std::string> read_;
  std::map<std::string, std::string> written_;  ///< the outputs' names, by their files
  std::map<std::string, std::string> folders_;
};

/// sRGB and alpha.
using Rgba = std::array<std::uint8_t, 4>;

/// The picture for people.
[[nodiscard]] Image shown_picture(const RenderResult& result,
                                  const std::optional<Backdrop>& backdrop);

/// The name of the picture on standard output.
inline constexpr const char* kStandardOutput = "-";

/// PNG and JPEG (tone-mapped) or OpenEXR (linear, with layers, without the backdrop), by the ending
/// of `name`; PNG to standard output.
void write_picture(const RenderResult& result, const std::string& name, const std::string& path,
                   const std::optional<Backdrop>& backdrop);

}  // namespace raysheaf::app
