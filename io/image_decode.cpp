// The translation unit of stb_image, which cmake/StbImage.cmake reduces to TGA and BMP.
#include <cstdlib>

namespace {

/// Zeroes memory, so that a truncated file decodes to the same pixels each time.
void* zeroed(std::size_t bytes) {
  return std::calloc(1, bytes);
}

}  // namespace

#define STBI_MALLOC zeroed
#define STBI_REALLOC std::realloc
#define STBI_FREE std::free
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_FAILURE_USERMSG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "io/exr_decode.h"
#include "io/file_kind.h"
#include "io/image.h"
#include "io/image_formats.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

namespace {

/// The most bytes that stb reads at once: a row, or a palette.
std::size_t most_at_once(ImageSize size) {
  return std::max<std::size_t>(std::size_t{4} * size.width, std::size_t{4} << 16);
}

std::optional<ImageSize> unpacked_size(std::span<const std::uint8_t> encoded) {
  int width = 0, height = 0, channels = 0;
  if (encoded.empty() || encoded.size() > std::numeric_limits<int>::max()) return {};
  const int size = static_cast<int>(encoded.size());
  if (stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) == 0) return {};
  // A negative height means that a BMP's rows are stored from top to bottom.
  if (width <= 0 || height == 0 || height == std::numeric_limits<int>::min()) return {};
  return ImageSize{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(std::abs(height))};
}

using UnpackedPixels = std::unique_ptr<stbi_uc, decltype(&stbi_image_free)>;

/// RGBA, or null.
UnpackedPixels unpacked_pixels(std::span<const std::uint8_t> encoded, ImageSize size) {
  int width = 0, height = 0, channels = 0;
  UnpackedPixels pixels(stbi_load_from_memory(encoded.data(), static_cast<int>(encoded.size()),
                                              &width, &height, &channels, STBI_rgb_alpha),
                        &stbi_image_free);
  const ImageSize decoded{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  if (decoded != size) pixels.reset();
  return pixels;
}

/// stb replaces missing bytes by zeros. An image is truncated if other bytes after its end change
/// its pixels. (255 and 1 are both tried: in palette images, one may happen to give the same
/// pixels, and 255 may be no entry.)
std::optional<Image> decode_unpacked(std::span<const std::uint8_t> encoded, ImageSize size) {
  const std::size_t more = most_at_once(size);
  if (encoded.size() + more > std::numeric_limits<int>::max()) return {};
  const UnpackedPixels pixels = unpacked_pixels(encoded, size);
  if (!pixels) return {};
  const std::size_t bytes = std::size_t{4} * size.width * size.height;
  Bytes longer(encoded.begin(), encoded.end());
  for (const std::uint8_t behind : {std::uint8_t{255}, std::uint8_t{1}}) {
    longer.resize(encoded.size());
    longer.resize(encoded.size() + more, behind);
    const UnpackedPixels others = unpacked_pixels(longer, size);
    if (!others || std::memcmp(pixels.get(), others.get(), bytes) != 0) return {};
  }
  return Image{{}, size.width, size.height, {pixels.get(), pixels.get() + bytes}};
}

std::uint64_t pixels_of(ImageSize size) {
  return std::uint64_t{size.width} * size.height;
}

/// stb reads zeros after the end of the file: without this limit, a hundred bytes could be an image
/// of any size.
std::uint64_t most_pixels(std::span<const std::uint8_t> encoded) {
  const bool packed = is_png(encoded) || is_jpeg(encoded) || is_webp(encoded) || is_exr(encoded);
  const std::uint64_t accounted = packed ? kFreePixels + kPixelsPerByte * encoded.size()
                                         : kUnpackedPixelsPerByte * encoded.size();
  return std::min(kMaxImagePixels, accounted);
}

}  // namespace

std::optional<ImageSize> image_size(std::span<const std::uint8_t> encoded) {
  if (is_png(encoded)) return png_size(encoded);
  if (is_jpeg(encoded)) return jpeg_size(encoded);
  if (is_webp(encoded)) return webp_size(encoded);
  if (is_exr(encoded)) return exr_size(encoded);
  return unpacked_size(encoded);
}

std::optional<Image> decode_image(std::span<const std::uint8_t> encoded) {
  const auto size = image_size(encoded);
  if (!size || pixels_of(*size) > most_pixels(encoded)) return {};
  if (is_png(encoded)) return decode_png(encoded, *size);
  if (is_jpeg(encoded)) return decode_jpeg(encoded, *size);
  if (is_webp(encoded)) return decode_webp(encoded, *size);
  if (is_exr(encoded)) {
    try {
      return decode_exr_image(encoded, false).image;
    } catch (const Error&) {
      return {};
    }
  }
  return decode_unpacked(encoded, *size);
}

namespace {

/// An image, an error and a remark; each may be missing.
struct Decoded {
  std::optional<Image> image;
  std::string fault, remark;
};

/// Why the bytes are not one of the supported images.
std::string fault_of(std::span<const std::uint8_t> encoded) {
  if (encoded.empty()) return "is missing";
  const bool is_read = is_png(encoded) || is_jpeg(encoded) || is_webp(encoded) || is_exr(encoded);
  const FileKind* kind = is_read || unpacked_size(encoded) ? nullptr : kind_by_content(encoded);
  if (kind == nullptr) return "is truncated or not an image";
  return std::string("is ") + kind->name +
         "; PNG, JPEG, WebP and EXR are read, and TGA and BMP, too";
}

Decoded decode_one(const EncodedImage& encoded) {
  Decoded result;
  if (is_exr(encoded.bytes)) {
    try {
      ExrImage exr = decode_exr_image(encoded.bytes, encoded.is_data);
      result.image = std::move(exr.image);
      result.remark = exr.remark;
      if (exr.exceeds_one) result.remark = "has numbers above 1; in a texture, they become 1.";
    } catch (const Error& error) {
      result.fault = error.sentence();
      if (result.fault.ends_with('.')) result.fault.pop_back();
    }
  } else {
    result.image = decode_image(encoded.bytes);
    if (!result.image) result.fault = fault_of(encoded.bytes);
  }
  return result;
}

/// Decides which images fit into the limits, in their order.
class PixelBudget {
 public:
  /// Why the image must be left out; empty if it fits.
  std::string take(std::span<const std::uint8_t> encoded) {
    accounted_ += kPixelsPerByte * encoded.size();
    const auto size = image_size(encoded);
    if (!size) return {};
    const std::uint64_t pixels = pixels_of(*size);
    const std::string has =
        "has " + std::to_string(size->width) + "x" + std::to_string(size->height) + " pixels";
    if (pixels > kMaxImagePixels) return has + ", more than 2^26, the limit of an image";
    if (pixels > most_pixels(encoded) || pixels > accounted_ - pixels_)
      return has + ", far more than " + std::to_string(encoded.size()) + " bytes can hold";
    if (pixels > kMaxScenePixels - pixels_)
      return has + ", with which the images together exceed the limit of 2^28";
    pixels_ += pixels;
    return {};
  }

 private:
  std::uint64_t pixels_ = 0, accounted_ = kFreePixels;
};

}  // namespace

DecodedImages decode_images(const std::vector<EncodedImage>& encoded,
                            std::vector<std::string>& warnings) {
  std::vector<Decoded> decoded(encoded.size());
  PixelBudget budget;
  for (std::size_t i = 0; i < encoded.size(); ++i) decoded[i].fault = budget.take(encoded[i].bytes);
  tbb::parallel_for(std::size_t{0}, encoded.size(), [&](std::size_t i) {
    if (decoded[i].fault.empty()) decoded[i] = decode_one(encoded[i]);
  });
  DecodedImages result;
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    if (!decoded[i].remark.empty()) warnings.push_back(encoded[i].place + " " + decoded[i].remark);
    if (!decoded[i].image) {
      warnings.push_back(encoded[i].place + " " + decoded[i].fault +
                         "; textures that show it are left out.");
      result.index_of.push_back(kInvalidId);
      continue;
    }
    result.index_of.push_back(static_cast<std::uint32_t>(result.images.size()));
    result.images.push_back(std::move(*decoded[i].image));
    result.images.back().name = encoded[i].name;
  }
  return result;
}

}  // namespace raysheaf::io
