// The translation unit of stb_image_write. If available, libdeflate compresses the filtered rows:
// it is several times as fast as stb's own compressor and makes smaller files.
#include <cstdlib>

#if RAYSHEAF_HAS_DEFLATE
#include <libdeflate.h>

namespace {

constexpr int kDeflateLevel = 4;

/// stb's interface for compressors: null if out of memory; stb frees the result.
unsigned char* zlib_compressed(unsigned char* data, int size, int* compressed_size,
                               int /*quality*/) {
  libdeflate_compressor* const compressor = libdeflate_alloc_compressor(kDeflateLevel);
  if (compressor == nullptr) return nullptr;
  const auto bytes = static_cast<std::size_t>(size);
  const std::size_t most = libdeflate_zlib_compress_bound(compressor, bytes);
  auto* const out = static_cast<unsigned char*>(std::malloc(most));
  if (out != nullptr)
    *compressed_size =
        static_cast<int>(libdeflate_zlib_compress(compressor, data, bytes, out, most));
  libdeflate_free_compressor(compressor);
  return out;
}

unsigned int crc32_of(unsigned char* data, int size) {
  return libdeflate_crc32(0, data, static_cast<std::size_t>(size));
}

}  // namespace

#define STBIW_ZLIB_COMPRESS zlib_compressed
#define STBIW_CRC32 crc32_of
#endif
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include "io/file.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf {
namespace {

using io::Bytes;

bool is_opaque(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    if (image.rgba[i] != 255) return false;
  }
  return true;
}

Bytes without_alpha(const Image& image) {
  Bytes rgb(image.rgba.size() / 4 * 3);
  for (std::size_t i = 0, o = 0; o < rgb.size(); i += 4) {
    rgb[o++] = image.rgba[i];
    rgb[o++] = image.rgba[i + 1];
    rgb[o++] = image.rgba[i + 2];
  }
  return rgb;
}

void append(void* context, void* data, int size) {
  auto& bytes = *static_cast<Bytes*>(context);
  const auto* first = static_cast<const std::uint8_t*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

}  // namespace

namespace {

void check_image(const Image& image) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (pixels == 0 || image.rgba.size() != 4 * pixels) {
    throw Error(ErrorCode::kInvalidArgument,
                "an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                    " pixels cannot have " + std::to_string(image.rgba.size()) + " bytes",
                "image \"" + image.name + "\"");
  }
}

/// Calls `encode(image)` and adds the file's name to its errors.
template <class Encode>
Bytes encoded_for(const std::string& path, const Image& image, const Encode& encode) {
  try {
    return encode(image);
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), path);
  }
}

Bytes encode_jpeg(const Image& image) {
  constexpr int kQuality = 92, kMostSide = 65535;
  check_image(image);
  if (image.width > kMostSide || image.height > kMostSide) {
    throw Error(ErrorCode::kUnsupported, "a JPEG has at most 65535 pixels a side",
                "image \"" + image.name + "\"");
  }
  const Bytes rgb = without_alpha(image);
  Bytes jpeg;
  if (stbi_write_jpg_to_func(append, &jpeg, static_cast<int>(image.width),
                             static_cast<int>(image.height), 3, rgb.data(), kQuality) == 0) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory to compress the image");
  }
  return jpeg;
}

}  // namespace

Bytes encode_png(const Image& image) {
  check_image(image);
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  // stb counts bytes in an int.
  if (pixels * 4 + image.height > 0x7fffffff) {
    throw Error(ErrorCode::kUnsupported, "a PNG of more than 2^29 pixels is not written",
                "image \"" + image.name + "\"");
  }
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const bool opaque = is_opaque(image);
  const int channels = opaque ? 3 : 4;
  const Bytes rgb = opaque ? without_alpha(image) : Bytes{};
  const std::uint8_t* data = opaque ? rgb.data() : image.rgba.data();
  Bytes png;
  if (stbi_write_png_to_func(append, &png, width, height, channels, data, width * channels) == 0) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory to compress the image");
  }
  return png;
}

void write_png(const Image& image, const std::string& path) {
  io::write_file(path, encoded_for(path, image, encode_png));
}

void write_jpeg(const Image& image, const std::string& path) {
  io::write_file(path, encoded_for(path, image, encode_jpeg));
}

}  // namespace raysheaf
