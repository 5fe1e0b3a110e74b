// Files in and out. Every function throws `Error` whose place is the file, and the field where
// there is one. Files are written beside their name and then renamed: either the old file stands or
// the whole new one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

struct LoadOptions {
  /// The scene may name files outside its folder: by "..", and in OBJ and MTL by absolute names.
  /// Only for scenes that are trusted: whatever they name is read.
  bool allow_external = false;
  /// Of a sequence: read all its frames at once, and keep them. Seeking then reads no file, and
  /// does not see that one has changed.
  bool preload = false;
};

/// Reads glTF 2.0 (.gltf, .glb), OBJ with MTL, PLY (ASCII, binary of either byte order) or STL
/// (ASCII, binary); the ending of the name says which, in any case. The result has passed
/// `validate`. Memory and time are bounded by the sizes of the files: what a file of a kilobyte
/// describes is refused (kOutOfMemory) where it would take gigabytes.
[[nodiscard]] SceneDescription load_scene(const std::string& path, const LoadOptions& options = {});

/// The endings of the files that `load_scene` reads, each with its dot.
[[nodiscard]] std::span<const std::string_view> scene_file_endings();
/// The same for people: ".gltf, .glb, .obj, ...".
[[nodiscard]] std::string scene_file_endings_text();

/// Reads a picture of all directions: Radiance (.hdr) or OpenEXR (.exr, channels R, G, B), by its
/// ending. Refuses pixels that are negative or not finite.
[[nodiscard]] Environment load_environment(const std::string& path);

/// Writes the scene as one binary glTF file that `load_scene` reads back to the same geometry, bit
/// for bit. Images are stored as PNG; an environment is left out.
void save_glb(const SceneDescription& scene, const std::string& path);

/// Writes an eight-bit image as PNG; alpha is left out where it is 255 everywhere.
void write_png(const Image& image, const std::string& path);

/// The same in memory: the bytes of a PNG file. Throws `Error` (kInvalidArgument) where the size
/// and the bytes disagree.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

/// One named channel of an OpenEXR picture: `width * height` floats, rows from the top. Layers are
/// spelt as OpenEXR does: "normal.X", "normal.Y"; the beauty picture is "R", "G", "B".
struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

/// Writes 32-bit float channels as one ZIP-compressed OpenEXR file.
void write_exr(std::uint32_t width, std::uint32_t height, std::vector<ExrChannel> channels,
               const std::string& path);

/// Whose file is replaced where `path` is written to: `path`, or what stands behind the symbolic
/// links there, be it missing. Throws kIo for links in a circle.
[[nodiscard]] std::string where_links_end(const std::string& path);

/// Writes text (JSON statistics) the same careful way.
void write_text(const std::string& text, const std::string& path);

}  // namespace raysheaf
