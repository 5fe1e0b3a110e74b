#include "io/webp_decode.h"

#ifdef RAYSHEAF_HAS_WEBP
#include <webp/decode.h>

#include <cstring>
#endif

namespace raysheaf::io {

#ifdef RAYSHEAF_HAS_WEBP
bool reads_webp() {
  return true;
}

bool is_webp(std::span<const std::uint8_t> encoded) {
  return encoded.size() >= 12 && std::memcmp(encoded.data(), "RIFF", 4) == 0 &&
         std::memcmp(encoded.data() + 8, "WEBP", 4) == 0;
}

std::optional<ImageSize> webp_size(std::span<const std::uint8_t> encoded) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK) return {};
  if (features.has_animation != 0 || features.width <= 0 || features.height <= 0) return {};
  return ImageSize{static_cast<std::uint32_t>(features.width),
                   static_cast<std::uint32_t>(features.height)};
}

std::optional<Image> decode_webp(std::span<const std::uint8_t> encoded, ImageSize size) {
  PixelBuffer pixels(size);
  const std::span<std::uint8_t> rgba = pixels.rgba();
  const int stride = static_cast<int>(4 * size.width);  // of 16 383 pixels at most
  if (WebPDecodeRGBAInto(encoded.data(), encoded.size(), rgba.data(), rgba.size(), stride) ==
      nullptr)
    return {};
  return pixels.image();
}
#else
bool reads_webp() {
  return false;
}

bool is_webp(std::span<const std::uint8_t>) {
  return false;
}

std::optional<ImageSize> webp_size(std::span<const std::uint8_t>) {
  return {};
}

std::optional<Image> decode_webp(std::span<const std::uint8_t>, ImageSize) {
  return {};
}
#endif

}  // namespace raysheaf::io
