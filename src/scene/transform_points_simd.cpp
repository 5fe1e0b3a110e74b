// Compiled once for each SIMD target and chosen at run time (Google Highway). The operations and
// their order are those of `transform_point`.
#include "base/vec.h"
#include "scene/transform_points.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/transform_points_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

struct RowLanes {
  explicit RowLanes(const std::array<float, 4>& row)
      : x(hn::Set(Floats(), row[0])),
        y(hn::Set(Floats(), row[1])),
        z(hn::Set(Floats(), row[2])),
        one(hn::Set(Floats(), row[3])) {}
  [[nodiscard]] HWY_INLINE V operator()(V px, V py, V pz) const {
    return hn::Add(hn::Add(hn::Add(hn::Mul(x, px), hn::Mul(y, py)), hn::Mul(z, pz)), one);
  }
  V x, y, z, one;
};

bool TransformPoints(const Affine& to_world, const Vec3* from, std::size_t count, Vec3* to) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  const RowLanes rows[3] = {RowLanes(to_world.m[0]), RowLanes(to_world.m[1]),
                            RowLanes(to_world.m[2])};
  const V limit = hn::Set(d, kLargestCoordinate);
  auto right = hn::Eq(limit, limit);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    V x = limit, y = limit, z = limit;
    hn::LoadInterleaved3(d, &from[i].x, x, y, z);
    const V wx = rows[0](x, y, z), wy = rows[1](x, y, z), wz = rows[2](x, y, z);
    right = hn::And(right, hn::And(hn::And(hn::Le(hn::Abs(wx), limit), hn::Le(hn::Abs(wy), limit)),
                                   hn::Le(hn::Abs(wz), limit)));
    hn::StoreInterleaved3(wx, wy, wz, d, &to[i].x);
  }
  bool good = hn::AllTrue(d, right);
  for (; i < count; ++i) {
    to[i] = transform_point(to_world, from[i]);
    const Vec3 size = abs(to[i]);
    good = good && size.x <= kLargestCoordinate && size.y <= kLargestCoordinate &&
           size.z <= kLargestCoordinate;
  }
  return good;
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(TransformPoints);

bool transform_points(const Affine& to_world, const Vec3* from, std::size_t count, Vec3* to) {
  return HWY_DYNAMIC_DISPATCH(TransformPoints)(to_world, from, count, to);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
