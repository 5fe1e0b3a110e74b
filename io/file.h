// Whole files, read and written. Errors name the file.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/image_cache.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

using Bytes = std::vector<std::uint8_t>;

/// What a loader is told of the file whose bytes it gets.
struct SceneFile {
  std::string path;
  bool allow_external = false;             ///< files that it names may lie outside its folder
  ImageCache* images = nullptr;            ///< of files that share pictures; none: there is but one
  std::set<std::string>* names = nullptr;  ///< gets the paths that `resolve` gives
  std::set<std::string>* turned = nullptr;  ///< gets the URIs whose "\\" it read as "/"
};

/// All bytes of a file, as they stood at one moment: where another file is renamed over it
/// meanwhile, those of the old one. Throws kNotFound where there is none, kIo where it is a folder,
/// cannot be read, or is written to while it is read, kOutOfMemory above `kMaxFileBytes`. What is
/// not noticed: a program that began to write in place before, and is not done.
[[nodiscard]] Bytes read_file(const std::string& path);
inline constexpr std::uint64_t kMaxFileBytes = 0xffffffff;

[[nodiscard]] bool file_exists(const std::string& path);

/// Afterwards the old file stands or the whole new one, as `FileWriter` sees to. Throws kIo.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);
inline std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// "cannot be `verb`: ..." with the system's words for `error`, an errno. kIo.
[[nodiscard]] Error system_error(const std::string& verb, const std::string& place, int error);
/// A name in the same folder that nobody has, so that a rename stays within one file system.
[[nodiscard]] std::string temporary_name(const std::string& path);
/// A new file in the same folder that has no name, and is gone however the program ends; -1 where
/// the system has no such files. `flags`: how it is opened.
[[nodiscard]] int open_without_name(const std::string& beside, int flags);
/// Gives it one that nobody has. False, and errno, where that fails.
[[nodiscard]] bool give_name(int file, const std::string& name);

/// The ending of a name in lower case, without the dot: "glb".
[[nodiscard]] std::string ending_of(const std::string& path);

/// `uri`, which a scene's file names, as a path from where we are. Where it `is_uri`, "%20" is
/// decoded, and it must be relative. Throws kUnsupported where it has a scheme, and, unless
/// external files are allowed, where it is absolute or climbs out by "..". A URI with "\\" that
/// names no file is tried with "/" instead, as paths of Windows are written.
[[nodiscard]] std::string resolve(const SceneFile& from, const std::string& uri, bool is_uri,
                                  const std::string& place);
[[nodiscard]] std::string folder_of(const std::string& path);
/// Its own path and those in its `names`: SceneDescription::files.
[[nodiscard]] std::vector<std::string> files_of(const SceneFile& file);

}  // namespace raysheaf::io
