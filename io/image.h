// Decodes 8-bit images: PNG by libpng, JPEG by libjpeg-turbo, WebP by libwebp, EXR by OpenEXR, TGA
// and BMP by stb_image.
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

/// Pixel limits of an image, of all images in a scene, and in proportion to an image's bytes. PNG,
/// JPEG, WebP and EXR: deflate expands a byte to at most 1032 bytes, each of which holds one or
/// several pixels of one channel. Other formats: a run of 128 pixels takes two bytes.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 26;
inline constexpr std::uint64_t kMaxScenePixels = 4 * kMaxImagePixels;
inline constexpr std::uint64_t kFreePixels = std::uint64_t{1} << 24,
                               kPixelsPerByte = std::uint64_t{8} * 1032;
inline constexpr std::uint64_t kUnpackedPixelsPerByte = 64;

/// An image's size, read from its header without decoding it.
struct ImageSize {
  std::uint32_t width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};
[[nodiscard]] std::optional<ImageSize> image_size(std::span<const std::uint8_t> encoded);

/// The output buffer of decoders. Its memory is uninitialised, so that a header that promises more
/// pixels than follow costs little.
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

/// RGBA, or nothing if the bytes are not an image, are cut short, or have too many pixels.
[[nodiscard]] std::optional<Image> decode_image(std::span<const std::uint8_t> encoded);

/// An image as it is encoded in the file.
struct EncodedImage {
  std::string name;   ///< the image's name in the scene
  std::string place;  ///< for warnings: "images[3]"
  Bytes bytes;
  bool is_data = false;  ///< numbers rather than colours: EXR values stay linear
};

/// The decoded images, and the index of each encoded one among them: `kInvalidId` if it is missing
/// or could not be decoded.
struct DecodedImages {
  std::vector<Image> images;
  std::vector<std::uint32_t> index_of;
};

/// Decodes on all cores and keeps the order. An image that cannot be decoded adds a warning, and so
/// does one that exceeds a limit above, or `kMaxScenePixels` with the images before it.
[[nodiscard]] DecodedImages decode_images(const std::vector<EncodedImage>& encoded,
                                          std::vector<std::string>& warnings);

}  // namespace raysheaf::io
