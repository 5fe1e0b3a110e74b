// The one ray-triangle test. Every method and device uses these operations in this order.
//
// S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. Vertices
// are moved to the ray's origin and sheared so that the ray runs along +z; the origin of the plane
// is inside the triangle where the three edge functions agree in sign:
//
//        C            U = C x B    V = A x C    W = B x A        (z of the cross products)
//       / \           .
//      / o \          U, V, W >= 0: seen from the front; all <= 0: from the back
//     A --- B
//
// Watertight: an edge shared by two triangles has the same two sheared end points in both, and each
// edge function is a difference of two rounded products. Rounding is monotonic, so its sign is
// right or it is zero; where one is zero (or the determinant left the normal range), all three are
// done again in binary64, where products of two binary32 numbers are exact and the sign of their
// difference is therefore exact. So the signs are those of exact arithmetic on the sheared
// vertices, edges belong to both their triangles, and no ray passes between two triangles that
// share an edge or a vertex.
//
// Where on the line the hit is, the bounds of ray bundles rely on (geom/ray_end.h). t is a mean of
// the corners' depths with the edge functions as weights. Those are rounded, and where the triangle
// is seen edge-on they are small differences of large products: the mean is then one of other
// weights, at any depth that the triangle has. So all is done again in binary64 where the products'
// magnitudes sum to more than kLargestSpread determinants. Where not, the weights' errors move the
// mean by at most (kLargestSpread + 1) u times the range of depths, that is gamma(18) L, with L the
// largest coordinate of a corner as seen from the origin; evaluating it errs by gamma(10) L.
//
// Nothing is contracted into fused operations (docs/decisions/0001-no-contraction.md).
#pragma once

#include <cmath>

#include "base/host_device.h"
#include "base/vec.h"

namespace raysheaf {

/// What a ray brings to every test: the axis it mostly runs along (z), the other two in the order
/// that keeps the winding, and the shear.
struct RaySetup {
  Vec3 origin;
  float shear_x, shear_y, shear_z;
  float t_min, t_max;
  int axis_x, axis_y, axis_z;
};

struct TriangleHit {
  float t, u, v;
  bool front;  ///< met from the side where the corners run counter-clockwise
};

/// Determinants beyond these, and distances times determinants, are computed again in binary64:
/// products lost bits to underflow or became infinite. 2^-60 leaves three products of magnitudes
/// down to 2^-126 their full precision.
inline constexpr float kSmallDeterminant = 0x1p-60f;
inline constexpr float kSmallDistance = 0x1p-100f;  ///< times the determinant
inline constexpr float kLargeDeterminant = 0x1p120f;
/// Triangles seen at up to 80 degrees or so are below.
inline constexpr float kLargestSpread = 8;

RAYSHEAF_HD inline RaySetup make_ray_setup(const Ray& ray) {
  const Vec3 d = ray.direction, m = abs(d);
  const int z = m.x > m.y ? (m.x > m.z ? 0 : 2) : (m.y > m.z ? 1 : 2);
  int x = z == 2 ? 0 : z + 1;
  int y = x == 2 ? 0 : x + 1;
  const float along = component(d, z);
  if (along < 0) {
    const int other = x;
    x = y;
    y = other;
  }
  return {ray.origin,
          component(d, x) / along,
          component(d, y) / along,
          1.0f / along,
          ray.t_min,
          ray.t_max,
          x,
          y,
          z};
}

/// The sheared corners and what follows from them; also the fallback of the SIMD kernels, which
/// call it for the lanes whose edge functions do not settle the matter in binary32.
struct ShearedTriangle {
  float ax, ay, az, bx, by, bz, cx, cy, cz;  ///< z not yet scaled by shear_z
};

RAYSHEAF_HD inline ShearedTriangle shear(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 oa = a - ray.origin, ob = b - ray.origin, oc = c - ray.origin;
  ShearedTriangle s;
  s.az = component(oa, ray.axis_z);
  s.bz = component(ob, ray.axis_z);
  s.cz = component(oc, ray.axis_z);
  s.ax = component(oa, ray.axis_x) - ray.shear_x * s.az;
  s.ay = component(oa, ray.axis_y) - ray.shear_y * s.az;
  s.bx = component(ob, ray.axis_x) - ray.shear_x * s.bz;
  s.by = component(ob, ray.axis_y) - ray.shear_y * s.bz;
  s.cx = component(oc, ray.axis_x) - ray.shear_x * s.cz;
  s.cy = component(oc, ray.axis_y) - ray.shear_y * s.cz;
  return s;
}

/// The test in binary64, from the same sheared corners.
RAYSHEAF_HD inline bool intersect_exactly(const RaySetup& ray, const ShearedTriangle& s,
                                          TriangleHit* hit) {
  const double ax = s.ax, ay = s.ay, bx = s.bx, by = s.by, cx = s.cx, cy = s.cy;
  const double u = cx * by - cy * bx;
  const double v = ax * cy - ay * cx;
  const double w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double det = u + v + w;
  if (!(det != 0)) return false;
  const double scale = ray.shear_z;
  const double distance = u * (scale * s.az) + v * (scale * s.bz) + w * (scale * s.cz);
  const float t = static_cast<float>(distance / det);
  if (!(t >= ray.t_min && t <= ray.t_max)) return false;
  *hit = {t, static_cast<float>(v / det), static_cast<float>(w / det), det > 0};
  return true;
}

/// Whether the ray meets the triangle with `t` in [t_min, t_max]. Zero-area triangles and NaNs are
/// never met.
RAYSHEAF_HD inline bool intersect_triangle(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c,
                                           TriangleHit* hit) {
  const ShearedTriangle s = shear(ray, a, b, c);
  const float u = s.cx * s.by - s.cy * s.bx;
  const float v = s.ax * s.cy - s.ay * s.cx;
  const float w = s.bx * s.ay - s.by * s.ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const float det = u + v + w;
  const float size = std::fabs(det);
  const float spread = (std::fabs(s.cx * s.by) + std::fabs(s.cy * s.bx)) +
                       (std::fabs(s.ax * s.cy) + std::fabs(s.ay * s.cx)) +
                       (std::fabs(s.bx * s.ay) + std::fabs(s.by * s.ax));
  const float distance =
      u * (ray.shear_z * s.az) + v * (ray.shear_z * s.bz) + w * (ray.shear_z * s.cz);
  const bool settled = u != 0 && v != 0 && w != 0 && size >= kSmallDeterminant &&
                       size <= kLargeDeterminant && spread <= kLargestSpread * size &&
                       std::fabs(distance) >= kSmallDistance &&
                       std::fabs(distance) <= kLargeDeterminant;
  if (!settled) return intersect_exactly(ray, s, hit);
  const float t = distance / det;
  if (!(t >= ray.t_min && t <= ray.t_max)) return false;
  *hit = {t, v / det, w / det, det > 0};
  return true;
}

/// The weights of the second and third corner where the ray meets the triangle's plane, kept inside
/// the triangle: at silhouettes OpenGL's pixel may lie a hair outside.
RAYSHEAF_HD inline Vec2 clamped_barycentrics(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  TriangleHit hit;
  if (intersect_triangle(make_ray_setup(ray), a, b, c, &hit)) return {hit.u, hit.v};
  const Vec3 ab = b - a, ac = c - a, from = ray.origin - a;
  const Vec3 p = cross(ray.direction, ac), q = cross(from, ab);
  const float det = dot(ab, p);
  if (!(det != 0)) return {1.0f / 3, 1.0f / 3};
  const float u = clamp(dot(from, p) / det, 0, 1), v = clamp(dot(ray.direction, q) / det, 0, 1);
  const float sum = u + v;
  return sum > 1 ? Vec2{u / sum, v / sum} : Vec2{u, v};
}

}  // namespace raysheaf
