// The pixels' reconstruction filter.
//
// A Gaussian with a standard deviation of half a pixel, cut off at one and a half pixels: wide
// enough to avoid stairs at edges, narrow enough to keep them sharp. The samples are distributed in
// proportion to the filter and have equal weights, so that no sample belongs to more than one pixel
// (M. Ernst, M. Stamminger, G. Greiner, "Filter Importance Sampling", IEEE Symposium on Interactive
// Ray Tracing 2006; pbrt-v4, section 8.8).
#pragma once

#include <cmath>

#include "render/rays/sample_body.h"

namespace raysheaf {

inline constexpr float kFilterDeviation = 0.5f, kFilterRadius = 1.5f;  ///< pixels

/// The offset of a sample from the centre of every pixel, in pixels, x to the right and y down. It
/// is the same for all pixels, so that a rasterized image is one projection. The first sample is in
/// the centre.
inline Vec2 filter_offset(SampleOf sample) {
  const std::uint32_t seed = choice_seed(Choice::kPixel, 0, 0, 0);
  const FractionPair first = scrambled_sobol(0, seed), bits = scrambled_sobol(sample.index, seed);
  // Shifted digit by digit, so that the first is 0 and the sequence keeps its strata.
  const float u = unit_fraction(bits.x ^ first.x), v = unit_fraction(bits.y ^ first.y);
  // The inverse of the fraction of a two-dimensional Gaussian that is inside a circle.
  const float cut = kFilterRadius / kFilterDeviation;
  const float inside = 1 - std::exp(-0.5f * cut * cut);
  const float radius = kFilterDeviation * std::sqrt(-2 * std::log(1 - u * inside));
  const float angle = 6.28318531f * v;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace raysheaf
