// Images as libpng and libjpeg write them, in every format, complete and truncated.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include <jpeglib.h>

#include "io/image.h"
#include "io/image_formats.h"
#include "support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;
using ImageBytes = std::vector<std::uint8_t>;

/// A component of a pixel with the image's bit depth, as a test pattern.
std::uint32_t sample(std::uint32_t x, std::uint32_t y, std::uint32_t component) {
  return x * 29 + y * 53 + component * 71 + x * y;
}

struct PngKind {
  int colour = 0, bits = 0, interlace = 0;
  bool has_transparent_colour = false;
};

constexpr std::uint32_t kWide = 21, kHigh = 13;

std::uint32_t stored(const PngKind& kind, std::uint32_t x, std::uint32_t y, std::uint32_t c) {
  const std::uint32_t spread = kind.bits == 16 ? 257 * 3 : 1;
  return sample(x, y, c) * spread & ((1u << kind.bits) - 1);
}

png_color palette_colour(std::uint32_t i) {
  return {static_cast<png_byte>(i * 3), static_cast<png_byte>(255 - i),
          static_cast<png_byte>(i * i)};
}

ImageBytes png_of(const PngKind& kind) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  ImageBytes out;
  png_set_write_fn(
      png, &out,
      [](png_structp from, png_bytep data, std::size_t count) {
        auto* to = static_cast<ImageBytes*>(png_get_io_ptr(from));
        to->insert(to->end(), data, data + count);
      },
      nullptr);
  png_set_IHDR(png, info, kWide, kHigh, kind.bits, kind.colour, kind.interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const std::uint32_t colours = 1u << std::min(kind.bits, 8);
  std::vector<png_color> palette;
  ImageBytes opacity;
  for (std::uint32_t i = 0; i < colours; ++i) {
    palette.push_back(palette_colour(i));
    opacity.push_back(static_cast<png_byte>(i * 7));
  }
  if (kind.colour == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette.data(), static_cast<int>(colours));
  png_color_16 transparent{};
  transparent.gray = static_cast<png_uint_16>(stored(kind, 2, 2, 0));
  transparent.red = transparent.gray;
  transparent.green = static_cast<png_uint_16>(stored(kind, 2, 2, 1));
  transparent.blue = static_cast<png_uint_16>(stored(kind, 2, 2, 2));
  if (kind.has_transparent_colour)
    png_set_tRNS(png, info, opacity.data(), static_cast<int>(colours), &transparent);
  png_set_gAMA(png, info, 0.7);  // must be ignored
  png_write_info(png, info);
  const std::uint32_t components = png_get_channels(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  std::vector<ImageBytes> rows(kHigh, ImageBytes(row_bytes));
  std::vector<png_bytep> pointers;
  for (std::uint32_t y = 0; y < kHigh; ++y) {
    std::uint32_t bit = 0;
    for (std::uint32_t i = 0; i < kWide * components; ++i) {
      const std::uint32_t value = stored(kind, i / components, y, i % components);
      for (int b = kind.bits - 1; b >= 0; --b, ++bit) {
        const std::uint32_t one = value >> b & 1;
        rows[y][bit / 8] = static_cast<std::uint8_t>(rows[y][bit / 8] | one << (7 - bit % 8));
      }
    }
    pointers.push_back(rows[y].data());
  }
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

std::array<std::uint32_t, 4> expected_pixel(const PngKind& kind, std::uint32_t x, std::uint32_t y) {
  std::array<std::uint32_t, 4> own{}, pixel{0, 0, 0, 255};
  for (std::uint32_t c = 0; c < 4; ++c) own[c] = stored(kind, x, y, c);
  if (kind.colour == PNG_COLOR_TYPE_PALETTE) {
    const png_color colour = palette_colour(own[0]);
    const std::uint32_t alpha = kind.has_transparent_colour ? own[0] * 7 & 255 : 255;
    return {colour.red, colour.green, colour.blue, alpha};
  }
  const auto eight_bits = [&](std::uint32_t value) {
    const double largest = (1u << kind.bits) - 1;
    return static_cast<std::uint32_t>(std::lround(value * 255 / largest));
  };
  const bool is_coloured = (kind.colour & PNG_COLOR_MASK_COLOR) != 0;
  for (std::uint32_t c = 0; c < 3; ++c) pixel[c] = eight_bits(own[is_coloured ? c : 0]);
  if ((kind.colour & PNG_COLOR_MASK_ALPHA) != 0) pixel[3] = eight_bits(own[is_coloured ? 3 : 1]);
  if (kind.has_transparent_colour) {
    bool is_it = true;
    for (std::uint32_t c = 0; c < (is_coloured ? 3u : 1u); ++c)
      is_it = is_it && own[c] == stored(kind, 2, 2, c);
    if (is_it) pixel[3] = 0;
  }
  return pixel;
}

std::vector<PngKind> png_kinds() {
  const std::map<int, std::vector<int>> bits_of = {{PNG_COLOR_TYPE_GRAY, {1, 2, 4, 8, 16}},
                                                   {PNG_COLOR_TYPE_PALETTE, {1, 2, 4, 8}},
                                                   {PNG_COLOR_TYPE_RGB, {8, 16}},
                                                   {PNG_COLOR_TYPE_GRAY_ALPHA, {8, 16}},
                                                   {PNG_COLOR_TYPE_RGB_ALPHA, {8, 16}}};
  std::vector<PngKind> kinds;
  for (const auto& [colour, all_bits] : bits_of) {
    for (const int bits : all_bits) {
      for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
        kinds.push_back({colour, bits, interlace, false});
        if ((colour & PNG_COLOR_MASK_ALPHA) == 0) kinds.push_back({colour, bits, interlace, true});
      }
    }
  }
  return kinds;
}

TEST(Image, PngOfEveryKindHasTheColoursThatItStores) {
  for (const PngKind& kind : png_kinds()) {
    SCOPED_TRACE(::testing::Message() << "colour type " << kind.colour << ", " << kind.bits
                                      << " bits, interlace " << kind.interlace);
    const ImageBytes png = png_of(kind);
    const auto image = io::decode_image(png);
    ASSERT_TRUE(image.has_value());
    ASSERT_EQ(io::image_size(png), (io::ImageSize{kWide, kHigh}));
    ASSERT_EQ(image->rgba.size(), 4 * kWide * kHigh);
    for (std::uint32_t y = 0, i = 0; y < kHigh; ++y) {
      for (std::uint32_t x = 0; x < kWide; ++x) {
        const auto expected = expected_pixel(kind, x, y);
        for (std::uint32_t c = 0; c < 4; ++c, ++i)
          ASSERT_EQ(image->rgba[i], expected[c]) << x << ", " << y << ", component " << c;
      }
    }
  }
}

TEST(Image, DamagedPngIsRefused) {
  const ImageBytes png = png_of({PNG_COLOR_TYPE_RGB, 8, PNG_INTERLACE_NONE, false});
  for (std::size_t length = 0; length + 16 < png.size(); ++length)
    EXPECT_FALSE(io::decode_image({png.data(), length}).has_value()) << length;
  for (const std::size_t at : {17u, 29u, 60u}) {  // width, checksum of the header, pixels
    ImageBytes damaged = png;
    damaged[at] ^= 1;
    EXPECT_FALSE(io::decode_image(damaged).has_value()) << at;
  }
}

struct JpegKind {
  J_COLOR_SPACE space = JCS_UNKNOWN;
  int components = 0;
  bool is_progressive = false, is_adobe = true;
};

ImageBytes jpeg_of(const JpegKind& kind, int scans = 0) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &data, &size);
  jpeg.image_width = kWide;
  jpeg.image_height = kHigh;
  jpeg.input_components = kind.components;
  jpeg.in_color_space = kind.space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  for (int c = 0; c < kind.components; ++c)
    jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
  if (kind.components == 4) jpeg.write_Adobe_marker = kind.is_adobe ? TRUE : FALSE;
  if (kind.is_progressive) jpeg_simple_progression(&jpeg);
  // DC to bit 1, then its last bit; then bands of AC, one coefficient each and bit by bit.
  std::vector<jpeg_scan_info> script;
  if (scans > 0) {
    script.push_back({1, {0}, 0, 0, 0, 0});
    for (int k = 1; std::ssize(script) < scans; ++k) {
      script.push_back({1, {0}, k, k, 0, 1});
      script.push_back({1, {0}, k, k, 1, 0});
    }
    script.resize(static_cast<std::size_t>(scans));
    jpeg.scan_info = script.data();
    jpeg.num_scans = scans;
  }
  jpeg_start_compress(&jpeg, TRUE);
  ImageBytes row(std::size_t{kWide} * static_cast<std::size_t>(kind.components));
  for (std::uint32_t y = 0; y < kHigh; ++y) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const auto c = static_cast<std::uint32_t>(i % static_cast<std::size_t>(kind.components));
      row[i] = static_cast<std::uint8_t>(60 + 40 * c + 3 * y);
    }
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  ImageBytes out(data, data + size);
  std::free(data);
  return out;
}

std::array<int, 4> expected_jpeg_pixel(const JpegKind& kind, std::uint32_t y) {
  std::array<int, 4> own{};
  for (int c = 0; c < 4; ++c)
    own[static_cast<std::size_t>(c)] = 60 + 40 * c + 3 * static_cast<int>(y);
  if (kind.components == 1) return {own[0], own[0], own[0], 255};
  if (kind.components == 3) return {own[0], own[1], own[2], 255};
  std::array<int, 4> pixel{0, 0, 0, 255};
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = kind.is_adobe ? own[c] * own[3] / 255 : (255 - own[c]) * (255 - own[3]) / 255;
  }
  return pixel;
}

TEST(Image, JpegOfEveryKindIsNearWhatWasWritten) {
  for (const bool is_progressive : {false, true}) {
    for (JpegKind kind : {JpegKind{JCS_GRAYSCALE, 1}, JpegKind{JCS_RGB, 3}, JpegKind{JCS_CMYK, 4},
                          JpegKind{JCS_CMYK, 4, false, false}}) {
      kind.is_progressive = is_progressive;
      SCOPED_TRACE(::testing::Message() << kind.components << " components, progressive "
                                        << kind.is_progressive << ", Adobe " << kind.is_adobe);
      const ImageBytes jpeg = jpeg_of(kind);
      const auto image = io::decode_image(jpeg);
      ASSERT_TRUE(image.has_value());
      ASSERT_EQ(io::image_size(jpeg), (io::ImageSize{kWide, kHigh}));
      for (std::uint32_t i = 0; i < image->rgba.size(); ++i) {
        const int expected = expected_jpeg_pixel(kind, i / 4 / kWide)[i % 4];
        ASSERT_NEAR(image->rgba[i], expected, 2) << "component " << i % 4 << " of " << i / 4;
      }
    }
  }
}

// Each scan of a progressive image takes the time of all pixels.
TEST(Image, JpegWithTooManyScansIsRefused) {
  const JpegKind grey{JCS_GRAYSCALE, 1};
  EXPECT_TRUE(io::decode_image(jpeg_of(grey, io::kMostScans)).has_value());
  EXPECT_FALSE(io::decode_image(jpeg_of(grey, io::kMostScans + 1)).has_value());
}

TEST(Image, TruncatedJpegIsRefused) {
  for (const bool is_progressive : {false, true}) {
    const ImageBytes jpeg = jpeg_of({JCS_RGB, 3, is_progressive});
    // The last pixel's bits may be followed by a stuffing byte, and by the end mark.
    for (std::size_t length = 0; length < jpeg.size() - 3; ++length)
      EXPECT_FALSE(io::decode_image({jpeg.data(), length}).has_value()) << length;
    EXPECT_EQ(io::decode_image({jpeg.data(), jpeg.size() - 2}).has_value(), !is_progressive)
        << "an image with one scan needs no end mark";
  }
}

// Missing pixels have the same colour in two decodings, between which memory is reused.
TEST(Image, TruncatedFilesDecodeToTheSamePixels) {
  std::vector<ImageBytes> files = {jpeg_of({JCS_RGB, 3}), jpeg_of({JCS_RGB, 3, true})};
  for (const auto& entry :
       fs::directory_iterator(fs::path(RAYSHEAF_SOURCE_DIR) / "tests/fuzz/seeds/image")) {
    const std::string text = read_file(entry.path());
    files.emplace_back(text.begin(), text.end());
  }
  ASSERT_GT(files.size(), 6u);
  for (const ImageBytes& file : files) {
    for (std::size_t length = 0; length <= file.size(); length += 7) {
      const auto once = io::decode_image({file.data(), length});
      const ImageBytes between(std::size_t{4} * kWide * kHigh, static_cast<std::uint8_t>(length));
      const auto again = io::decode_image({file.data(), length});
      ASSERT_EQ(once.has_value(), again.has_value());
      if (once) {
        EXPECT_EQ(once->rgba, again->rgba) << length;
      }
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
