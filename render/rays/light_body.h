// Lights seen from fragments: KHR_lights_punctual, and spheres and rectangles that emit light.
//
// Lights with a size are sampled by the solid angle that they cover: a sample's irradiance is then
// the light's radiance times that angle, for every direction, and shadows converge fast.
#pragma once

#include <cmath>
#include <vector>

#include "base/float.h"
#include "base/trigonometry.h"
#include "base/vec.h"
#include "base/view.h"
#include "raysheaf/scene_description.h"
#include "render/rays/sample_body.h"

namespace raysheaf {

struct LightSample {
  Vec3 to_light;       ///< unit
  float distance = 0;  ///< infinite for directional lights
  Vec3 irradiance;     ///< on a surface that faces the light; black if the light does not reach the
                       ///< point
  Vec3 point;          ///< where the light is emitted; not used by directional lights
};

/// The cosine at the edge of a spot's cone, and its increase from there to full light.
struct SpotEdge {
  float cos_outer, span;
};
RAYSHEAF_HD inline SpotEdge spot_edge(const Light& light) {
  const float cos_outer = std::cos(light.outer_angle), cos_inner = std::cos(light.inner_angle);
  return {cos_outer, std::fmax(cos_inner - cos_outer, 1e-3f)};
}

/// A light prepared for many points, on any machine: cosines are computed once.
struct PlacedLight {
  Vec3 position, direction, right, intensity;
  float range = 0, cos_outer = 0, span = 1;
  float radius = 0, width = 0, height = 0;
  bool has_range = false, is_spot = false, is_directional = false, is_rectangle = false;
};

RAYSHEAF_HD inline PlacedLight placed_light(const Light& light) {
  PlacedLight placed;
  placed.position = light.position;
  placed.direction = light.direction;
  placed.right = light.right;
  placed.intensity = light.intensity;
  placed.range = light.range;
  placed.radius = light.radius;
  placed.width = light.width;
  placed.height = light.height;
  placed.has_range = std::isfinite(light.range);
  placed.is_spot = light.type == Light::Type::kSpot;
  placed.is_directional = light.type == Light::Type::kDirectional;
  placed.is_rectangle = light.type == Light::Type::kRectangle;
  const SpotEdge edge = spot_edge(light);
  placed.cos_outer = edge.cos_outer;
  placed.span = edge.span;
  return placed;
}

inline std::vector<PlacedLight> placed_lights(View<const Light> lights) {
  std::vector<PlacedLight> placed;
  placed.reserve(lights.size);
  for (const Light& light : lights) placed.push_back(placed_light(light));
  return placed;
}

/// The fraction of a light's intensity that its range and its cone leave (the extension's
/// recommendation).
RAYSHEAF_HD inline float light_window(const PlacedLight& light, Vec3 from_light, float distance) {
  float window = 1;
  if (light.has_range) {
    const float ratio = distance / light.range;
    window = clamp(1 - ratio * ratio * ratio * ratio, 0, 1);
  }
  if (light.is_spot) {
    const float inside =
        clamp((dot(light.direction, from_light) - light.cos_outer) / light.span, 0, 1);
    window *= inside * inside;
  }
  return window;
}

/// Whether there is a choice of points on the light.
RAYSHEAF_HD inline bool has_size(const PlacedLight& light) {
  return light.is_rectangle || (!light.is_directional && light.radius > 0);
}

/// A point slightly off the light's surface along its `normal`, so that geometry in that surface
/// does not shade it: 64 roundings of the coordinates and the distance.
RAYSHEAF_HD inline Vec3 off_light(Vec3 point, Vec3 normal, float distance) {
  const float size = max_component(abs(point)) + distance;
  return point + normal * (64 * kUnitRoundoff * size);
}

/// Two unit vectors orthogonal to `n` and to each other (T. Duff et al., "Building an Orthonormal
/// Basis, Revisited", JCGT 6(1), 2017).
struct Tangents {
  Vec3 s, t;
};
RAYSHEAF_HD inline Tangents tangents(Vec3 n) {
  const float sign = n.z < 0 ? -1.0f : 1.0f;
  const float a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

/// A sphere of radius r at distance d covers a cone with sin(half angle) = r / d, in which
/// directions are chosen uniformly (pbrt-v4, section 6.2.4). Radiance I / (pi r^2) times the solid
/// angle 2 pi (1 - cos) is 2 I / (d^2 (1 + cos)), which approaches a point's I / d^2 as r goes to
/// 0. Black inside.
RAYSHEAF_HD inline LightSample sample_ball(const PlacedLight& light, Vec3 position, Vec2 chosen) {
  const Vec3 to_center = light.position - position;
  const float distance = length(to_center), radius = light.radius;
  const Vec3 axis = normalized(to_center);
  if (!(distance > radius)) return {axis, distance, {0, 0, 0}, light.position};
  const float sine = radius / distance;
  const float cosine = std::sqrt(clamp(1 - sine * sine, 0, 1));
  const float away = chosen.x * (sine * sine / (1 + cosine));  // 1 - cos of the chosen direction
  const float aside = std::sqrt(away * (2 - away));
  const Vec2 around = on_circle(chosen.y);
  const Tangents side = tangents(axis);
  const Vec3 to_light =
      normalized(axis * (1 - away) + side.s * (aside * around.x) + side.t * (aside * around.y));
  // The nearer of the two points where the direction intersects the sphere.
  const float middle = dot(to_center, to_light);
  const Vec3 across = to_center - to_light * middle;
  const float half_chord = std::sqrt(std::fmax(radius * radius - dot(across, across), 0.0f));
  const float away_from_light = std::fmax(middle - half_chord, 0.0f);
  const Vec3 on_ball = position + to_light * away_from_light;
  const Vec3 normal = normalized(on_ball - light.position, -to_light);
  const float falloff = light_window(light, -to_light, away_from_light) / distance / distance;
  return {to_light, away_from_light, light.intensity * (2 * falloff / (1 + cosine)),
          off_light(on_ball, normal, distance)};
}

/// A rectangle seen from a point, in a frame whose z axis points away from it: corners at x0 or x1,
/// y0 or y1, and z < 0.
struct SeenRectangle {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0, z = 0;
};

/// A point on a rectangle, chosen so that directions to it are uniform over the solid angle that
/// the rectangle covers.
struct RectanglePlace {
  double x = 0, y = 0;
  double solid_angle = 0;  ///< of the whole rectangle
};

/// C. Urena, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles",
/// EGSR 2013, sections 3 and 4. In binary64, because the angles' sum cancels.
RAYSHEAF_HD inline RectanglePlace place_by_solid_angle(const SeenRectangle& r, Vec2 chosen) {
  // z components of the unit normals of the four planes through the eye and an edge; the other
  // nonzero component is x or y.
  const double zz = r.z * r.z;
  const double below = -r.y0 / std::sqrt(zz + r.y0 * r.y0);
  const double right = r.x1 / std::sqrt(zz + r.x1 * r.x1);
  const double above = r.y1 / std::sqrt(zz + r.y1 * r.y1);
  const double left = -r.x0 / std::sqrt(zz + r.x0 * r.x0);
  // Normals of adjacent planes share only the z axis: the inner angles between the planes.
  const double angle_br = portable::arc_cosine(-below * right),
               angle_ra = portable::arc_cosine(-right * above);
  const double angle_al = portable::arc_cosine(-above * left),
               angle_lb = portable::arc_cosine(-left * below);
  const double rest = 2 * portable::kPi - angle_al - angle_lb;
  RectanglePlace place;
  place.solid_angle = angle_br + angle_ra - rest;
  // The column up to which the chosen part of the solid angle extends.
  const double part = static_cast<double>(chosen.x) * place.solid_angle + rest;
  const portable::SineCosine turn = portable::sine_cosine(part);
  const double f = (turn.cosine * below - above) / turn.sine;
  const double size = std::sqrt(f * f + below * below);
  double c = size > 0 ? (f > 0 ? 1 : -1) / size : 0;
  c = c < -1 ? -1 : c > 1 ? 1 : c;
  place.x = -c * r.z / std::sqrt(std::fmax(1 - c * c, 1e-300));
  place.x = place.x < r.x0 ? r.x0 : place.x > r.x1 ? r.x1 : place.x;
  // Along the column, heights on the unit sphere are uniform (Archimedes).
  const double d2 = place.x * place.x + zz;
  const double h0 = r.y0 / std::sqrt(d2 + r.y0 * r.y0), h1 = r.y1 / std::sqrt(d2 + r.y1 * r.y1);
  const double h = h0 + static_cast<double>(chosen.y) * (h1 - h0);
  place.y = h * h < 1 - 1e-15 ? h * std::sqrt(d2) / std::sqrt(1 - h * h) : r.y1;
  place.y = place.y < r.y0 ? r.y0 : place.y > r.y1 ? r.y1 : place.y;
  return place;
}

/// Emits to one side, with radiance intensity / area. If it covers a tiny part of the view, points
/// are chosen uniformly over its area instead, which is equally good then: the solid angle would be
/// lost in the rounding of its four angles.
RAYSHEAF_HD inline LightSample sample_rectangle(const PlacedLight& light, Vec3 position,
                                                Vec2 chosen) {
  constexpr double kLeastSolidAngle = 1e-6;
  const Vec3 to_center = light.position - position;
  const Vec3 up = cross(light.right, light.direction);
  LightSample sample{normalized(to_center), length(to_center), {0, 0, 0}, light.position};
  const double front = static_cast<double>(dot(to_center, light.direction));
  if (!(front < 0)) return sample;  // behind it, or in its plane
  const double x = dot(to_center, light.right), y = dot(to_center, up);
  const double half_width = 0.5 * light.width, half_height = 0.5 * light.height;
  const SeenRectangle seen{x - half_width, y - half_height, x + half_width, y + half_height, front};
  const RectanglePlace place = place_by_solid_angle(seen, chosen);
  const bool tiny = !(place.solid_angle > kLeastSolidAngle);
  const float along =
      static_cast<float>(tiny ? (static_cast<double>(chosen.x) - 0.5) * light.width : place.x - x);
  const float across =
      static_cast<float>(tiny ? (static_cast<double>(chosen.y) - 0.5) * light.height : place.y - y);
  const Vec3 point = light.position + light.right * along + up * across;
  const Vec3 to_point = point - position;
  sample.distance = length(to_point);
  sample.to_light = normalized(to_point);
  sample.point = off_light(point, light.direction, sample.distance);
  const float cosine = -dot(sample.to_light, light.direction);
  if (!(cosine > 0)) return sample;
  const float area = light.width * light.height;
  const float seen_part = tiny ? cosine / sample.distance / sample.distance
                               : static_cast<float>(place.solid_angle) / area;
  const float window = light_window(light, -sample.to_light, sample.distance);
  sample.irradiance = light.intensity * (window * seen_part);
  return sample;
}

/// As if it emitted only from its position; directional lights have none.
RAYSHEAF_HD inline LightSample sample_point(const PlacedLight& light, Vec3 position) {
  if (light.is_directional)
    return {-light.direction, std::numeric_limits<float>::infinity(), light.intensity, {0, 0, 0}};
  const Vec3 to_light = light.position - position;
  const float distance = length(to_light);
  const Vec3 unit = normalized(to_light);
  if (!(distance > 0)) return {unit, 0, {0, 0, 0}, light.position};
  const float falloff = light_window(light, -unit, distance) / distance / distance;
  return {unit, distance, light.intensity * falloff, light.position};
}

/// `chosen`: the choice of a point on the light, both in [0, 1); lights without a size ignore it.
RAYSHEAF_HD inline LightSample sample_light(const PlacedLight& light, Vec3 position,
                                            Vec2 chosen = {0.5f, 0.5f}) {
  if (light.is_rectangle) return sample_rectangle(light, position, chosen);
  if (has_size(light)) return sample_ball(light, position, chosen);
  return sample_point(light, position);
}

}  // namespace raysheaf
