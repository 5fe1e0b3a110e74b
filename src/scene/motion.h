// Transforms of an instance, or positions of vertices, at equal distances of time: numbers are
// mixed between two of them.
//
// A corner under mixed entries is, without rounding, the corners under the two transforms mixed by
// the same weights: it moves along a straight line. So what contains it at two times contains it in
// between, if there is no transform between the two, up to what is rounded. An entry of `affine_at`
// is wrong by u = 2^-24 of itself, by 2^-51 (|a| + |b|) before that, and by 2^-150 where it
// underflows. On each axis of the world, with |A| H as in scene/placing.h and the largest entries
// of all transforms in place of those of one, that moves a corner by
//
//   u (|A| H + |b|), of the transform at that time, and `mixing_error` = 2^-48 (|A| H + |b|) +
//   2^-146 (H + 1), which is more than twice 2^-50 (|A| H + |b|) + 2^-150 (H + 1), of all.
//
// The first part is within the pad of `placed_box`: 20 u |A| H + 6 u |b|, of which 15.1 u |A| H +
// 3.1 u |b| are used, has room for it twice, at the end of the span and at the time; and pads of
// two boxes, mixed, are at least those of the mixed transforms. The second part grows the box.
#pragma once

#include <cmath>
#include <cstddef>

#include "base/vec.h"
#include "base/view.h"
#include "geom/rounding.h"
#include "scene/placing.h"

namespace raysheaf {

/// A time from 0 to 1, between two of those at which something is given.
struct Instant {
  std::size_t before = 0, after = 0;  ///< the same: the time is this one
  double part = 0;                    ///< of the way to the second, below 1

  Instant(double time, std::size_t times) {
    const double x = time * static_cast<double>(times - 1), whole = std::floor(x);
    before = static_cast<std::size_t>(whole);
    after = before + (x == whole ? 0 : 1);
    part = x - whole;
  }
  [[nodiscard]] float mixed(float a, float b) const {
    return static_cast<float>((1 - part) * a + part * b);
  }
  [[nodiscard]] Vec3 mixed(Vec3 a, Vec3 b) const {
    return before == after ? a : Vec3{mixed(a.x, b.x), mixed(a.y, b.y), mixed(a.z, b.z)};
  }
};

/// `transform_at` of raysheaf/scene.h.
[[nodiscard]] inline Affine affine_at(View<const Affine> motion, float time) {
  const Instant at(time, motion.size);
  Affine map = motion[at.before];
  if (at.before == at.after) return map;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) map.m[r][c] = at.mixed(map.m[r][c], motion[at.after].m[r][c]);
  return map;
}

/// Calls `body(map)` for transforms between which corners move along straight lines, from that of
/// one time to that of another, which is not earlier.
template <class Body>
void for_each_turn(View<const Affine> motion, float begin, float end, const Body& body) {
  const auto steps = static_cast<double>(motion.size - 1);
  body(affine_at(motion, begin));
  for (auto j = static_cast<std::size_t>(begin * steps) + 1; static_cast<double>(j) < end * steps;
       ++j)
    body(motion[j]);
  body(affine_at(motion, end));
}

/// How far mixing entries moves a corner on each axis of the world; the largest coordinates of
/// corners in the mesh are `most`.
[[nodiscard]] inline Vec3 mixing_error(View<const Affine> motion, Vec3 most) {
  double error[3];
  for (int r = 0; r < 3; ++r) {
    double size[4] = {};
    for (const Affine& map : motion)
      for (int c = 0; c < 4; ++c)
        size[c] = std::fmax(size[c], std::fabs(static_cast<double>(map.m[r][c])));
    error[r] = 0x1p-48 * (size[0] * most.x + size[1] * most.y + size[2] * most.z + size[3]) +
               0x1p-146 * (static_cast<double>(most.x) + most.y + most.z + 1);
  }
  return {rounded_up(error[0]), rounded_up(error[1]), rounded_up(error[2])};
}

}  // namespace raysheaf
