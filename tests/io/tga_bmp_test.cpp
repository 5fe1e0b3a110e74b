// TGA and BMP files of every kind, written byte by byte here, complete and truncated.
#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "io/image.h"

namespace raysheaf::test {
namespace {

using PictureBytes = std::vector<std::uint8_t>;
using Rgba = std::array<std::uint8_t, 4>;

constexpr std::uint32_t kColumns = 11, kRows = 5;

/// Runs of three pixels; none has the values 0 or 255, which truncated files may yield.
Rgba pattern(std::uint32_t x, std::uint32_t y) {
  const std::uint32_t n = x / 3 + 4 * y;
  return {static_cast<std::uint8_t>(10 + 9 * n), static_cast<std::uint8_t>(200 - 7 * n),
          static_cast<std::uint8_t>(30 + 5 * n), static_cast<std::uint8_t>(90 + 3 * n)};
}

void put16(std::uint32_t value, PictureBytes* out) {
  out->push_back(static_cast<std::uint8_t>(value & 255));
  out->push_back(static_cast<std::uint8_t>(value >> 8 & 255));
}
void put32(std::uint32_t value, PictureBytes* out) {
  put16(value & 0xffff, out);
  put16(value >> 16, out);
}

struct TgaKind {
  /// 1: palette, 2: colours, 3: grey; plus 8: run-length encoded.
  std::uint8_t type = 2, bits = 24;
  bool from_top = false;
};

/// Five bits per channel, as in 16-bit images.
std::uint32_t packed_555(const Rgba& c) {
  return static_cast<std::uint32_t>(c[0] >> 3 << 10 | c[1] >> 3 << 5 | c[2] >> 3);
}

/// A pixel's bytes in the file; with a palette, its index.
PictureBytes tga_pixel(const TgaKind& kind, std::uint32_t x, std::uint32_t y) {
  const Rgba c = pattern(x, y);
  switch (kind.type % 8) {
    case 1:
      return {static_cast<std::uint8_t>(x / 3 + 4 * y)};
    case 3:
      return {c[0]};
    default:
      if (kind.bits == 16) {
        PictureBytes two;
        put16(packed_555(c), &two);
        return two;
      }
      if (kind.bits == 24) return {c[2], c[1], c[0]};
      return {c[2], c[1], c[0], c[3]};
  }
}

PictureBytes tga_of(const TgaKind& kind) {
  const bool has_palette = kind.type % 8 == 1;
  PictureBytes out{3, static_cast<std::uint8_t>(has_palette ? 1 : 0), kind.type};
  put16(0, &out);
  put16(has_palette ? 4 * kRows : 0, &out);
  out.push_back(has_palette ? 24 : 0);
  put32(0, &out);
  put16(kColumns, &out);
  put16(kRows, &out);
  out.push_back(kind.bits);
  out.push_back(kind.from_top ? 0x20 : 0);
  out.insert(out.end(), {'i', 'd', '.'});
  for (std::uint32_t n = 0; has_palette && n < 4 * kRows; ++n) {
    const Rgba c = pattern(n % 4 * 3, n / 4);
    out.insert(out.end(), {c[2], c[1], c[0]});
  }
  for (std::uint32_t row = 0; row < kRows; ++row) {
    const std::uint32_t y = kind.from_top ? row : kRows - 1 - row;
    for (std::uint32_t x = 0; x < kColumns;) {
      const PictureBytes pixel = tga_pixel(kind, x, y);
      // Every other run is written pixel by pixel.
      const bool is_run = x % 2 == 0;
      const std::uint32_t length = kind.type < 8 ? 1 : std::min(3u, kColumns - x);
      if (kind.type > 8) out.push_back(static_cast<std::uint8_t>((is_run ? 128 : 0) + length - 1));
      for (std::uint32_t i = 0; i < (is_run && kind.type > 8 ? 1 : length); ++i)
        out.insert(out.end(), pixel.begin(), pixel.end());
      x += length;
    }
  }
  return out;
}

/// 24 bits, or 8 with a palette. Rows are padded to four bytes.
PictureBytes bmp_of(std::uint32_t bits, bool from_top) {
  const std::uint32_t palette = bits == 8 ? 4 * kRows : 0;
  const std::uint32_t begin = 14 + 40 + 4 * palette;
  PictureBytes out{'B', 'M'};
  put32(begin + kRows * (kColumns * bits / 8 + 3) / 4 * 4, &out);
  put32(0, &out);
  put32(begin, &out);
  put32(40, &out);
  put32(kColumns, &out);
  put32(from_top ? ~kRows + 1 : kRows, &out);
  put16(1, &out);
  put16(bits, &out);
  for (const std::uint32_t field : {0u, 0u, 2835u, 2835u, palette, 0u}) put32(field, &out);
  for (std::uint32_t n = 0; n < palette; ++n) {
    const Rgba c = pattern(n % 4 * 3, n / 4);
    out.insert(out.end(), {c[2], c[1], c[0], 0});
  }
  for (std::uint32_t row = 0; row < kRows; ++row) {
    const std::uint32_t y = from_top ? row : kRows - 1 - row;
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      const Rgba c = pattern(x, y);
      if (bits == 8) {
        out.push_back(static_cast<std::uint8_t>(x / 3 + 4 * y));
      } else {
        out.insert(out.end(), {c[2], c[1], c[0]});
      }
    }
    while ((out.size() - begin) % 4 != 0) out.push_back(0);
  }
  return out;
}

/// How a BMP with masks stores its pixels: the masks of red, green, blue and alpha.
struct BmpMasks {
  std::uint32_t bits;
  std::array<std::uint32_t, 4> mask;
};

/// Rows are stored from bottom to top. The header has version 4, the first one with an alpha mask.
PictureBytes masked_bmp(const BmpMasks& kind) {
  constexpr std::uint32_t kBegin = 14 + 108;
  PictureBytes out{'B', 'M'};
  for (const std::uint32_t field : {0u, 0u, kBegin, 108u, kColumns, kRows}) put32(field, &out);
  put16(1, &out);
  put16(kind.bits, &out);
  for (const std::uint32_t field : {3u, 0u, 2835u, 2835u, 0u, 0u}) put32(field, &out);
  for (const std::uint32_t mask : kind.mask) put32(mask, &out);
  out.resize(kBegin);
  for (std::uint32_t row = 0; row < kRows; ++row) {
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      const Rgba c = pattern(x, kRows - 1 - row);
      std::uint32_t pixel = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t mask = kind.mask[i];
        if (mask == 0) continue;
        const int lost = 8 - std::popcount(mask);
        pixel |= static_cast<std::uint32_t>(c[i] >> lost) << std::countr_zero(mask);
      }
      kind.bits == 16 ? put16(pixel, &out) : put32(pixel, &out);
    }
    while ((out.size() - kBegin) % 4 != 0) out.push_back(0);
  }
  return out;
}

enum class Shows { kColor, kColorAndAlpha, kGrey };

void expect_pattern(const PictureBytes& bytes, Shows shows, int tolerance = 0) {
  const auto image = io::decode_image(bytes);
  ASSERT_TRUE(image.has_value());
  ASSERT_EQ(io::image_size(bytes), (io::ImageSize{kColumns, kRows}));
  for (std::uint32_t y = 0; y < kRows; ++y) {
    for (std::uint32_t x = 0; x < kColumns; ++x) {
      Rgba expected = pattern(x, y);
      if (shows != Shows::kColorAndAlpha) expected[3] = 255;
      if (shows == Shows::kGrey) expected[1] = expected[2] = expected[0];
      const std::uint8_t* const pixel = &image->rgba[4 * (std::size_t{y} * kColumns + x)];
      for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(pixel[i], expected[i], tolerance) << x << ", " << y << "[" << i << "]";
    }
  }
}

/// `spare`: bytes at the end that pad a row.
void expect_none_cut_short(const PictureBytes& bytes, std::size_t spare) {
  for (std::size_t length = 0; length < bytes.size() - spare; ++length)
    EXPECT_FALSE(io::decode_image({bytes.data(), length}).has_value()) << length;
  for (std::size_t length = bytes.size() - spare; length <= bytes.size(); ++length)
    EXPECT_TRUE(io::decode_image({bytes.data(), length}).has_value()) << length;
}

TEST(TgaBmp, TgaOfEveryKind) {
  for (const int type : {1, 2, 3, 9, 10, 11}) {
    for (const bool from_top : {false, true}) {
      for (const int bits : {8, 16, 24, 32}) {
        if ((bits == 8) != (type % 8 != 2)) continue;
        SCOPED_TRACE(::testing::Message() << "type " << type << ", " << bits << " bits, "
                                          << (from_top ? "from the top" : "from below"));
        PictureBytes tga =
            tga_of({static_cast<std::uint8_t>(type), static_cast<std::uint8_t>(bits), from_top});
        expect_pattern(tga,
                       type % 8 == 3 ? Shows::kGrey
                       : bits == 32  ? Shows::kColorAndAlpha
                                     : Shows::kColor,
                       bits == 16 ? 7 : 0);
        expect_none_cut_short(tga, 0);
        tga.resize(tga.size() + 26, 'T');
        EXPECT_TRUE(io::decode_image(tga).has_value()) << "bytes after the end are ignored";
      }
    }
  }
}

TEST(TgaBmp, BmpOfEveryKind) {
  for (const std::uint32_t bits : {8u, 24u}) {
    for (const bool from_top : {false, true}) {
      SCOPED_TRACE(::testing::Message() << bits << " bits, from the top: " << from_top);
      const PictureBytes bmp = bmp_of(bits, from_top);
      expect_pattern(bmp, Shows::kColor);
      expect_none_cut_short(bmp, (4 - kColumns * bits / 8 % 4) % 4);
    }
  }
}

TEST(TgaBmp, BmpWithMasks) {
  const BmpMasks kinds[] = {{16, {0x7c00, 0x3e0, 0x1f, 0}},
                            {16, {0xf800, 0x7e0, 0x1f, 0}},
                            {32, {0xff0000, 0xff00, 0xff, 0}},
                            {32, {0xff, 0xff00, 0xff0000, 0xff000000}}};
  for (const BmpMasks& kind : kinds) {
    SCOPED_TRACE(::testing::Message() << kind.bits << " bits, red " << kind.mask[0]);
    const PictureBytes bmp = masked_bmp(kind);
    expect_pattern(bmp, kind.mask[3] != 0 ? Shows::kColorAndAlpha : Shows::kColor,
                   kind.bits == 16 ? 7 : 0);
    for (std::size_t length = 0; length < bmp.size() - 3; length += 7)
      EXPECT_FALSE(io::decode_image({bmp.data(), length}).has_value()) << length;
  }
}

}  // namespace
}  // namespace raysheaf::test
