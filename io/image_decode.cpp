// The translation unit of stb_image, as cmake/StbImage.cmake makes it. Formats that scenes do not
// use are left out: what is not there cannot be wrong.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_PIC
#define STBI_NO_PNM
#define STBI_NO_GIF
#define STBI_NO_PSD
#define STBI_FAILURE_USERMSG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "io/image.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

std::optional<ImageSize> image_size(std::span<const std::uint8_t> encoded) {
  int width = 0, height = 0, channels = 0;
  if (encoded.empty() || encoded.size() > std::numeric_limits<int>::max()) return {};
  const int size = static_cast<int>(encoded.size());
  if (stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) == 0) return {};
  if (width <= 0 || height <= 0) return {};
  return ImageSize{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

namespace {

std::uint64_t pixels_of(ImageSize size) {
  return std::uint64_t{size.width} * size.height;
}

constexpr std::array<std::uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::array<std::uint8_t, 2> kJpeg = {0xff, 0xd8};

template <std::size_t kBytes>
bool begins_with(std::span<const std::uint8_t> bytes,
                 const std::array<std::uint8_t, kBytes>& mark) {
  return bytes.size() >= kBytes && std::equal(mark.begin(), mark.end(), bytes.begin());
}

/// stb reads on behind the end, where all is zero: a hundred bytes would be a picture of any size.
std::uint64_t most_pixels(std::span<const std::uint8_t> encoded) {
  const std::uint64_t accounted = begins_with(encoded, kPng) || begins_with(encoded, kJpeg)
                                      ? kFreePixels + kPixelsPerByte * encoded.size()
                                      : kUnpackedPixelsPerByte * encoded.size();
  return std::min(kMaxImagePixels, accounted);
}

/// stb takes a PNG chunk's word for its length and allocates that much.
bool has_chunk_beyond_end(std::span<const std::uint8_t> encoded) {
  if (!begins_with(encoded, kPng)) return false;
  constexpr std::size_t kAround = 12;  // length, kind and checksum
  for (std::size_t at = 8; encoded.size() - at >= kAround;) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | encoded[at + i];
    if (length > encoded.size() - at - kAround) return true;
    at += length + kAround;
  }
  return false;
}

}  // namespace

std::optional<Image> decode_image(std::span<const std::uint8_t> encoded) {
  const auto size = image_size(encoded);
  if (!size || pixels_of(*size) > most_pixels(encoded)) return {};
  if (has_chunk_beyond_end(encoded)) return {};
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(encoded.data(), static_cast<int>(encoded.size()), &width, &height,
                            &channels, STBI_rgb_alpha),
      &stbi_image_free);
  if (!pixels || width <= 0 || height <= 0) return {};
  Image image;
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * image.width * image.height);
  return image;
}

namespace {

void check_total(const std::vector<EncodedImage>& encoded) {
  std::uint64_t pixels = 0, accounted = kFreePixels;
  for (const EncodedImage& image : encoded) {
    const auto size = image_size(image.bytes);
    const std::uint64_t count = size ? pixels_of(*size) : 0;
    pixels += count <= most_pixels(image.bytes) ? count : 0;
    accounted += kPixelsPerByte * image.bytes.size();
    if (pixels > accounted)
      throw Error(ErrorCode::kOutOfMemory, "the images have far more pixels than bytes",
                  image.place);
    if (pixels > kMaxScenePixels) {
      throw Error(ErrorCode::kOutOfMemory, "the images together have more than 2^28 pixels",
                  image.place);
    }
  }
}

}  // namespace

DecodedImages decode_images(const std::vector<EncodedImage>& encoded,
                            std::vector<std::string>& warnings) {
  check_total(encoded);
  std::vector<std::optional<Image>> decoded(encoded.size());
  tbb::parallel_for(std::size_t{0}, encoded.size(),
                    [&](std::size_t i) { decoded[i] = decode_image(encoded[i].bytes); });
  DecodedImages result;
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    if (!decoded[i]) {
      warnings.push_back(encoded[i].place + " is " +
                         (encoded[i].bytes.empty() ? "missing" : "too large or no picture") +
                         "; textures that show it are left out.");
      result.index_of.push_back(kInvalidId);
      continue;
    }
    result.index_of.push_back(static_cast<std::uint32_t>(result.images.size()));
    result.images.push_back(std::move(*decoded[i]));
    result.images.back().name = encoded[i].name;
  }
  return result;
}

}  // namespace raysheaf::io
