// Eight-bit pictures, in memory: PNG by libpng, JPEG by libjpeg-turbo, WebP by libwebp, EXR by
// tinyexr, TGA and BMP by stb_image.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/file.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// A picture may have this many pixels, and all pictures of a scene together four times as many;
/// and no more than their bytes account for: in PNG and JPEG (and, as if, in WebP), deflate packs
/// at most 1032 of them into one, of which a pixel of one channel needs one or less; in all else a
/// run of 128 takes two.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 26;
inline constexpr std::uint64_t kMaxScenePixels = 4 * kMaxImagePixels;
inline constexpr std::uint64_t kFreePixels = std::uint64_t{1} << 24, kPixelsPerByte = 4096;
inline constexpr std::uint64_t kUnpackedPixelsPerByte = 64;

/// What the head of a picture says, without decoding it.
struct ImageSize {
  std::uint32_t width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};
[[nodiscard]] std::optional<ImageSize> image_size(std::span<const std::uint8_t> encoded);

/// What a picture is decoded into: not written before it is, so that a head which promises more
/// than follows costs little.
class PixelBuffer {
 public:
  explicit PixelBuffer(ImageSize size)
      : size_(size), rgba_(std::make_unique_for_overwrite<std::uint8_t[]>(bytes())) {}
  [[nodiscard]] std::uint8_t* row(std::size_t y) { return rgba_.get() + 4 * y * size_.width; }
  [[nodiscard]] std::span<std::uint8_t> rgba() { return {rgba_.get(), bytes()}; }
  [[nodiscard]] Image image() const {
    return {{}, size_.width, size_.height, {rgba_.get(), rgba_.get() + bytes()}};
  }

 private:
  [[nodiscard]] std::size_t bytes() const { return std::size_t{4} * size_.width * size_.height; }

  ImageSize size_;
  std::unique_ptr<std::uint8_t[]> rgba_;
};

/// RGBA, or nothing where the bytes are no picture, were cut short, or have too many pixels.
[[nodiscard]] std::optional<Image> decode_image(std::span<const std::uint8_t> encoded);

/// A picture that is still as it was in the file.
struct EncodedImage {
  std::string name;   ///< the name that the scene shall see
  std::string place;  ///< for the warning: "images[3]"
  Bytes bytes;
  bool is_data = false;  ///< of numbers rather than colours: EXR's stay linear
};

/// The pictures that could be decoded, and where each of the encoded ones went: `kInvalidId` where
/// it is missing or no picture.
struct DecodedImages {
  std::vector<Image> images;
  std::vector<std::uint32_t> index_of;
};

/// Decodes on all cores; the order is kept. An image that cannot be decoded adds a warning. Throws
/// kOutOfMemory beyond `kMaxScenePixels`, and beyond `kFreePixels` and `kPixelsPerByte` of each
/// byte.
[[nodiscard]] DecodedImages decode_images(const std::vector<EncodedImage>& encoded,
                                          std::vector<std::string>& warnings);

}  // namespace raysheaf::io
