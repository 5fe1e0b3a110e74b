#include "report/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace raysheaf::app {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kNothing = {16, 16, 20};

std::uint8_t byte(double part) {
  return static_cast<std::uint8_t>(std::clamp(part, 0.0, 1.0) * 255 + 0.5);
}

std::uint8_t srgb(double linear) {
  return byte(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

/// `color(i)` is the colour of pixel i, if a surface is visible there.
template <class Color>
Image painted(const RenderResult& result, const Color& color) {
  Image image;
  image.width = result.width;
  image.height = result.height;
  const std::size_t pixels = std::size_t{result.width} * result.height;
  image.rgba.resize(4 * pixels, 255);
  for (std::size_t i = 0; i < pixels; ++i) {
    const Rgb c = result.ids[i].prim_id == kInvalidId ? kNothing : color(i);
    std::copy(c.begin(), c.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  return image;
}

Image heat_map(const RenderResult& picture, const std::vector<float>& tests,
               const HeatScale& scale) {
  Image image = painted(picture, [&](std::size_t i) { return false_color(scale.at(tests[i])); });
  // Traced primary rays are tested even if they hit nothing.
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const Rgb c = tests[i] > 0 ? false_color(scale.at(tests[i])) : kNothing;
    std::copy(c.begin(), c.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  return image;
}

/// A colour for a number that differs from those of its neighbours: steps of the golden angle
/// around the hues, at three lightnesses.
Rgb color_of(std::uint32_t id) {
  const double turn = std::fmod(id * 0.61803398875 + 0.07, 1.0) * 6;
  const double value = id % 3 == 0 ? 0.95 : id % 3 == 1 ? 0.72 : 0.84, gray = 0.28;
  const auto channel = [&](double shift) {
    const double x = std::fabs(std::fmod(turn + shift, 6.0) - 3) - 1;
    return byte(value * (gray + (1 - gray) * std::clamp(x, 0.0, 1.0)));
  };
  return {channel(0), channel(4), channel(2)};
}

Image positions(const RenderResult& result, const Box& box) {
  const auto part = [](float value, float low, float high) {
    return byte(high > low ? (value - low) / (high - low) : 0.5);
  };
  return painted(result, [&](std::size_t i) -> Rgb {
    const Vec3& p = result.position[i];
    return {part(p.x, box.min.x, box.max.x), part(p.y, box.min.y, box.max.y),
            part(p.z, box.min.z, box.max.z)};
  });
}

Image normals(const RenderResult& result) {
  return painted(result, [&](std::size_t i) -> Rgb {
    const Vec3& n = result.normal[i];
    return {byte(0.5 + 0.5 * n.x), byte(0.5 + 0.5 * n.y), byte(0.5 + 0.5 * n.z)};
  });
}

Image reflectance(const RenderResult& result, bool specular) {
  return painted(result, [&](std::size_t i) -> Rgb {
    const Vec3& s = result.specular[i];
    const Vec3& a = result.albedo[i];
    if (specular) return {srgb(s.x), srgb(s.y), srgb(s.z)};
    return {srgb(a.x - s.x), srgb(a.y - s.y), srgb(a.z - s.z)};
  });
}

Image shadows(const RenderResult& result) {
  return painted(result, [&](std::size_t i) -> Rgb {
    const std::uint8_t gray = byte(0.08 + 0.92 * result.shadow[i]);
    return {gray, gray, gray};
  });
}

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void add_heat_maps(const Report& report, const HeatScale& scale, std::vector<Layer>* layers) {
  for (const MethodReport& method : report.methods) {
    if (!method.ran) continue;
    const std::string name = to_string(method.method);
    layers->push_back({"tests-" + name, "Tests per pixel, " + name,
                       "The number of tests that method " + name +
                           " made for the rays of each pixel: its shadow rays, its reflections and "
                           "refractions. The tests of a bundle are divided evenly among its rays. "
                           "Dark violet stands for few tests, light yellow for many.",
                       true, mean_of(method.tests), heat_map(report.picture, method.tests, scale)});
  }
}

}  // namespace

float HeatScale::at(double tests) const {
  if (!(tests > 0)) return 0;
  return static_cast<float>((std::log10(tests) - low_exponent) / (high_exponent - low_exponent));
}

HeatScale heat_scale(const Report& report) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const MethodReport& method : report.methods) {
    for (const float tests : method.tests) {
      if (!(tests > 0)) continue;
      least = std::min<double>(least, tests);
      most = std::max<double>(most, tests);
    }
  }
  if (!(most > 0)) return {};
  HeatScale scale;
  scale.low_exponent = std::max(0, static_cast<int>(std::floor(std::log10(least))));
  scale.high_exponent =
      std::max(scale.low_exponent + 1, static_cast<int>(std::ceil(std::log10(most))));
  return scale;
}

std::vector<Layer> make_layers(const Report& report, const HeatScale& scale,
                               const Box& scene_bounds) {
  const RenderResult& r = report.picture;
  std::vector<Layer> layers;
  layers.push_back({"beauty", "The image",
                    "The light that a camera would see, converted for the screen by exposure, a "
                    "tone curve and sRGB.",
                    false, 0, tone_mapped(r)});
  add_heat_maps(report, scale, &layers);
  layers.push_back({"shadow", "Arriving light",
                    "The part of the lights in front of each surface whose rays reach it: white "
                    "surfaces are lit by all lights, dark ones are in shadow.",
                    false, 0, shadows(r)});
  layers.push_back({"normal", "Shading normals",
                    "The direction that each surface faces. Red, green and blue are the x, y and z "
                    "of the direction; the middle of each colour is 0.",
                    false, 0, normals(r)});
  layers.push_back({"position", "Positions",
                    "The position of each surface. Red, green and blue grow along x, y and z, from "
                    "one end of the scene's box to the other.",
                    false, 0, positions(r, scene_bounds)});
  layers.push_back({"diffuse", "Diffuse reflectance",
                    "The part of the light that each surface scatters in all directions: its "
                    "colour in a grey room.",
                    false, 0, reflectance(r, false)});
  layers.push_back({"specular", "Specular reflectance",
                    "The part of the light that each surface mirrors at normal incidence. Most "
                    "materials mirror about 4 %, which is dark here; metals mirror far more.",
                    false, 0, reflectance(r, true)});
  layers.push_back({"instances", "Mesh instances", "Each instance of a mesh has its own colour.",
                    false, 0,
                    painted(r, [&](std::size_t i) { return color_of(r.ids[i].inst_id); })});
  layers.push_back({"triangles", "Triangles",
                    "Each triangle has a colour; neighbours in the file differ most. Parts that "
                    "look like noise have triangles that are smaller than pixels.",
                    false, 0,
                    painted(r, [&](std::size_t i) { return color_of(r.ids[i].prim_id); })});
  return layers;
}

}  // namespace raysheaf::app
