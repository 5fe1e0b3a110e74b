// A mesh that an affine map places, met without placing its vertices.
//
//   world    o ---- s d ---->  P       P = transform_point(map, p), each operation rounded
//   mesh     B (o - b) -- s B d ---->  p    map = (A, b), B an inverse of A, the same s
//
// A triangle of an instance has the corners that `transform_point` computes from those of its mesh.
// Rays and boxes only find out which triangles need not be placed. With u = 2^-24 and H the largest
// coordinates of the mesh, on each axis:
//
//   placing    |P - (A p + b)| <= `placing_error` = 4.01 u |A| H + 1.01 u |b| + 2^-140: a product
//              passes one multiplication and at most three additions, b one addition, and products
//              that underflow lose 2^-150 each. By convexity this also holds for a point between
//              corners and the image of the point with the same weights.
//   boxes      of the mesh, by centre c and half size e: C = A c + b, E = |A| e in binary32, and a
//              pad of 20 u |A| H + 6 u |b| + 2^-120 on both sides: c and e are wrong by 1.01 u H
//              together, C by 4.01 u |A| H + u |b|, E by 3.01 u |A| H, P as above, the last sums by
//              u (2 |A| H + |b|) and 2 u of the pad.
//   rays       Let o + s d meet the placed triangle, so that o + s d = A p + b + e with |e| <=
//              `placing_error`. Then B (o - b) + s B d = p + (B A - I) p + B e in exact arithmetic:
//              at the same s, the ray passes p within `drift`, the largest coordinate of
//              |B A - I| H + |B| placing_error. In binary64 its points within the mesh's box lose
//              at most 11 * 2^-53 |B| (2 |o| + 2 |b| + |A| H), because s |d| = |A p + b + e - o|.
//              The bound that is used, 2^-46 |B| (|o| + |b| + |A| H), is 2^2.5 times that.
//   distances  Let s^2 be a third of the trace of A^T A, and n the largest sum of a row of |A^T A -
//              s^2 I|: then |A x| >= sqrt(s^2 - n) |x|. For p' = B (q - b) in binary64 and P in a
//              placed triangle, |P - q| >= |A (p - p')| - |A p' + b - q| - |placing_error|.
//              Cofactors of floats round once, so entries of B are wrong by 7 * 2^-53 of them where
//              n is small, p' by 4 * 2^-53 |B| |q - b| more, and |A p' + b - q| is at most 11 *
//              2^-53 |A| |B| (|q| + |b|) in Frobenius norms. So |p - p'| <= (|P - q| + `least_gap`
//              + `per_gap` |q|) / `stretch`, with per_gap = 2^-46 |A| |B|, and in least_gap 2^-16
//              of the placing's error besides: far more than 2^-48 of an edge, by which computed
//              distances are wrong (raysheaf/points.h).
//
// The part u |b| is large for an instance far from the origin of the world: binary32 moves its
// corners.
#pragma once

#include <cmath>

#include "base/float.h"
#include "base/host_device.h"
#include "base/vec.h"
#include "geom/rounding.h"

namespace raysheaf {

/// The transform of an instance, with the bounds that rays and points need to enter it.
struct Placing {
  Affine map;  ///< A and b, from the mesh's space to the world
  /// B, about the adjugate of A over its determinant, by columns; the last row is 0.
  double inverse[3][4];
  double drift;        ///< how far from a point of the mesh a ray passes that meets its image
  double per_origin;   ///< the further error of a ray's point: this times the largest |o|,
  double least_error;  ///< and this
  Vec3 box_pad;        ///< of boxes in the world
  /// Distances in the mesh are at most those in the world and `gap_of` together, over this. 0: they
  /// are not known to be, because the map is not nearly a rotation and a scale.
  double stretch;
  double least_gap, per_gap;  ///< of `gap_of`
  bool is_identity;  ///< then `transform_point` is not called: corners are those of the mesh
  /// Whether rays may enter. Maps that are singular, or that squeeze by more than about 1 : 10 000,
  /// lose too much.
  bool may_enter;
  bool has_boxes;  ///< `placed_box` does not overflow

  /// B x on an axis.
  [[nodiscard]] RAYSHEAF_HD double to_mesh(int axis, double x, double y, double z) const {
    return inverse[0][axis] * x + inverse[1][axis] * y + inverse[2][axis] * z;
  }
  /// The error of a ray in the mesh's space (`in_mesh`). `from`: the largest |o|.
  [[nodiscard]] RAYSHEAF_HD double ray_error(double from) const {
    return drift + per_origin * from + least_error;
  }
  /// The most that the distance of a point of the world may lack.
  [[nodiscard]] double gap_of(double length) const { return least_gap + per_gap * length; }
};

/// `placing_error` on an axis of the world, of a mesh whose largest coordinates are `most`.
[[nodiscard]] RAYSHEAF_HD inline double placing_error(const Affine& map, Vec3 most, int row) {
  constexpr double u = kUnitRoundoff;
  const auto& m = map.m[row];
  const auto part = [](float a, float h) { return std::fabs(static_cast<double>(a)) * h; };
  return 4.01 * u * (part(m[0], most.x) + part(m[1], most.y) + part(m[2], most.z)) +
         1.01 * u * part(m[3], 1) + 0x1p-140;
}

/// Sets what bounds distances.
RAYSHEAF_HD inline void bound_distances(const double (&a)[3][3], const double (&error)[3],
                                        Placing* placing) {
  double gram[3][3], of_map = 0, of_inverse = 0, least = 0, offset = 0;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      gram[r][c] = a[0][r] * a[0][c] + a[1][r] * a[1][c] + a[2][r] * a[2][c];
      of_inverse += placing->inverse[c][r] * placing->inverse[c][r];
    }
    of_map += gram[r][r];
    least += (1 + 0x1p-16) * error[r];
    offset += std::fabs(static_cast<double>(placing->map.m[r][3]));
  }
  const double square = of_map / 3;
  double off = 0;
  for (int r = 0; r < 3; ++r) {
    const double sum = std::fabs(gram[r][r] - square) + std::fabs(gram[r][(r + 1) % 3]) +
                       std::fabs(gram[r][(r + 2) % 3]);
    off = off > sum ? off : sum;
  }
  placing->per_gap = 0x1p-46 * std::sqrt(of_map * of_inverse);
  placing->least_gap = least + placing->per_gap * offset;
  const bool is_similar = off <= 0x1p-12 * square && square >= 0x1p-80 && square <= 0x1p80;
  placing->stretch = is_similar ? std::sqrt((1 - 0x1p-48) * square - off) : 0;
}

/// The placing of a mesh whose corners are in `bounds`, which is not empty.
[[nodiscard]] RAYSHEAF_HD inline Placing make_placing(const Affine& map, const Box& bounds) {
  constexpr double u = kUnitRoundoff;
  const auto greater = [](double a, double b) { return a > b ? a : b; };
  Placing placing;
  placing.map = map;
  placing.is_identity = true;
  double a[3][3], reach[3], from[3], error[3];  // reach: |A| H
  const Vec3 most = max(abs(bounds.min), abs(bounds.max));
  const double h[3] = {most.x, most.y, most.z};
  double pad[3];
  for (int r = 0; r < 3; ++r) {
    reach[r] = 0;
    for (int c = 0; c < 3; ++c) {
      a[r][c] = map.m[r][c];
      reach[r] += std::fabs(a[r][c]) * h[c];
      placing.is_identity = placing.is_identity && map.m[r][c] == (r == c ? 1.0f : 0.0f);
    }
    from[r] = std::fabs(static_cast<double>(map.m[r][3]));
    placing.is_identity = placing.is_identity && map.m[r][3] == 0;
    error[r] = placing_error(map, most, r);
    pad[r] = 20 * u * reach[r] + 6 * u * from[r] + 0x1p-120;
  }
  placing.box_pad = {rounded_up(pad[0]), rounded_up(pad[1]), rounded_up(pad[2])};

  double cofactor[3][3];
  const auto cross = [&](const double* x, const double* y, double* to) {
    to[0] = x[1] * y[2] - x[2] * y[1];
    to[1] = x[2] * y[0] - x[0] * y[2];
    to[2] = x[0] * y[1] - x[1] * y[0];
  };
  cross(a[1], a[2], cofactor[0]);
  cross(a[2], a[0], cofactor[1]);
  cross(a[0], a[1], cofactor[2]);
  const double per_det =
      1 / (a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2]);
  double norm = 0;  // of B: the largest sum of a row
  placing.drift = 0;
  for (int r = 0; r < 3; ++r) {
    double b[3];
    for (int c = 0; c < 3; ++c) b[c] = placing.inverse[c][r] = cofactor[c][r] * per_det;
    placing.inverse[r][3] = 0;
    const double size[3] = {std::fabs(b[0]), std::fabs(b[1]), std::fabs(b[2])};
    norm = greater(norm, size[0] + size[1] + size[2]);
    // The sum of the terms of B A on this row, times H, is |B| |A| H.
    double drift = 0x1p-50 * (h[r] + size[0] * reach[0] + size[1] * reach[1] + size[2] * reach[2]);
    for (int c = 0; c < 3; ++c) {
      const double one = b[0] * a[0][c] + b[1] * a[1][c] + b[2] * a[2][c] - (r == c ? 1 : 0);
      drift += std::fabs(one) * h[c] + size[c] * error[c];
    }
    placing.drift = greater(placing.drift, drift);
  }
  const double extent = greater(reach[0], greater(reach[1], reach[2]));
  const double offset = greater(from[0], greater(from[1], from[2]));
  placing.per_origin = 0x1p-46 * norm;
  placing.least_error = placing.per_origin * (offset + extent);
  const double size = greater(h[0], greater(h[1], h[2]));
  // NaN, from a determinant of 0, compares as false.
  placing.may_enter = placing.drift <= 0x1p-8 * size && placing.least_error <= 0x1p-8 * size &&
                      norm <= 0x1p60 && norm >= 0x1p-60;
  placing.has_boxes = greater(pad[0], greater(pad[1], pad[2])) <= 0x1p90;
  bound_distances(a, error, &placing);
  return placing;
}

/// A ray in binary64. A point of it may be `error` away from a point that an exact ray would pass.
struct LongRay {
  double origin[3], direction[3];
  double error;
};

/// The ray in the space of the mesh, at the same s: its points pass within `error` of every point
/// of the mesh whose image the given ray meets.
[[nodiscard]] RAYSHEAF_HD inline LongRay in_mesh(const Placing& placing, const Ray& ray) {
  const double o[3] = {static_cast<double>(ray.origin.x) - placing.map.m[0][3],
                       static_cast<double>(ray.origin.y) - placing.map.m[1][3],
                       static_cast<double>(ray.origin.z) - placing.map.m[2][3]};
  const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  LongRay r;
  for (int i = 0; i < 3; ++i) {
    r.origin[i] = placing.to_mesh(i, o[0], o[1], o[2]);
    r.direction[i] = placing.to_mesh(i, d[0], d[1], d[2]);
  }
  r.error = placing.ray_error(max_component(abs(ray.origin)));
  return r;
}

/// A box in the world that contains the placed part of the mesh that is in `box`.
[[nodiscard]] RAYSHEAF_HD inline Box placed_box(const Placing& placing, const Box& box) {
  const Vec3 c = (box.min + box.max) * 0.5f, e = (box.max - box.min) * 0.5f;
  const Vec3 at = transform_point(placing.map, c);
  const auto half = [&](int r) {
    const auto& m = placing.map.m[r];
    return std::fabs(m[0]) * e.x + std::fabs(m[1]) * e.y + std::fabs(m[2]) * e.z;
  };
  const Vec3 by = Vec3{half(0), half(1), half(2)} + placing.box_pad;
  return {at - by, at + by};
}

}  // namespace raysheaf
