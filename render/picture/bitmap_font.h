// A bitmap font of five by seven pixels with the letters of a heat map's legend.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace raysheaf {

inline constexpr std::uint32_t kGlyphWidth = 5, kGlyphHeight = 7, kGlyphAdvance = 6;

/// Seven rows from the top; in a row, bit 4 is the leftmost pixel.
struct Glyph {
  char letter;
  std::array<std::uint8_t, kGlyphHeight> rows;
};

inline constexpr std::array kGlyphs = {
    Glyph{' ', {0, 0, 0, 0, 0, 0, 0}},
    Glyph{'.', {0, 0, 0, 0, 0, 0b01100, 0b01100}},
    Glyph{'0', {0b01110, 0b10001, 0b10001, 0b10101, 0b10001, 0b10001, 0b01110}},
    Glyph{'1', {0b00100, 0b01100, 0b10100, 0b00100, 0b00100, 0b00100, 0b11111}},
    Glyph{'2', {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111}},
    Glyph{'3', {0b11110, 0b00001, 0b00001, 0b01110, 0b00001, 0b00001, 0b11110}},
    Glyph{'4', {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010}},
    Glyph{'5', {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110}},
    Glyph{'6', {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110}},
    Glyph{'7', {0b11111, 0b00001, 0b00010, 0b00010, 0b00100, 0b00100, 0b00100}},
    Glyph{'8', {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110}},
    Glyph{'9', {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100}},
    Glyph{'G', {0b01110, 0b10001, 0b10000, 0b10111, 0b10001, 0b10001, 0b01110}},
    Glyph{'M', {0b10001, 0b11011, 0b10101, 0b10101, 0b10001, 0b10001, 0b10001}},
    Glyph{'T', {0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100}},
    Glyph{'e', {0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01111}},
    Glyph{'i', {0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110}},
    Glyph{'k', {0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010}},
    Glyph{'l', {0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110}},
    Glyph{'p', {0, 0, 0b11110, 0b10001, 0b11110, 0b10000, 0b10000}},
    Glyph{'r', {0, 0, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000}},
    Glyph{'s', {0, 0, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110}},
    Glyph{'t', {0b01000, 0b01000, 0b11110, 0b01000, 0b01000, 0b01001, 0b00110}},
    Glyph{'x', {0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001}},
};

/// The glyph of a letter; a blank for letters that the font lacks.
constexpr const Glyph& glyph(char letter) {
  for (const Glyph& candidate : kGlyphs) {
    if (candidate.letter == letter) return candidate;
  }
  return kGlyphs[0];
}

/// Calls `pixel(x, y)` for each lit pixel of a line of text whose top left corner is (0, 0).
template <typename Pixel>
void draw_text(std::string_view text, Pixel&& pixel) {
  std::uint32_t left = 0;
  for (const char letter : text) {
    const Glyph& drawn = glyph(letter);
    for (std::uint32_t y = 0; y < kGlyphHeight; ++y) {
      for (std::uint32_t x = 0; x < kGlyphWidth; ++x) {
        if ((drawn.rows[y] >> (kGlyphWidth - 1 - x)) & 1) pixel(left + x, y);
      }
    }
    left += kGlyphAdvance;
  }
}

/// Pixels from the first to the last lit column, blanks included.
constexpr std::uint32_t text_width(std::string_view text) {
  return text.empty() ? 0
                      : static_cast<std::uint32_t>(text.size()) * kGlyphAdvance -
                            (kGlyphAdvance - kGlyphWidth);
}

}  // namespace raysheaf
