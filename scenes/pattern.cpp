#include "scenes/pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/vec.h"
#include "scenes/builder.h"

namespace raysheaf::builtin {
namespace {

/// A colour as the image stores it: sRGB in [0, 1].
Vec3 colour(std::uint32_t rgb) {
  const auto channel = [rgb](int shift) { return static_cast<float>((rgb >> shift) & 0xff) / 255; };
  return {channel(16), channel(8), channel(0)};
}

/// Calls `f` with the middle of each pixel, v downwards.
template <typename F>
Image paint(std::string_view name, std::uint32_t width, std::uint32_t height, F f) {
  Image image;
  image.name = name;
  image.width = width;
  image.height = height;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const Vec3 c = f((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                       (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
      for (int k = 0; k < 3; ++k) {
        image.rgba.push_back(static_cast<std::uint8_t>(clamp(component(c, k), 0, 1) * 255 + 0.5f));
      }
      image.rgba.push_back(255);
    }
  }
  return image;
}

/// A number in [0, 1) for a pair of integers.
float chance(int x, int y) {
  auto h =
      static_cast<std::uint32_t>(x) * 0x9e3779b1u ^ static_cast<std::uint32_t>(y) * 0x85ebca77u;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return static_cast<float>((h ^ (h >> 15)) >> 8) * 0x1p-24f;
}

float smooth(float t) {
  return t * t * (3 - 2 * t);
}

float step_between(float low, float high, float x) {
  return smooth(clamp((x - low) / (high - low), 0, 1));
}

/// Value noise in [0, 1) with `nx` by `ny` cells in the unit square, which repeats.
float noise(float u, float v, int nx, int ny) {
  const float x = u * static_cast<float>(nx), y = v * static_cast<float>(ny);
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const float fx = smooth(x - static_cast<float>(i)), fy = smooth(y - static_cast<float>(j));
  const auto at = [&](int a, int b) {
    return chance(((a % nx) + nx) % nx + 31 * nx, ((b % ny) + ny) % ny + 17 * ny);
  };
  const float low = at(i, j) * (1 - fx) + at(i + 1, j) * fx;
  const float high = at(i, j + 1) * (1 - fx) + at(i + 1, j + 1) * fx;
  return low * (1 - fy) + high * fy;
}

float cloud(float u, float v, int nx, int ny) {
  return 0.55f * noise(u, v, nx, ny) + 0.3f * noise(u, v, 2 * nx, 2 * ny) +
         0.15f * noise(u, v, 4 * nx, 4 * ny);
}

/// Fibres along u, in [0, 1].
float grain(float u, float v) {
  const float bend = 0.03f * noise(u, v, 3, 2);
  const float rings = 0.5f + 0.5f * std::sin(2 * kPi * (6 * v + 40 * bend * noise(u, v, 2, 3)));
  return 0.45f * rings + 0.35f * noise(u, v + bend, 4, 64) + 0.2f * noise(u, v, 24, 128);
}

/// One of the stones or boards that cover a unit square in rows, and the point's position in it.
struct Cell {
  int row = 0, column = 0;
  float u = 0, v = 0;  ///< in [0, 1) within the cell
};

/// Every second row is shifted by half a stone.
Cell cell_at(float u, float v, int columns, int rows) {
  Cell cell;
  const float y = v * static_cast<float>(rows);
  cell.row = static_cast<int>(y);
  const float shift = cell.row % 2 == 0 ? 0.0f : 0.5f;
  const float x = u * static_cast<float>(columns) + shift;
  cell.column = static_cast<int>(x) % columns;
  cell.u = x - std::floor(x);
  cell.v = y - std::floor(y);
  return cell;
}

/// 1 within the cell, 0 at its edge.
float inside(const Cell& cell, float border_u, float border_v) {
  const float du = std::min(cell.u, 1 - cell.u), dv = std::min(cell.v, 1 - cell.v);
  return step_between(0.3f, 1, du / border_u) * step_between(0.3f, 1, dv / border_v);
}

Vec3 masonry(float u, float v, int columns, int rows, Vec3 dark, Vec3 light, Vec3 joint) {
  const Cell cell = cell_at(u, v, columns, rows);
  const float own = chance(cell.column + 101, cell.row + 7);
  const float shade = 0.55f * own + 0.3f * cloud(u, v, 8, 8) + 0.15f * noise(u, v, 128, 128);
  const float ratio = static_cast<float>(columns) / static_cast<float>(rows);
  const float edge = inside(cell, 0.045f * ratio, 0.045f);
  return lerp(joint, lerp(dark, light, shade), edge);
}

float disc(float u, float v, float cu, float cv, float radius) {
  const float d = std::sqrt((u - cu) * (u - cu) + (v - cv) * (v - cv));
  return 1 - step_between(radius - 0.006f, radius + 0.006f, d);
}

float bar(float u, float v, float u0, float v0, float u1, float v1) {
  return u >= u0 && u < u1 && v >= v0 && v < v1 ? 1.0f : 0.0f;
}

}  // namespace

Image wood_grain() {
  return paint("wood grain", 256, 256, [](float u, float v) {
    return lerp(colour(0x9c6b3c), colour(0xc99b66), grain(u, v));
  });
}

Image floor_planks() {
  return paint("floor planks", 256, 256, [](float u, float v) {
    const Cell cell = cell_at(u, v, 2, 8);
    const float own = chance(cell.column + 11, cell.row + 23);
    const float fibres = grain(u + own, v * 2 + own);
    const Vec3 wood = lerp(colour(0x8a6240), colour(0xc4976a), 0.45f * own + 0.55f * fibres);
    return wood * (0.65f + 0.35f * inside(cell, 0.01f, 0.07f));
  });
}

Image rug() {
  return paint("rug", 256, 256, [](float u, float v) {
    const float edge = std::min({u, 1 - u, v, 1 - v});
    const Vec3 weave = Vec3{1, 1, 1} * (0.9f + 0.1f * noise(u, v, 128, 128));
    Vec3 c = colour(0x27405e);
    const float pu = std::fabs(u * 6 - std::floor(u * 6) - 0.5f);
    const float pv = std::fabs(v * 4 - std::floor(v * 4) - 0.5f);
    if (pu + pv < 0.42f) c = colour(0xd8c7a3);
    if (pu + pv < 0.30f) c = colour(0xb04a34);
    if (pu + pv < 0.12f) c = colour(0xe0b04c);
    if (edge < 0.075f) c = colour(0xd8c7a3);
    if (edge < 0.055f) c = colour(0xa03c2e);
    if (edge < 0.018f) c = colour(0x27405e);
    return Vec3{c.x * weave.x, c.y * weave.y, c.z * weave.z};
  });
}

Image landscape() {
  return paint("landscape", 256, 192, [](float u, float v) {
    Vec3 c = lerp(colour(0x35578c), colour(0xf4b26a), step_between(0, 0.6f, v));
    c = lerp(c, colour(0xfff0c0), disc(u, v, 0.66f, 0.40f, 0.075f));
    const std::array<std::uint32_t, 4> hills = {0x8a6d86, 0x63597d, 0x3f5a55, 0x22382f};
    for (int i = 0; i < 4; ++i) {
      const float crest = 0.46f + 0.13f * static_cast<float>(i) -
                          0.22f * cloud(u, 0.13f * static_cast<float>(i), 3 + i, 5);
      c = lerp(c, colour(hills[static_cast<std::size_t>(i)]),
               step_between(crest, crest + 0.01f, v));
    }
    return c;
  });
}

Image abstract_art() {
  return paint("abstract art", 192, 256, [](float u, float v) {
    Vec3 c = lerp(colour(0xf1e8d6), colour(0xe6d9c0), noise(u, v, 32, 32));
    c = lerp(c, colour(0xd5492f), disc(u, v * 1.33f, 0.40f, 0.42f, 0.26f));
    c = lerp(c, colour(0xe9b23d), disc(u, v * 1.33f, 0.66f, 0.82f, 0.20f));
    c = lerp(c, colour(0x1f5f7a), bar(u, v, 0.10f, 0.55f, 0.48f, 0.82f));
    c = lerp(c, colour(0x20242c), bar(u, v, 0.60f, 0.10f, 0.66f, 0.62f));
    return lerp(c, colour(0x20242c), bar(u, v, 0.10f, 0.86f, 0.90f, 0.885f));
  });
}

Image window_view() {
  return paint("window view", 256, 128, [](float u, float v) {
    Vec3 c = lerp(colour(0x6fa8dc), colour(0xdcecf5), step_between(0, 0.75f, v));
    c = lerp(c, colour(0xffffff), step_between(0.48f, 0.75f, cloud(u, v, 5, 7)) * 0.9f);
    const float far = 0.66f - 0.10f * cloud(u, 0.2f, 4, 5),
                near = 0.84f - 0.22f * cloud(u, 0.7f, 12, 5);
    c = lerp(c, colour(0x8fae9f), step_between(far, far + 0.02f, v));
    const Vec3 leaves = lerp(colour(0x2f5a2c), colour(0x7fa548), cloud(u, v, 24, 12));
    return lerp(c, leaves, step_between(near, near + 0.02f, v));
  });
}

Image screen_text() {
  constexpr std::array<std::uint32_t, 5> kInks = {0x7fb4ff, 0xe6e9ef, 0x8fd18a, 0xf0b45a, 0xd98ad6};
  return paint("screen text", 256, 160, [&](float u, float v) {
    if (v < 0.06f) return colour(0x3b4456);
    if (u < 0.16f)
      return v < 0.5f && cell_at(u, v, 1, 28).v < 0.45f && u > 0.02f && u < 0.12f
                 ? colour(0x6d7a94)
                 : colour(0x20283a);
    const Cell line = cell_at(0, v, 1, 26);
    const int indent = static_cast<int>(chance(3, line.row) * 4);
    const int word = static_cast<int>((u - 0.19f) * 24);
    const int last = indent + 2 + static_cast<int>(chance(9, line.row) * 11);
    const bool gap = chance(word, line.row + 50) < 0.18f || chance(4, line.row) < 0.12f;
    if (u < 0.19f || word < indent || word > last || gap || line.v > 0.5f) return colour(0x141a28);
    return colour(kInks[static_cast<std::size_t>(chance(word, line.row) * 5)]);
  });
}

Image paving() {
  return paint("paving", 256, 256, [](float u, float v) {
    return masonry(u, v, 4, 4, colour(0x8d8069), colour(0xd2c4a4), colour(0x5d5548));
  });
}

Image stone_blocks() {
  return paint("stone blocks", 256, 256, [](float u, float v) {
    return masonry(u, v, 4, 8, colour(0xb09468), colour(0xdcc594), colour(0x96805c));
  });
}

}  // namespace raysheaf::builtin
