#include "io/float_spacing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace raysheaf::io {
namespace {

std::string written(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

void warn_of_spacing(const Box& box, SceneDescription* scene) {
  constexpr double kFinest = 1000;  // float32 steps along the longest side
  const double sides[] = {double{box.max.x} - box.min.x, double{box.max.y} - box.min.y,
                          double{box.max.z} - box.min.z};
  const double side = *std::max_element(std::begin(sides), std::end(sides));
  const float farthest =
      std::max({std::fabs(box.min.x), std::fabs(box.min.y), std::fabs(box.min.z),
                std::fabs(box.max.x), std::fabs(box.max.y), std::fabs(box.max.z)});
  if (!(side >= 0 && std::isfinite(farthest))) return;
  const double spacing = double{std::nextafter(farthest, INFINITY)} - farthest;
  if (!(spacing * kFinest > side)) return;
  scene->warnings.push_back(
      "The scene is " + written(side) + " wide, but lies up to " + written(farthest) +
      " away from the origin, where coordinates in float32 are " + written(spacing) +
      " apart: shapes are rough. Move the meshes nearer to the origin before they are written.");
}

}  // namespace raysheaf::io
