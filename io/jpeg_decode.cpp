#include "io/image_formats.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>  // jpeglib.h uses FILE

#include <jpeglib.h>

#include <jerror.h>

#include <new>

#ifndef JCS_ALPHA_EXTENSIONS
#error "libjpeg-turbo is needed: this libjpeg writes no RGBA"
#endif

namespace raysheaf::io {
namespace {

/// libjpeg knows only its first member.
struct JpegErrors {
  jpeg_error_mgr manager{};
  std::jmp_buf jump{};
  bool out_of_memory = false;
};

[[noreturn]] void jpeg_stop(j_common_ptr jpeg) {
  auto& errors = *reinterpret_cast<JpegErrors*>(jpeg->err);
  errors.out_of_memory = errors.manager.msg_code == JERR_OUT_OF_MEMORY;
  std::longjmp(errors.jump, 1);  // NOLINT(cert-err52-cpp): libjpeg has no other way
}

/// Warnings are ignored, unless pixels are missing, which libjpeg would silently fill with grey. A
/// file with one scan may lack its end marker.
void jpeg_tell(j_common_ptr jpeg, int level) {
  if (level >= 0 || jpeg->is_decompressor == FALSE) return;
  const int code = jpeg->err->msg_code;
  const bool lost = code == JWRN_HIT_MARKER || code == JWRN_ARITH_BAD_CODE;
  if (lost || (code == JWRN_JPEG_EOF &&
               jpeg_has_multiple_scans(reinterpret_cast<j_decompress_ptr>(jpeg)) != FALSE))
    jpeg_stop(jpeg);
}

void count_scans(j_common_ptr jpeg) {
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > kMostScans) jpeg_stop(jpeg);
}

/// Owns libjpeg's decoder.
class Decoder {
 public:
  Decoder() {
    jpeg_.err = jpeg_std_error(&errors_.manager);
    errors_.manager.error_exit = jpeg_stop;
    errors_.manager.emit_message = jpeg_tell;
    progress_.progress_monitor = count_scans;
  }
  ~Decoder() { jpeg_destroy_decompress(&jpeg_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// libjpeg's errors jump here and into `read_rows`: nothing in them has a destructor.
  bool read_head(const std::uint8_t* bytes, std::size_t count) {
    if (setjmp(errors_.jump) != 0) return false;  // NOLINT(cert-err52-cpp)
    jpeg_create_decompress(&jpeg_);
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, bytes, count);
    return jpeg_read_header(&jpeg_, TRUE) == JPEG_HEADER_OK;
  }

  bool read_rows(PixelBuffer& pixels) {
    if (setjmp(errors_.jump) != 0) return false;  // NOLINT(cert-err52-cpp)
    const bool has_black = jpeg_.num_components == 4;
    jpeg_.out_color_space = has_black ? JCS_CMYK : JCS_EXT_RGBA;
    if (!jpeg_start_decompress(&jpeg_) || jpeg_.output_components != 4) return false;
    while (jpeg_.output_scanline < jpeg_.output_height) {
      JSAMPROW row = pixels.row(jpeg_.output_scanline);
      if (jpeg_read_scanlines(&jpeg_, &row, 1) != 1) return false;
    }
    return true;
  }

  [[nodiscard]] ImageSize size() const { return {jpeg_.image_width, jpeg_.image_height}; }
  [[nodiscard]] bool is_cmyk() const { return jpeg_.num_components == 4; }
  [[nodiscard]] bool is_adobe() const { return jpeg_.saw_Adobe_marker != FALSE; }
  [[nodiscard]] bool is_out_of_memory() const { return errors_.out_of_memory; }

 private:
  jpeg_decompress_struct jpeg_{};
  jpeg_progress_mgr progress_{};
  JpegErrors errors_;
};

/// Converts in place. Adobe's programs store inverted ink values.
void cmyk_to_rgba(std::span<std::uint8_t> pixels, bool is_adobe) {
  const int flip = is_adobe ? 0 : 255;
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    const int black = pixels[i + 3] ^ flip;
    for (std::size_t c = i; c < i + 3; ++c)
      pixels[c] = static_cast<std::uint8_t>(((pixels[c] ^ flip) * black + 127) / 255);
    pixels[i + 3] = 255;
  }
}

}  // namespace

bool is_jpeg(std::span<const std::uint8_t> encoded) {
  return encoded.size() >= 2 && encoded[0] == 0xff && encoded[1] == 0xd8;
}

std::optional<ImageSize> jpeg_size(std::span<const std::uint8_t> encoded) {
  Decoder decoder;
  const bool read = decoder.read_head(encoded.data(), encoded.size());
  if (decoder.is_out_of_memory()) throw std::bad_alloc();
  const ImageSize size = decoder.size();
  return read && std::min(size.width, size.height) > 0 ? std::optional(size) : std::nullopt;
}

std::optional<Image> decode_jpeg(std::span<const std::uint8_t> encoded, ImageSize size) {
  PixelBuffer pixels(size);
  Decoder decoder;
  const bool read = decoder.read_head(encoded.data(), encoded.size()) && decoder.size() == size &&
                    decoder.read_rows(pixels);
  if (decoder.is_out_of_memory()) throw std::bad_alloc();
  if (!read) return {};
  if (decoder.is_cmyk()) cmyk_to_rgba(pixels.rgba(), decoder.is_adobe());
  return pixels.image();
}

}  // namespace raysheaf::io
