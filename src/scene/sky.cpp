#include "raysheaf/studio.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/vec.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

constexpr double kHalfTurn = std::numbers::pi, kDegree = std::numbers::pi / 180;
constexpr double kTurbidity = 3;

/// Luminance and chromaticity, or coefficients of Perez's function for each of them.
using YxyTriple = std::array<double, 3>;

/// The coefficients A to E of Perez's function for Y, x and y (appendix A.2 of the paper): each is
/// `slope` * turbidity + `start`.
struct PerezLine {
  double slope, start;
};
constexpr PerezLine kPerez[3][5] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592},
     {-0.0665, 0.0008},
     {-0.0004, 0.2125},
     {-0.0641, -0.8989},
     {-0.0033, 0.0452}},
    {{-0.0167, -0.2608},
     {-0.0950, 0.0092},
     {-0.0079, 0.2102},
     {-0.0441, -1.6537},
     {-0.0109, 0.0529}},
};

/// Perez's function of the angles from the zenith and from the sun.
double perez(std::size_t of, double cos_zenith, double from_sun) {
  const auto c = [&](std::size_t i) {
    return kPerez[of][i].slope * kTurbidity + kPerez[of][i].start;
  };
  const double cos_sun = std::cos(from_sun);
  return (1 + c(0) * std::exp(c(1) / cos_zenith)) *
         (1 + c(2) * std::exp(c(3) * from_sun) + c(4) * cos_sun * cos_sun);
}

/// The zenith's luminance in kcd/m² and its chromaticity; `s` is the sun's angle from the zenith.
YxyTriple zenith(double s) {
  const double t = kTurbidity, chi = (4.0 / 9 - t / 120) * (kHalfTurn - 2 * s);
  const auto chromaticity = [&](const std::array<std::array<double, 4>, 3>& rows) {
    const std::array<double, 3> powers{t * t, t, 1};
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
      sum += powers[i] * (((rows[i][0] * s + rows[i][1]) * s + rows[i][2]) * s + rows[i][3]);
    return sum;
  };
  return {(4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192,
          chromaticity({{{0.00166, -0.00375, 0.00209, 0},
                         {-0.02903, 0.06377, -0.03202, 0.00394},
                         {0.11693, -0.21196, 0.06052, 0.25886}}}),
          chromaticity({{{0.00275, -0.00610, 0.00317, 0},
                         {-0.04214, 0.08970, -0.04153, 0.00516},
                         {0.15346, -0.26756, 0.06670, 0.26688}}})};
}

/// Linear sRGB (IEC 61966-2-1), without negative parts.
Vec3 rgb_of(const YxyTriple& color) {
  const double big_y = color[0], x = color[1], y = color[2];
  const double big_x = x / y * big_y, big_z = (1 - x - y) / y * big_y;
  const auto part = [&](double a, double b, double c) {
    return static_cast<float>(std::max(a * big_x + b * big_y + c * big_z, 0.0));
  };
  return {part(3.2406, -1.5372, -0.4986), part(-0.9689, 1.8758, 0.0415),
          part(0.0557, -0.2040, 1.0570)};
}

/// The irradiance of a surface that faces the sun, in klx: the sun above the atmosphere behind
/// Rayleigh's and Ångström's attenuation (appendix A.1) at 0.64, 0.55 and 0.45 µm, with the optical
/// mass of Kasten and Young (1989).
Vec3 sunlight(double elevation) {
  constexpr double kAbove = 128;  // klx
  const double degrees = elevation / kDegree;
  const double mass = 1 / (std::sin(elevation) + 0.50572 * std::pow(degrees + 6.07995, -1.6364));
  const double beta = 0.04608 * kTurbidity - 0.04586;
  const auto part = [&](double length) {
    const double rayleigh = 0.008735 * std::pow(length, -4.08);
    const double aerosols = beta * std::pow(length, -1.3);
    return static_cast<float>(kAbove * std::exp(-mass * (rayleigh + aerosols)));
  };
  return {part(0.64), part(0.55), part(0.45)};
}

struct WorldAxes {
  Vec3 east, up, south;
};

WorldAxes world_axes(UpAxis up) {
  const Vec3 axis = direction_of(up);
  // As `framing_camera` has the front of a model.
  const Vec3 south = axis.z == 0 ? Vec3{0, 0, 1} : Vec3{0, -axis.z, 0};
  return {cross(axis, south), axis, south};
}

class ClearSky {
 public:
  ClearSky(Vec3 to_sun, Vec3 up)
      : to_sun_(to_sun),
        up_(up),
        sun_zenith_(std::acos(std::clamp<double>(dot(to_sun, up), 0, 1))) {
    const YxyTriple top = zenith(sun_zenith_);
    for (std::size_t i = 0; i < 3; ++i) scale_[i] = top[i] / perez(i, 1, sun_zenith_);
  }

  /// The radiance from a direction at or above the horizon.
  [[nodiscard]] Vec3 radiance(Vec3 direction) const {
    // At the horizon the function has no value.
    const double cos_zenith = std::max<double>(dot(direction, up_), 0.01);
    const double from_sun = std::acos(std::clamp<double>(dot(direction, to_sun_), -1, 1));
    YxyTriple color;
    for (std::size_t i = 0; i < 3; ++i) color[i] = scale_[i] * perez(i, cos_zenith, from_sun);
    return rgb_of(color);
  }

 private:
  Vec3 to_sun_, up_;
  double sun_zenith_;
  YxyTriple scale_;
};

/// The direction of a texel's centre: rows from +y, the middle column towards -z.
Vec3 direction_of_texel(const Environment& map, std::uint32_t x, std::uint32_t y) {
  const double polar = kHalfTurn * (y + 0.5) / map.height;
  const double turn = 2 * kHalfTurn * ((x + 0.5) / map.width - 0.5);
  return {static_cast<float>(std::sin(polar) * std::sin(turn)), static_cast<float>(std::cos(polar)),
          static_cast<float>(-std::sin(polar) * std::cos(turn))};
}

}  // namespace

SunPosition sun_position(double latitude, double longitude, double seconds) {
  const double day = seconds / 86400 + 2440587.5 - 2451545.0;  // from 2000-01-01 12:00
  const double t = day / 36525;
  const double mean = 280.46646 + t * (36000.76983 + 0.0003032 * t);
  const double m = kDegree * (357.52911 + t * (35999.05029 - 0.0001537 * t));
  const double center = (1.914602 - t * (0.004817 + 0.000014 * t)) * std::sin(m) +
                        (0.019993 - 0.000101 * t) * std::sin(2 * m) + 0.000289 * std::sin(3 * m);
  const double node = kDegree * (125.04 - 1934.136 * t);
  const double along = kDegree * (mean + center - 0.00569 - 0.00478 * std::sin(node));
  const double tilt =
      kDegree * (23.43929111 - t * (0.0130041667 + t * (1.6389e-7 - 5.0361e-7 * t)) +
                 0.00256 * std::cos(node));
  const double declination = std::asin(std::sin(tilt) * std::sin(along));
  const double ascension = std::atan2(std::cos(tilt) * std::sin(along), std::cos(along));
  const double sidereal = 280.46061837 + 360.98564736629 * day + 0.000387933 * t * t;
  const double hour = kDegree * std::fmod(sidereal + longitude, 360) - ascension;
  const double phi = kDegree * latitude;
  SunPosition sun;
  sun.elevation = std::asin(std::clamp(std::sin(phi) * std::sin(declination) +
                                           std::cos(phi) * std::cos(declination) * std::cos(hour),
                                       -1.0, 1.0));
  sun.azimuth = std::atan2(-std::cos(declination) * std::sin(hour),
                           std::cos(phi) * std::sin(declination) -
                               std::sin(phi) * std::cos(declination) * std::cos(hour));
  if (sun.azimuth < 0) sun.azimuth += 2 * kHalfTurn;
  return sun;
}

Vec3 sun_direction(const SunPosition& sun, UpAxis up) {
  const WorldAxes axes = world_axes(up);
  const double level = std::cos(sun.elevation);
  return axes.up * static_cast<float>(std::sin(sun.elevation)) +
         axes.east * static_cast<float>(level * std::sin(sun.azimuth)) -
         axes.south * static_cast<float>(level * std::cos(sun.azimuth));
}

void add_sun_and_sky(SceneDescription& scene, Vec3 to_sun, UpAxis up) {
  const float size = max_component(abs(to_sun));
  if (!(is_finite(to_sun) && size > 0))
    throw Error(ErrorCode::kInvalidArgument, "must be a direction: finite numbers, not all 0",
                "sun");
  to_sun = normalized(to_sun * (1 / size));
  const WorldAxes axes = world_axes(up);
  const double elevation = std::asin(std::clamp<double>(dot(to_sun, axes.up), -1, 1));
  if (!(elevation > 0))
    throw Error(ErrorCode::kInvalidArgument, "the sun is below the horizon", "sun");
  const ClearSky sky(to_sun, axes.up);
  const Vec3 direct = sunlight(elevation);
  Environment map;
  map.name = "sun and sky";
  map.width = 512;
  map.height = 256;
  map.radiance.resize(std::size_t{map.width} * map.height);
  Vec3 from_sky{0, 0, 0};  // irradiance of level ground
  std::vector<std::size_t> below;
  for (std::uint32_t y = 0; y < map.height; ++y) {
    const double ring = kHalfTurn / map.height * 2 * kHalfTurn / map.width *
                        std::sin(kHalfTurn * (y + 0.5) / map.height);
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const std::size_t at = std::size_t{y} * map.width + x;
      const Vec3 direction = direction_of_texel(map, x, y);
      const float height = dot(direction, axes.up);
      if (height < 0) {
        below.push_back(at);
        continue;
      }
      map.radiance[at] = sky.radiance(direction);
      from_sky += map.radiance[at] * (height * static_cast<float>(ring));
    }
  }
  constexpr float kAlbedo = 0.2f;
  const Vec3 arriving = from_sky + direct * static_cast<float>(std::sin(elevation));
  const Vec3 ground = arriving * (kAlbedo / std::numbers::pi_v<float>);
  for (const std::size_t at : below) map.radiance[at] = ground;
  scene.environment = std::move(map);
  Light sun;
  sun.name = "sun";
  sun.type = Light::Type::kDirectional;
  sun.direction = -to_sun;
  sun.intensity = direct;
  scene.lights.push_back(std::move(sun));
}

}  // namespace raysheaf
