// The minimum enclosing sphere of points.
#pragma once

#include "base/view.h"
#include "geom/sphere.h"

namespace raysheaf {

/// The smallest sphere that contains every point, empty for no points. Expected O(points): B.
/// Gärtner, "Fast and robust smallest enclosing balls", ESA 1999, in double, with its pivoting and
/// move to front.
///
/// The centre is rounded to float and the radius is measured from there and rounded up: every point
/// is inside in exact arithmetic, and the radius exceeds the minimum by at most the rounding of the
/// centre and about 1e-7 of itself. Points may be duplicate, collinear, coplanar or cospherical.
[[nodiscard]] Sphere miniball(View<const Vec3> points);

}  // namespace raysheaf
