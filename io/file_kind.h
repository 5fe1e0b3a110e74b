// What a file is that raysheaf does not read, or not under its name: for messages.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysheaf::io {

struct FileKind {
  const char* name;           ///< with an article: "an FBX file"
  const char* advice;         ///< what to do with it; empty where nothing helps
  bool is_container = false;  ///< what its ending says is more exact
};

/// So many of a file's first bytes are looked at.
inline constexpr std::size_t kKindBytes = 512;

/// By the first bytes of a file, or null. Not text whose first word is none of a format's.
[[nodiscard]] const FileKind* kind_by_content(std::span<const std::uint8_t> head);
/// By the ending of its name, in lower case, or null. Not of kinds that are read.
[[nodiscard]] const FileKind* kind_by_ending(const std::string& ending);
/// By both.
[[nodiscard]] const FileKind* kind_of(std::span<const std::uint8_t> head,
                                      const std::string& ending);

/// "an FBX file; convert it to glTF, for instance with Blender or assimp".
[[nodiscard]] std::string described(const FileKind& kind);

}  // namespace raysheaf::io
