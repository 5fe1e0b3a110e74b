#include "io/image_formats.h"

#ifdef RAYSHEAF_HAS_WEBP
#include <webp/decode.h>

#include <cstring>
#include <new>
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
  WebPDecoderConfig config;
  // The library's version does not match the header.
  if (WebPInitDecoderConfig(&config) == 0) return {};
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {rgba.data(), static_cast<int>(4 * size.width), rgba.size()};
  const VP8StatusCode status = WebPDecode(encoded.data(), encoded.size(), &config);
  if (status == VP8_STATUS_OUT_OF_MEMORY) throw std::bad_alloc();
  if (status != VP8_STATUS_OK) return {};
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
