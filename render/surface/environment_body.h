// Light from an environment: look-up by direction, and choice of directions by brightness.
//
//   v = 0 +---------------------------+ +y       u = 1/2: towards -z; u increases to the right
//         |            -z             |          for a viewer who looks there, towards +x
//   v = 1 +---------------------------+ -y
#pragma once

#include <cmath>
#include <cstdint>

#include "base/trigonometry.h"
#include "base/vec.h"

namespace raysheaf {

/// A map of radiance, bilinear between its texels' centres, and the texels' brightness. Read-only
/// pointers.
struct EnvironmentView {
  const Vec3* radiance = nullptr;  ///< rows from the top
  /// Distribution functions: up to each row's end, and up to each texel's end within its row. The
  /// last value is 1. Null if the map is black.
  const float* row_ends = nullptr;
  const float* texel_ends = nullptr;
  std::uint32_t width = 0, height = 0;
  float intensity = 1, cos_rotation = 1, sin_rotation = 0;
};

/// A direction rotated about +y.
RAYSHEAF_HD inline Vec3 turned(Vec3 d, float cosine, float sine) {
  return {cosine * d.x + sine * d.z, d.y, cosine * d.z - sine * d.x};
}

/// The place in the map of a unit direction, both coordinates in [0, 1].
RAYSHEAF_HD inline Vec2 map_place(const EnvironmentView& map, Vec3 direction) {
  const Vec3 d = turned(direction, map.cos_rotation, -map.sin_rotation);
  const double around = portable::angle_of(static_cast<double>(d.x), static_cast<double>(-d.z));
  const double polar = portable::arc_cosine(static_cast<double>(clamp(d.y, -1, 1)));
  return {static_cast<float>(0.5 + around / (2 * portable::kPi)),
          static_cast<float>(polar / portable::kPi)};
}

RAYSHEAF_HD inline Vec3 map_direction(const EnvironmentView& map, Vec2 place) {
  const auto [sine, cosine] =
      portable::sine_cosine(2 * portable::kPi * (static_cast<double>(place.x) - 0.5));
  const auto [ring, height] = portable::sine_cosine(portable::kPi * static_cast<double>(place.y));
  const Vec3 d{static_cast<float>(ring * sine), static_cast<float>(height),
               static_cast<float>(-ring * cosine)};
  return turned(d, map.cos_rotation, map.sin_rotation);
}

/// Columns wrap around; rows end at the poles.
RAYSHEAF_HD inline Vec3 environment_texel(const EnvironmentView& map, std::int64_t x,
                                          std::int64_t y) {
  const std::int64_t column = x < 0 ? x + map.width : x >= map.width ? x - map.width : x;
  const std::int64_t row = y < 0 ? 0 : y >= map.height ? map.height - 1 : y;
  return map.radiance[row * map.width + column];
}

/// The radiance from a unit direction.
RAYSHEAF_HD inline Vec3 environment_radiance(const EnvironmentView& map, Vec3 direction) {
  const Vec2 place = map_place(map, direction);
  const float x = place.x * static_cast<float>(map.width) - 0.5f;
  const float y = place.y * static_cast<float>(map.height) - 0.5f;
  const float left = std::floor(x), above = std::floor(y);
  const auto column = static_cast<std::int64_t>(left), row = static_cast<std::int64_t>(above);
  const Vec3 upper =
      lerp(environment_texel(map, column, row), environment_texel(map, column + 1, row), x - left);
  const Vec3 lower = lerp(environment_texel(map, column, row + 1),
                          environment_texel(map, column + 1, row + 1), x - left);
  return lerp(upper, lower, y - above) * map.intensity;
}

/// The first of `count` ends that is above `chosen`, and the position of `chosen` within its part.
struct ChosenPart {
  std::uint32_t index = 0;
  float within = 0;  ///< [0, 1]
  float size = 0;    ///< the part's fraction of the whole
};
RAYSHEAF_HD inline ChosenPart choose_part(const float* ends, std::uint32_t count, float chosen) {
  std::uint32_t first = 0, last = count - 1;
  while (first < last) {
    const std::uint32_t middle = first + (last - first) / 2;
    if (ends[middle] > chosen) {
      last = middle;
    } else {
      first = middle + 1;
    }
  }
  const float begin = first == 0 ? 0 : ends[first - 1], size = ends[first] - begin;
  return {first, size > 0 ? clamp((chosen - begin) / size, 0, 1) : 0.5f, size};
}

/// The probability per steradian of a direction in a texel that is chosen with probability `part`:
/// a texel at v covers 2 pi^2 sin(pi v) / texels.
RAYSHEAF_HD inline float density_of_part(const EnvironmentView& map, float part, float v) {
  const auto ring =
      static_cast<float>(portable::sine_cosine(portable::kPi * static_cast<double>(v)).sine);
  const float texels = static_cast<float>(map.width) * static_cast<float>(map.height);
  return ring > 0 ? part * texels / (19.7392088f * ring) : 0;
}

struct ChosenDirection {
  Vec3 direction;
  float density = 0;  ///< per steradian
};

/// Chooses a direction in proportion to brightness: a row, then a texel of it (J. Pharr, W. Jakob,
/// G. Humphreys, "Physically Based Rendering", 2023, sections A.4.7 and 12.5).
RAYSHEAF_HD inline ChosenDirection choose_direction(const EnvironmentView& map, Vec2 chosen) {
  if (map.row_ends == nullptr) return {};
  const ChosenPart row = choose_part(map.row_ends, map.height, chosen.y);
  const ChosenPart texel =
      choose_part(map.texel_ends + std::size_t{row.index} * map.width, map.width, chosen.x);
  const Vec2 place{(static_cast<float>(texel.index) + texel.within) / static_cast<float>(map.width),
                   (static_cast<float>(row.index) + row.within) / static_cast<float>(map.height)};
  return {map_direction(map, place), density_of_part(map, row.size * texel.size, place.y)};
}

/// The probability per steradian with which `choose_direction` chooses a direction.
RAYSHEAF_HD inline float direction_density(const EnvironmentView& map, Vec3 direction) {
  if (map.row_ends == nullptr) return 0;
  const Vec2 place = map_place(map, direction);
  const auto cell = [](float at, std::uint32_t count) {
    const auto index = static_cast<std::uint32_t>(at * static_cast<float>(count));
    return index < count ? index : count - 1;
  };
  const std::uint32_t x = cell(place.x, map.width), y = cell(place.y, map.height);
  const float* const texels = map.texel_ends + std::size_t{y} * map.width;
  const float row = map.row_ends[y] - (y == 0 ? 0 : map.row_ends[y - 1]);
  const float texel = texels[x] - (x == 0 ? 0 : texels[x - 1]);
  return density_of_part(map, row * texel, place.y);
}

}  // namespace raysheaf
