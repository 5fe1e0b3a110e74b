#include "io/image_formats.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

namespace raysheaf::io {
namespace {

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
/// The first chunk: length, type, width, height.
constexpr std::array<std::uint8_t, 8> kPngHead = {0, 0, 0, 13, 'I', 'H', 'D', 'R'};
constexpr std::size_t kWidthAt = 16, kHeightAt = 20, kPngHeadBytes = 33;

std::uint32_t big_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
         std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

/// The state that libpng's callbacks use.
struct PngSource {
  std::span<const std::uint8_t> rest;
  bool out_of_memory = false;
};

[[noreturn]] void png_stop(png_structp png, png_const_charp /*message*/) {
  png_longjmp(png, 1);
}

void png_ignore(png_structp /*png*/, png_const_charp /*message*/) {}

png_voidp png_take(png_structp png, png_alloc_size_t bytes) {
  void* const memory = ::operator new(bytes, std::nothrow);
  if (memory == nullptr) static_cast<PngSource*>(png_get_mem_ptr(png))->out_of_memory = true;
  return memory;
}

void png_give_back(png_structp /*png*/, png_voidp memory) {
  ::operator delete(memory);
}

void png_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto& source = *static_cast<PngSource*>(png_get_io_ptr(png));
  if (count > source.rest.size()) png_error(png, "the file ends");
  std::memcpy(out, source.rest.data(), count);
  source.rest = source.rest.subspan(count);
}

/// libpng's errors jump here: nothing in this function has a destructor.
bool read_png_rows(png_structp png, png_infop info, ImageSize size, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp): its only way
  png_set_user_limits(png, size.width, size.height);
  // In addition to pixels, only palettes and transparent colours are read. Profiles and texts,
  // which may be compressed, are skipped.
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, info);
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != std::size_t{4} * size.width) return false;
  png_read_image(png, rows);
  return true;
}

}  // namespace

bool is_png(std::span<const std::uint8_t> encoded) {
  return encoded.size() >= kPngSignature.size() &&
         std::equal(kPngSignature.begin(), kPngSignature.end(), encoded.begin());
}

std::optional<ImageSize> png_size(std::span<const std::uint8_t> encoded) {
  if (!is_png(encoded) || encoded.size() < kPngHeadBytes) return {};
  if (!std::equal(kPngHead.begin(), kPngHead.end(), encoded.begin() + kPngSignature.size()))
    return {};
  const ImageSize size{big_endian(encoded, kWidthAt), big_endian(encoded, kHeightAt)};
  const bool good =
      std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= PNG_UINT_31_MAX;
  return good ? std::optional(size) : std::nullopt;
}

std::optional<Image> decode_png(std::span<const std::uint8_t> encoded, ImageSize size) {
  PixelBuffer pixels(size);
  std::vector<png_bytep> rows(size.height);
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = pixels.row(y);

  PngSource source{encoded};
  png_structp png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, nullptr, png_stop, png_ignore,
                                             &source, png_take, png_give_back);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  bool read = false;
  if (info != nullptr) {
    png_set_read_fn(png, &source, png_bytes);
    read = read_png_rows(png, info, size, rows.data());
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (source.out_of_memory) throw std::bad_alloc();
  if (!read) return {};
  return pixels.image();
}

}  // namespace raysheaf::io
