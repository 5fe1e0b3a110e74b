// The value of a curve at a time (glTF 2.0, appendix C).
#pragma once

#include <span>

#include "raysheaf/rig.h"

namespace raysheaf {

/// Fills `value`, whose size is what the curve's keys have numbers. `time` is finite.
void sample_curve(const Curve& curve, double time, std::span<double> value);

/// The same for rotations: quaternions, between two keys along the shorter great arc, of unit
/// length.
[[nodiscard]] std::array<double, 4> sample_rotation(const Curve& curve, double time);

}  // namespace raysheaf
