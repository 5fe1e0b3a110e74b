// Whole files, read and written. Errors name the file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raysheaf::io {

using Bytes = std::vector<std::uint8_t>;

/// All bytes of a file. Throws kNotFound where there is none, kIo where it is a folder, is larger
/// than `kMaxFileBytes` or cannot be read.
[[nodiscard]] Bytes read_file(const std::string& path);
inline constexpr std::uint64_t kMaxFileBytes = 0xffffffff;

[[nodiscard]] bool file_exists(const std::string& path);

/// Writes beside `path` and renames: afterwards the old file stands or the whole new one. Throws
/// kIo; the temporary file is gone in every case.
void write_file(const std::string& path, std::span<const std::uint8_t> bytes);
inline std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// The ending of a name in lower case, without the dot: "glb".
[[nodiscard]] std::string ending_of(const std::string& path);

/// `uri` as a path below `folder` ("%20" decoded where `percent`). Throws kUnsupported where it has
/// a scheme, is absolute or climbs out by "..".
[[nodiscard]] std::string resolve_inside(const std::string& folder, const std::string& uri,
                                         bool percent, const std::string& place);
[[nodiscard]] std::string folder_of(const std::string& path);

}  // namespace raysheaf::io
