#include "lab/verify/maps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "intersect/exact.h"

namespace raysheaf::checks {

Affine some_map(Random* random) {
  Affine map;
  const auto turn = [&] {
    const Vec3 axis = random->direction();
    return rotation(axis, random->between(0, 7));
  };
  switch (random->below(9)) {
    case 0:
      return map;
    case 1:
      return scaling({1, random->one_in(4) ? 0.0f : 1.0f, random->one_in(2) ? 0.0f : -1.0f});
    case 2:
      for (auto& row : map.m)
        for (std::size_t i = 0; i < 3; ++i) row[i] = static_cast<float>(random->below(7)) - 3;
      return map;
    case 3:
      return scaling({1, -1, 1});
    case 4:
      return scaling(Vec3{1, 1, 1} * random->magnitude(-6, 6));
    case 5:
      return turn();
    case 6:
      map = turn();
      return compose(map, scaling(Vec3{1, 1, 1} * random->magnitude(-1, 1)));
    case 7: {
      map = turn();
      float& entry = map.m[random->below(3)][random->below(3)];
      entry += random->between(-2, 2);
      return map;
    }
    default:
      map = turn();
      return compose(map, scaling({1, random->magnitude(-6, 0), 1}));
  }
}

float some_time(Random* random) {
  constexpr float kTimes[] = {0, 1, -0.0f, 0x1p-149f, 1e-30f, 1.0f / 3, 1 - 0x1p-24f};
  if (random->one_in(3)) return kTimes[random->below(std::size(kTimes))];
  if (random->one_in(2)) return static_cast<float>(random->below(9)) / 8;
  return random->unit();
}

Affine mixed_at(std::span<const Affine> transforms, float time) {
  const double x = double{time} * static_cast<double>(transforms.size() - 1);
  const auto j = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(j);
  const Affine &a = transforms[j], &b = transforms[std::min(j + 1, transforms.size() - 1)];
  Affine map;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      map.m[r][c] = static_cast<float>((1 - f) * double{a.m[r][c]} + f * double{b.m[r][c]});
  return map;
}

Vec3 placed(const Affine& transform, Vec3 p) {
  if (transform.m == Affine{}.m) return p;
  const auto row = [&](std::size_t r) {
    const auto& m = transform.m[r];
    return ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3];
  };
  return {row(0), row(1), row(2)};
}

bool surely_stays(std::span<const Affine> transforms, float reach) {
  for (const Affine& map : transforms)
    for (const auto& m : map.m)
      if (!((std::fabs(double{m[0]}) + std::fabs(double{m[1]}) + std::fabs(double{m[2]})) *
                    double{reach} +
                std::fabs(double{m[3]}) <=
            9e17))
        return false;
  return true;
}

bool is_mirrored(const Affine& transform) {
  const auto row = [&](std::size_t i) {
    return Row{{transform.m[i][0], transform.m[i][1], transform.m[i][2]}, {}};
  };
  return sign_of_determinant({row(0), row(1), row(2)}) < 0;
}

}  // namespace raysheaf::checks
