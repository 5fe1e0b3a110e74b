// The bounding sphere of a mesh that changes its shape, and those of all meshes as their instances
// stand, without reading the vertices.
#pragma once

#include <cmath>

#include "base/float.h"
#include "geom/rounding.h"
#include "geom/sphere.h"

namespace raysheaf {

RAYSHEAF_HD inline double squared_distance_in_double(Vec3 a, Vec3 b) {
  const double x = static_cast<double>(a.x) - b.x, y = static_cast<double>(a.y) - b.y;
  const double z = static_cast<double>(a.z) - b.z;
  return x * x + y * y + z * z;
}

// A mesh that changes its shape has a sphere around the middle of the box of its vertices, as far
// as the farthest of them: least and largest numbers are the same in any order, so that every
// machine finds the same sphere. Its radius exceeds that of the minimum enclosing sphere by at most
// the distance of the centres.

/// No coordinate is -0, which a box may have or not. The sum of two halves does not overflow.
RAYSHEAF_HD inline Vec3 shape_center(const Box& vertices) {
  return vertices.min * 0.5f + vertices.max * 0.5f + Vec3{0, 0, 0};
}
/// `squared`: the largest `squared_distance_in_double` of a vertex from the centre, with an error
/// of at most 2^-50.
RAYSHEAF_HD inline Sphere shape_sphere(Vec3 center, double squared) {
  return {center, rounded_up(std::sqrt(squared) * (1 + 0x1p-50))};
}

/// An upper bound of the largest singular value of the linear part: the factor by which the map
/// stretches lengths at most. Jacobi rotations nearly diagonalise the Gram matrix; Gershgorin's
/// discs then contain its eigenvalues, however far the rotations have converged. Their rounding
/// errors are a few dozen units of 2^-53 of the trace, which is at most three times the largest
/// eigenvalue: 1e-12 covers them.
RAYSHEAF_HD inline double largest_stretch(const Affine& map) {
  double g[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      g[i][j] = 0;
      for (int r = 0; r < 3; ++r) g[i][j] += static_cast<double>(map.m[r][i]) * map.m[r][j];
    }
  }
  constexpr int kSweeps = 5;
  for (int step = 0; step < 3 * kSweeps; ++step) {
    const int p = step % 3, q = (p + 1) % 3, other = (p + 2) % 3;
    if (g[p][q] == 0) continue;
    // The rotation in the plane (p, q) that makes g[p][q] zero (Golub & Van Loan 2013,
    // section 8.5.2).
    const double tau = (g[q][q] - g[p][p]) / (2 * g[p][q]);
    const double t = (tau >= 0 ? 1 : -1) / (std::fabs(tau) + std::sqrt(1 + tau * tau));
    const double c = 1 / std::sqrt(1 + t * t), s = t * c;
    g[p][p] -= t * g[p][q];
    g[q][q] += t * g[p][q];
    g[p][q] = g[q][p] = 0;
    const double with_p = g[p][other], with_q = g[q][other];
    g[p][other] = g[other][p] = c * with_p - s * with_q;
    g[q][other] = g[other][q] = s * with_p + c * with_q;
  }
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    const double disc = g[i][i] + std::fabs(g[i][(i + 1) % 3]) + std::fabs(g[i][(i + 2) % 3]);
    largest = disc > largest ? disc : largest;
  }
  return std::sqrt(largest) * (1 + 1e-12);
}

/// A sphere that contains `transform_point(map, p)`, as rounded to float, for every p in `sphere`.
///
/// Without rounding, the image of the sphere lies in the sphere around M c of radius sigma r, where
/// sigma is the largest stretch. Rounding adds two errors on each axis i:
///   - the centre is rounded: its distance to M c is known to 2^-51 in double;
///   - the vertex is rounded: a sum of three products and a fourth term errs by at most
///     gamma(4) (sum_j |m_ij| |p_j| + |m_i3|), where |p_j| <= |c_j| + r, and by 2^-150 for each
///     product that underflows. gamma(5) leaves 2^-24 of that sum for the errors of double here.
/// The radius grows by the length of that vector of errors.
RAYSHEAF_HD inline Sphere transformed(const Sphere& sphere, const Affine& map) {
  if (sphere.radius < 0) return sphere;
  constexpr double kUnderflow = 0x1p-147;
  const double c[3] = {sphere.center.x, sphere.center.y, sphere.center.z}, radius = sphere.radius;
  float center[3];
  double error_squared = 0;
  for (int r = 0; r < 3; ++r) {
    double exact = map.m[r][3], reach = std::fabs(exact);
    for (int j = 0; j < 3; ++j) {
      exact += static_cast<double>(map.m[r][j]) * c[j];
      reach += std::fabs(static_cast<double>(map.m[r][j])) * (std::fabs(c[j]) + radius);
    }
    center[r] = rounded(exact);
    const double error = std::fabs(center[r] - exact) + gamma(5) * reach + kUnderflow;
    error_squared += error * error;
  }
  const double grown = radius * largest_stretch(map) + std::sqrt(error_squared);
  return {{center[0], center[1], center[2]}, rounded_up(grown * (1 + 1e-12))};
}

}  // namespace raysheaf
