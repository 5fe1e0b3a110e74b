// Recognises file formats that raysheaf does not read, or that have a wrong extension, for error
// messages.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysheaf::io {

struct FileKind {
  const char* name;           ///< with an article: "an FBX file"
  const char* advice;         ///< how to convert it; empty if there is no advice
  bool is_container = false;  ///< the extension names the format more exactly
};

/// How many of a file's first bytes are examined.
inline constexpr std::size_t kKindBytes = 512;

/// Recognises the kind by a file's first bytes; null if unknown. Text is recognised only by a first
/// word that belongs to a format.
[[nodiscard]] const FileKind* kind_by_content(std::span<const std::uint8_t> head);
/// Recognises the kind by the file name's extension in lower case; null if unknown, and for the
/// formats that raysheaf reads.
[[nodiscard]] const FileKind* kind_by_ending(const std::string& ending);
/// Uses the contents and the extension.
[[nodiscard]] const FileKind* kind_of(std::span<const std::uint8_t> head,
                                      const std::string& ending);

/// For example "an FBX file; convert it to glTF, for instance with Blender or assimp".
[[nodiscard]] std::string described(const FileKind& kind);

}  // namespace raysheaf::io
