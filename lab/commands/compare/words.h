// The words of `bench compare`: kinds of rays, and the changes from frame to frame.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raysheaf::app {

enum class CompareKind : std::uint8_t {
  kShadow,            ///< from the light to the primary hits, any hit
  kMirror,            ///< mirror rays of the primary hits, closest hit
  kSecond,            ///< mirror rays from the hits of kMirror, closest hit
  kAmbientOcclusion,  ///< four per primary hit, any hit
  kRandom,            ///< origins all over the scene's box, uniform directions, closest hit
};

enum class CompareMode : std::uint8_t {
  kRebuild,  ///< new vertices and indices every frame
  kRefit,    ///< new vertices, the same indices
  kStatic,   ///< nothing changes: only rays are timed
};

[[nodiscard]] std::vector<CompareKind> all_compare_kinds();
[[nodiscard]] std::vector<CompareMode> all_compare_modes();

/// "shadow", "mirror", "second", "ao", "random".
[[nodiscard]] const char* to_string(CompareKind kind);
/// "rebuild", "refit", "static".
[[nodiscard]] const char* to_string(CompareMode mode);

/// Throw `Error` (kInvalidArgument), which lists the valid words.
[[nodiscard]] CompareKind compare_kind_from_string(const std::string& name);
[[nodiscard]] CompareMode compare_mode_from_string(const std::string& name);

/// Whether the query is for any hit.
[[nodiscard]] bool asks_for_any_hit(CompareKind kind);

}  // namespace raysheaf::app
