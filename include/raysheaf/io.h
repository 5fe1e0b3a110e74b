// Reading and writing files. Every function throws `Error` whose place is the file, followed by the
// field if there is one. A file is written under a temporary name in the same folder and then
// renamed, so that either the old or the complete new file exists.
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
  /// Allow references to files outside the scene's folder: by "..", and in OBJ and MTL by absolute
  /// names. Use it only for trusted scenes, because any file that they name is read.
  bool allow_external = false;
  /// For a sequence: read all frames at once and keep them in memory. Then seeking reads no files
  /// and does not notice changed ones.
  bool preload = false;
};

/// Reads glTF 2.0 (.gltf, .glb), OBJ with MTL, PLY (ASCII, binary of either byte order) or STL
/// (ASCII, binary), chosen by the file name's extension, which may be upper or lower case. The
/// result has passed `validate`. Memory and time are bounded by the sizes of the files: a file of a
/// kilobyte that describes gigabytes is refused (kOutOfMemory).
[[nodiscard]] SceneDescription load_scene(const std::string& path, const LoadOptions& options = {});

/// The file extensions that `load_scene` reads, each with its dot.
[[nodiscard]] std::span<const std::string_view> scene_file_endings();
/// The same for people: ".gltf, .glb, .obj, ...".
[[nodiscard]] std::string scene_file_endings_text();

/// Reads an environment map: Radiance (.hdr) or OpenEXR (.exr, channels R, G, B), chosen by the
/// extension. Negative values become 0, and infinite ones large, with a warning.
[[nodiscard]] Environment load_environment(const std::string& path);

/// Writes the scene as one binary glTF file that `load_scene` reads back to the same geometry, bit
/// for bit. Stores images as PNG; omits an environment.
void save_glb(const SceneDescription& scene, const std::string& path);

/// Writes an eight-bit image as PNG; omits alpha if it is 255 everywhere.
void write_png(const Image& image, const std::string& path);

/// Returns the bytes of a PNG file. Throws `Error` (kInvalidArgument) if the size and the number of
/// bytes disagree.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

/// One named channel of an OpenEXR image: `width * height` floats, rows from the top. Layers are
/// spelt as in OpenEXR: "normal.X", "normal.Y"; the beauty image is "R", "G", "B".
struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

/// Writes 32-bit float channels as one ZIP-compressed OpenEXR file.
void write_exr(std::uint32_t width, std::uint32_t height, std::vector<ExrChannel> channels,
               const std::string& path);

/// The file that writing to `path` replaces: `path` itself, or the target of the symbolic links
/// there, even if it does not exist. Throws `Error` (kIo) for circular links.
[[nodiscard]] std::string where_links_end(const std::string& path);

/// Writes text (JSON statistics) in the same way: a temporary file that is renamed.
void write_text(const std::string& text, const std::string& path);

/// Writes an eight-bit image as JPEG of quality 92, to a temporary file that is then renamed; omits
/// alpha.
void write_jpeg(const Image& image, const std::string& path);

/// An animation that repeats for ever, kept in memory until it is written: a few hundred kilobytes
/// for each frame of a million pixels.
class AnimatedWebp {
 public:
  /// All frames have this size in pixels, at most 16383 a side; `fps` above 0. Throws `Error`:
  /// kUnsupported if this build has no libwebp or for larger sides, kInvalidArgument for 0.
  AnimatedWebp(std::uint32_t width, std::uint32_t height, double fps);

  /// Appends a frame, compressed with quality 90; its alpha is kept. Throws `Error`:
  /// kInvalidArgument for another size, kOutOfMemory, kUnsupported if the file would be larger than
  /// WebP allows, 4 GiB.
  void add(const Image& frame);

  /// Writes all frames to a temporary file that is then renamed. Throws `Error`: kIo,
  /// kInvalidArgument without a frame.
  void write(const std::string& path) const;

 private:
  std::uint32_t width_, height_;
  double fps_;
  std::uint64_t count_ = 0;
  bool has_alpha_ = false;
  std::vector<std::uint8_t> frames_;  ///< their chunks
};

}  // namespace raysheaf
