// The value of a curve at a time (glTF 2.0, appendix C).
#pragma once

#include <span>

#include "raysheaf/rig.h"

namespace raysheaf {

/// Fills `value`, whose size is the number of numbers per key. `time` must be finite.
void sample_curve(const Curve& curve, double time, std::span<double> value);

/// The same for rotations: unit quaternions, interpolated along the shorter great arc.
[[nodiscard]] std::array<double, 4> sample_rotation(const Curve& curve, double time);

}  // namespace raysheaf
