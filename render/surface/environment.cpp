#include "render/surface/environment.h"

#include <cmath>
#include <numbers>

#include "exec/executor.h"

namespace raysheaf {
namespace {

/// The integral of a bilinear function over the cell around its middle value: 1/8, 6/8 and 1/8 of
/// the values along each axis.
double mean_luminance(const EnvironmentView& map, std::int64_t x, std::int64_t y) {
  constexpr double kPart[3] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (std::int64_t j = -1; j <= 1; ++j) {
    for (std::int64_t i = -1; i <= 1; ++i)
      sum += kPart[i + 1] * kPart[j + 1] *
             static_cast<double>(luminance(environment_texel(map, x + i, y + j)));
  }
  return sum;
}

/// Converts weights to a distribution function that ends at 1, with equal parts if all weights are
/// 0. Returns the sum of the weights.
double accumulate_ends(const std::vector<double>& weights, float* ends) {
  double sum = 0, total = 0;
  for (const double weight : weights) total += weight;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += total > 0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
    ends[i] = i + 1 == weights.size() ? 1 : static_cast<float>(std::fmin(sum, 1));
  }
  return total;
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Executor& executor, const Environment& environment) {
  view_.radiance = environment.radiance.data();
  view_.width = environment.width;
  view_.height = environment.height;
  view_.intensity = environment.intensity;
  view_.cos_rotation = std::cos(environment.rotation);
  view_.sin_rotation = std::sin(environment.rotation);
  if (environment.empty()) return;
  const std::size_t width = view_.width, height = view_.height;
  texel_ends_.resize(width * height);
  std::vector<double> rows(height);
  executor.for_each(height, 1, [&](std::size_t y) {
    std::vector<double> weights(width);
    for (std::size_t x = 0; x < width; ++x)
      weights[x] =
          mean_luminance(view_, static_cast<std::int64_t>(x), static_cast<std::int64_t>(y));
    const double top = std::numbers::pi * static_cast<double>(y) / static_cast<double>(height);
    const double end = std::numbers::pi * static_cast<double>(y + 1) / static_cast<double>(height);
    const double ring = std::cos(top) - std::cos(end);  // fraction of the sphere, times two
    rows[y] = ring * accumulate_ends(weights, &texel_ends_[y * width]);
  });
  row_ends_.resize(height);
  if (!(accumulate_ends(rows, row_ends_.data()) > 0)) return;  // black: no texel to choose
  view_.row_ends = row_ends_.data();
  view_.texel_ends = texel_ends_.data();
}

}  // namespace raysheaf
