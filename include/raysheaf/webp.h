// Animated WebP files: films that need no video encoder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

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
