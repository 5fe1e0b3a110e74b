// Four floats at once: three coordinates and an unused lane, or one coordinate of four points. SSE2
// is part of every x86-64, so this needs no dispatch; on other machines these are plain loops,
// which compilers vectorize.
#pragma once

#include <limits>

#include "raysheaf/types.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace raysheaf {

struct Float4 {
#if defined(__SSE2__)
  __m128 v;
#else
  float v[4];
#endif
};

#if defined(__SSE2__)

inline Float4 load4(const float* p) {
  return {_mm_loadu_ps(p)};
}
inline void store4(Float4 a, float* p) {
  _mm_storeu_ps(p, a.v);
}
inline Float4 all4(float x) {
  return {_mm_set1_ps(x)};
}
inline Float4 operator+(Float4 a, Float4 b) {
  return {_mm_add_ps(a.v, b.v)};
}
inline Float4 operator-(Float4 a, Float4 b) {
  return {_mm_sub_ps(a.v, b.v)};
}
inline Float4 operator*(Float4 a, Float4 b) {
  return {_mm_mul_ps(a.v, b.v)};
}
inline Float4 abs(Float4 a) {
  return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)};
}
/// Bit i: whether a[i] > b[i].
inline unsigned greater_lanes(Float4 a, Float4 b) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmpgt_ps(a.v, b.v)));
}
/// a[i] where low <= of[i] <= high, infinity elsewhere.
inline Float4 where_within(Float4 of, float low, float high, Float4 a) {
  const __m128 within =
      _mm_and_ps(_mm_cmpge_ps(of.v, _mm_set1_ps(low)), _mm_cmple_ps(of.v, _mm_set1_ps(high)));
  const __m128 infinity = _mm_set1_ps(std::numeric_limits<float>::infinity());
  return {_mm_or_ps(_mm_and_ps(within, a.v), _mm_andnot_ps(within, infinity))};
}
/// (y, z, x, w).
inline Float4 yzx(Float4 a) {
  return {_mm_shuffle_ps(a.v, a.v, _MM_SHUFFLE(3, 0, 2, 1))};
}
/// x + (y + z).
inline float sum3(Float4 a) {
  const __m128 y = _mm_shuffle_ps(a.v, a.v, 1), z = _mm_movehl_ps(a.v, a.v);
  return _mm_cvtss_f32(_mm_add_ss(a.v, _mm_add_ss(y, z)));
}
/// (x + z) + (y + w).
inline float sum4(Float4 a) {
  const __m128 two = _mm_add_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}
inline Float4 min(Float4 a, Float4 b) {
  return {_mm_min_ps(a.v, b.v)};
}
inline Float4 max(Float4 a, Float4 b) {
  return {_mm_max_ps(a.v, b.v)};
}

/// The fourth lane is 0; reads only the three floats.
inline Float4 load3(const Vec3& p) {
  const __m128 xy = _mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(&p.x));
  return {_mm_movelh_ps(xy, _mm_load_ss(&p.z))};
}

/// Stores the columns x, y, z of four points.
inline void store_columns(Float4 a, Float4 b, Float4 c, Float4 d, float (*out)[4]) {
  const __m128 ab = _mm_unpacklo_ps(a.v, b.v), cd = _mm_unpacklo_ps(c.v, d.v);
  const __m128 ab_z = _mm_unpackhi_ps(a.v, b.v), cd_z = _mm_unpackhi_ps(c.v, d.v);
  _mm_store_ps(out[0], _mm_movelh_ps(ab, cd));
  _mm_store_ps(out[1], _mm_movehl_ps(cd, ab));
  _mm_store_ps(out[2], _mm_movelh_ps(ab_z, cd_z));
}

inline float lowest(Float4 a) {
  const __m128 two = _mm_min_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
}
inline float highest(Float4 a) {
  const __m128 two = _mm_max_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps(two, two, 1)));
}

#else

inline Float4 load4(const float* p) {
  return {{p[0], p[1], p[2], p[3]}};
}
inline void store4(Float4 a, float* p) {
  for (int i = 0; i < 4; ++i) p[i] = a.v[i];
}
inline Float4 all4(float x) {
  return {{x, x, x, x}};
}
inline Float4 operator+(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] += b.v[i];
  return a;
}
inline Float4 operator-(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] -= b.v[i];
  return a;
}
inline Float4 operator*(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] *= b.v[i];
  return a;
}
inline Float4 abs(Float4 a) {
  for (int i = 0; i < 4; ++i) a.v[i] = a.v[i] < 0 ? -a.v[i] : a.v[i];
  return a;
}
inline unsigned greater_lanes(Float4 a, Float4 b) {
  unsigned lanes = 0;
  for (int i = 0; i < 4; ++i) lanes |= a.v[i] > b.v[i] ? 1u << i : 0u;
  return lanes;
}
inline Float4 where_within(Float4 of, float low, float high, Float4 a) {
  for (int i = 0; i < 4; ++i)
    if (!(of.v[i] >= low && of.v[i] <= high)) a.v[i] = std::numeric_limits<float>::infinity();
  return a;
}
inline Float4 yzx(Float4 a) {
  return {{a.v[1], a.v[2], a.v[0], a.v[3]}};
}
inline float sum3(Float4 a) {
  return a.v[0] + (a.v[1] + a.v[2]);
}
inline float sum4(Float4 a) {
  return (a.v[0] + a.v[2]) + (a.v[1] + a.v[3]);
}
inline Float4 min(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] = a.v[i] < b.v[i] ? a.v[i] : b.v[i];
  return a;
}
inline Float4 max(Float4 a, Float4 b) {
  for (int i = 0; i < 4; ++i) a.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i];
  return a;
}
inline Float4 load3(const Vec3& p) {
  return {{p.x, p.y, p.z, 0}};
}
inline void store_columns(Float4 a, Float4 b, Float4 c, Float4 d, float (*out)[4]) {
  for (int axis = 0; axis < 3; ++axis) {
    out[axis][0] = a.v[axis], out[axis][1] = b.v[axis];
    out[axis][2] = c.v[axis], out[axis][3] = d.v[axis];
  }
}
inline float lowest(Float4 a) {
  const float x = a.v[0] < a.v[2] ? a.v[0] : a.v[2], y = a.v[1] < a.v[3] ? a.v[1] : a.v[3];
  return x < y ? x : y;
}
inline float highest(Float4 a) {
  const float x = a.v[0] > a.v[2] ? a.v[0] : a.v[2], y = a.v[1] > a.v[3] ? a.v[1] : a.v[3];
  return x > y ? x : y;
}

#endif

}  // namespace raysheaf
