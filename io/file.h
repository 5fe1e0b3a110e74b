// Reads and writes whole files. Errors name the file.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/folder_names.h"
#include "raysheaf/error.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

using Bytes = std::vector<std::uint8_t>;

/// Images that several files of a sequence refer to, by path; one without pixels could not be
/// decoded.
using ImageCache = std::map<std::string, Image>;

/// The name of a scene file, and the options that its loader needs.
struct SceneFile {
  std::string path;
  bool allow_external = false;  ///< the files that it names may lie outside its folder
  /// Shared by the files of a sequence; null: there is only one file.
  ImageCache* images = nullptr;
  std::set<std::string>* names = nullptr;   ///< receives the paths that `resolve` returns
  std::set<std::string>* turned = nullptr;  ///< receives the URIs in which "\\" was read as "/"
  std::shared_ptr<FolderNames> folders = std::make_shared<FolderNames>();
};

/// All bytes of a file, as of one moment: if another file is renamed over it meanwhile, the bytes
/// of the old one. Throws kNotFound if there is no such file; kIo if it is a folder, cannot be
/// read, or is written to while it is read; kOutOfMemory above `kMaxFileBytes`. It does not detect
/// a program that began to write in place earlier and has not finished.
[[nodiscard]] Bytes read_file(const std::string& path);
inline constexpr std::uint64_t kMaxFileBytes = 0xffffffff;

[[nodiscard]] bool file_exists(const std::string& path);

/// Afterwards the file has either its old contents or all of the new ones (see `FileWriter`).
/// Throws kIo.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);
inline std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// "cannot be `verb`: ..." with the system's message for `error`, an errno. The code is kIo.
[[nodiscard]] Error system_error(const std::string& verb, const std::string& place, int error);
/// An unused name in the same folder, so that a rename stays within one file system.
[[nodiscard]] std::string temporary_name(const std::string& path);
/// The extension of a file name in lower case, without the dot: "glb".
[[nodiscard]] std::string ending_of(const std::string& path);

/// Resolves `uri`, which a scene file names, to a path. If it `is_uri`, "%20" is decoded and it
/// must be relative. Throws kUnsupported if it has a scheme, or, unless external files are allowed,
/// if it is absolute or leaves the folder by "..". A URI with "\\" that names no file is tried with
/// "/" instead: some exporters write Windows paths.
[[nodiscard]] std::string resolve(const SceneFile& from, const std::string& uri, bool is_uri,
                                  const std::string& place);
[[nodiscard]] std::string folder_of(const std::string& path);
/// The name of a file without its folder and its extension.
[[nodiscard]] std::string stem_of(const std::string& path);
/// The file's own path and those in `names`, for SceneDescription::files.
[[nodiscard]] std::vector<std::string> files_of(const SceneFile& file);

}  // namespace raysheaf::io
