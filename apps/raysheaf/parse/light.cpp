#include "parse/commands.h"

#include <chrono>
#include <cmath>

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

namespace {

constexpr const char* kSunForms =
    "' is neither X,Y,Z nor LAT,LON,TIME, as in 48.1,11.6,2026-06-21T12:00Z or T14:00+02:00";

/// The number of digits `text`, which begins at `at`; throws if one of them is no digit.
int digits_at(const std::string& text, std::size_t at, std::size_t count) {
  int value = 0;
  for (std::size_t i = at; i < at + count; ++i) {
    if (i >= text.size() || text[i] < '0' || text[i] > '9')
      throw Error(ErrorCode::kInvalidArgument, "");
    value = 10 * value + (text[i] - '0');
  }
  return value;
}

/// Seconds since 1970-01-01 00:00 UTC of ISO 8601's YYYY-MM-DDTHH:MM[:SS](Z|+HH:MM|-HH:MM).
double seconds_of(const std::string& text) {
  const auto require = [](bool holds) {
    if (!holds) throw Error(ErrorCode::kInvalidArgument, "");
  };
  const auto is_at = [&](std::size_t at, char c) { return at < text.size() && text[at] == c; };
  const std::chrono::year_month_day date{
      std::chrono::year(digits_at(text, 0, 4)),
      std::chrono::month(static_cast<unsigned>(digits_at(text, 5, 2))),
      std::chrono::day(static_cast<unsigned>(digits_at(text, 8, 2)))};
  require(date.ok() && is_at(4, '-') && is_at(7, '-') && is_at(10, 'T') && is_at(13, ':'));
  const int hour = digits_at(text, 11, 2), minute = digits_at(text, 14, 2);
  const bool has_seconds = is_at(16, ':');
  const int second = has_seconds ? digits_at(text, 17, 2) : 0;
  require(hour < 24 && minute < 60 && second < 60);
  const std::size_t zone = has_seconds ? 19 : 16;
  int east = 0;  // minutes
  if (is_at(zone, '+') || is_at(zone, '-')) {
    const int hours = digits_at(text, zone + 1, 2), minutes = digits_at(text, zone + 4, 2);
    require(is_at(zone + 3, ':') && zone + 6 == text.size() && hours < 24 && minutes < 60);
    east = (is_at(zone, '-') ? -1 : 1) * (60 * hours + minutes);
  } else {
    require(is_at(zone, 'Z') && zone + 1 == text.size());
  }
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600 * hour + 60 * (minute - east) + second;
}

Sun parse_sun(const std::string& text) {
  if (text.find('T') == std::string::npos) return parse_point(text);
  try {
    const std::size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string::npos || second == std::string::npos)
      throw Error(ErrorCode::kInvalidArgument, "");
    const double latitude = parse_number(text.substr(0, first));
    const double longitude = parse_number(text.substr(first + 1, second - first - 1));
    if (std::fabs(latitude) > 90 || std::fabs(longitude) > 360)
      throw Error(ErrorCode::kInvalidArgument, "");
    return sun_position(latitude, longitude, seconds_of(text.substr(second + 1)));
  } catch (const Error&) {
    throw Error(ErrorCode::kInvalidArgument, "'" + text + kSunForms);
  }
}

}  // namespace

void add_samples(CLI::App& app, RenderCommand& command) {
  begin_group(app, kCommonGroup);
  add_value(
      app, "--samples", "N",
      "Samples per pixel, 1 to 65536 [4; 16 with an environment or a lens; 1 for a built-in "
      "scene]",
      [&command](const auto& text) { command.options.samples = parse_count(text, 1, 65536); });
}

void add_lens(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  begin_group(app, kCameraGroup);
  add_value(app, "--aperture", "D", "Diameter of the lens; 0 is a pinhole [the camera's own]",
            [&options](const auto& text) { options.aperture = parse_not_negative(text); });
  add_value(app, "--focus", "DEPTH",
            "Depth that is in focus [the camera's own, or the depth at the middle of the image]",
            [&options](const auto& text) { options.focus = parse_positive(text); });
}

void add_light(CLI::App& app, RenderCommand& command) {
  LightOptions& light = command.light;
  begin_group(app, kLightGroup);
  add_value(app, "--light-size", "R",
            "Radius of the spheres that point and spot lights shine from; 0 is a point [the "
            "scene's own]",
            [&light](const auto& text) { light.size = parse_not_negative(text); });
  CLI::Option* const environment =
      app.add_option(
             "--env", light.environment,
             "Environment that lights the scene: .hdr or .exr, equirectangular, its top at +y")
          ->type_name("FILE");
  add_value(app, "--env-intensity", "X", "Factor on the radiance of the environment [1]",
            [&light](const auto& text) { light.intensity = parse_not_negative(text); });
  add_value(app, "--env-rotation", "DEGREES",
            "Rotation of the environment about +y, counter-clockwise from above [0]",
            [&light](const auto& text) { light.rotation_degrees = parse_number(text); });
  add_value(app, "--sun", "X,Y,Z|LAT,LON,TIME",
            "Sun in a clear sky: the direction to it, or degrees north and east and a time, such "
            "as 48.1,11.6,2026-06-21T12:00Z; looking at the front of the model is looking north",
            [&light](const auto& text) { light.sun = parse_sun(text); })
      ->excludes(environment);
  app.get_option("--env-intensity")->needs(environment);
  app.get_option("--env-rotation")->needs(environment);
}

}  // namespace raysheaf::app
