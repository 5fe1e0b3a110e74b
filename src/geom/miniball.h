// The minimum enclosing ball of points.
#pragma once

#include "base/view.h"
#include "geom/sphere.h"

namespace raysheaf {

/// The least ball that holds every point, empty where there is none. Expected O(points): B.
/// Gärtner, "Fast and robust smallest enclosing balls", ESA 1999, in double, with its pivoting and
/// move to front.
///
/// The centre is rounded to float and the radius measured from there, upwards: every point is
/// inside in exact arithmetic, and the radius exceeds the least one by no more than the rounding of
/// the centre and about 1e-7 of itself. Duplicate, collinear, coplanar and cospherical points are
/// welcome.
[[nodiscard]] Sphere miniball(View<const Vec3> points);

}  // namespace raysheaf
