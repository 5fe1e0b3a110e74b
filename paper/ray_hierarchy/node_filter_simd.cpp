// Compiled once for each SIMD target and chosen at run time (Google Highway). The operations and
// their order are those of each `meets`, without fused ones.
#include "paper/ray_hierarchy/node_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "paper/ray_hierarchy/node_filter_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Indices = hn::RebindToUnsigned<Floats>;
using Signed = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

HWY_INLINE V set(float x) {
  return hn::Set(Floats(), x);
}

using V3 = Lanes3<V>;

HWY_INLINE V3 set(Vec3 v) {
  return all3(Floats(), v);
}
HWY_INLINE V3 load3(const float* const* fields, std::uint32_t i) {
  const Floats d;
  return {hn::LoadU(d, fields[0] + i), hn::LoadU(d, fields[1] + i), hn::LoadU(d, fields[2] + i)};
}

/// The values that both tests of a sphere begin with.
struct BallLanes {
  V a, b2, v2, reach;

  HWY_INLINE BallLanes(const ConeSphereTest& n, float slack, const float* const* fields,
                       std::uint32_t i) {
    using hn::Abs, hn::Add, hn::Mul;
    const V3 v = minus(load3(fields, i), set(n.center)), axis = set(n.axis);
    const V3 across = cross(v, axis);
    a = dot(v, axis);
    b2 = dot(across, across);
    v2 = dot(v, v);
    const V sum = Add(set(n.radius), hn::LoadU(Floats(), fields[3] + i));
    const V size = Add(Add(Add(Abs(v.x), Abs(v.y)), Abs(v.z)), sum);
    reach = Add(sum, Add(Mul(set(slack), size), set(kConeSphereTiny)));
  }
};

HWY_INLINE M meets_lanes(const ConeSphereTest& n, const float* const* fields, std::uint32_t i) {
  using hn::Add, hn::And, hn::Ge, hn::Le, hn::Lt, hn::Mul, hn::Not, hn::Or;
  const BallLanes p(n, kConeSphereSlack, fields, i);
  const V zero = hn::Zero(Floats());
  const V line = Add(p.reach, Mul(p.a, set(n.sin_angle)));
  const M beside = And(Ge(line, zero), Le(Mul(p.b2, set(n.cos2_angle)), Mul(line, line)));
  const M ahead =
      Or(Ge(p.a, zero), Ge(Mul(p.b2, set(n.sin2_angle)), Mul(Mul(p.a, p.a), set(n.cos2_angle))));
  const M near = Le(p.v2, Mul(p.reach, p.reach));
  return Or(Or(near, And(beside, ahead)), Not(Lt(p.v2, set(kConeSphereHuge))));
}

HWY_INLINE M meets_lanes(const FiniteConeTest& n, const float* const* fields, std::uint32_t i) {
  using hn::Add, hn::And, hn::Ge, hn::Le, hn::Lt, hn::Mul, hn::Not, hn::Or, hn::Sub;
  const BallLanes p(n.cone, kFiniteConeSlack, fields, i);
  const V zero = hn::Zero(Floats());
  const V far = Add(set(n.reach), p.reach);
  const M huge = Not(Lt(p.v2, set(kConeSphereHuge)));
  const M before_cap = And(Ge(far, zero), Le(p.v2, Mul(far, far)));
  if (n.cone.whole) return Or(before_cap, huge);
  const V sine = set(n.cone.sin_angle), cosine = set(n.cos_angle);
  const V b = hn::Sqrt(p.b2);
  const V s = Sub(Mul(b, cosine), Mul(p.a, sine));
  const V e = Add(Mul(p.a, cosine), Mul(b, sine));
  const V over = Sub(e, set(n.reach));
  const V reach2 = Mul(p.reach, p.reach);
  const M beside = And(Le(s, p.reach), Ge(e, zero));
  const M tip = Le(Add(Mul(s, s), Mul(over, over)), reach2);
  const M ends = Or(Or(Le(over, zero), tip), And(Le(s, zero), before_cap));
  const M meets = And(Ge(p.reach, zero), Or(Le(p.v2, reach2), And(beside, ends)));
  return Or(meets, huge);
}

struct BoxLanes {
  V3 min, max;

  HWY_INLINE BoxLanes(const float* const* fields, std::uint32_t i) {
    using hn::Max, hn::Min;
    const V3 a = load3(fields, i), b = load3(fields + 3, i), c = load3(fields + 6, i);
    min = {Min(Min(a.x, b.x), c.x), Min(Min(a.y, b.y), c.y), Min(Min(a.z, b.z), c.z)};
    max = {Max(Max(a.x, b.x), c.x), Max(Max(a.y, b.y), c.y), Max(Max(a.z, b.z), c.z)};
  }
};

HWY_INLINE V largest(const V3& a, const V3& b) {
  using hn::Max;
  return Max(Max(Max(a.x, b.x), Max(a.y, b.y)), Max(a.z, b.z));
}

HWY_INLINE void clip_lanes(V gap, float per_speed, V* lo, V* hi) {
  const V t = hn::Mul(gap, set(per_speed));
  if (per_speed > 0) {
    *hi = hn::Min(t, *hi);
  } else {
    *lo = hn::Max(t, *lo);
  }
}

/// `outside`: receives an upper bound of a box's distance from the hull, or nothing to compare.
HWY_INLINE M meets_box(const BeamTest& n, const Box* hull, const BoxLanes& box) {
  using hn::Add, hn::And, hn::Mul;
  const V3 gap_min = minus(box.max, set(n.origins.min));
  const V3 gap_max = minus(set(n.origins.max), box.min);
  const V slack = Add(Mul(set(kBeamSlack), largest(gap_min, gap_max)), set(kTinySlack));
  V lo = hn::Zero(Floats()), hi = set(1);
  clip_lanes(Add(gap_min.x, slack), n.per_min.x, &lo, &hi);
  clip_lanes(Add(gap_max.x, slack), n.per_max.x, &lo, &hi);
  clip_lanes(Add(gap_min.y, slack), n.per_min.y, &lo, &hi);
  clip_lanes(Add(gap_max.y, slack), n.per_max.y, &lo, &hi);
  clip_lanes(Add(gap_min.z, slack), n.per_min.z, &lo, &hi);
  clip_lanes(Add(gap_max.z, slack), n.per_max.z, &lo, &hi);
  const M meets = hn::Le(lo, Mul(hi, set(kBeamLoosened)));
  if (hull == nullptr) return meets;
  using hn::Min;
  const V3 below = minus(set(hull->max), box.min), above = minus(box.max, set(hull->min));
  const V least = Min(Min(Min(below.x, above.x), Min(below.y, above.y)), Min(below.z, above.z));
  return And(meets, hn::Ge(Add(least, slack), hn::Zero(Floats())));
}

HWY_INLINE M meets_lanes(const BeamTest& n, const float* const* fields, std::uint32_t i) {
  return meets_box(n, nullptr, BoxLanes(fields, i));
}
HWY_INLINE M meets_lanes(const FrustumTest& n, const float* const* fields, std::uint32_t i) {
  return meets_box(n.beam, &n.hull, BoxLanes(fields, i));
}
HWY_INLINE M meets_lanes(const ShaftConeTest& n, const float* const* fields, std::uint32_t i) {
  const M shaft = meets_lanes(n.shaft, fields, i);
  if (hn::AllFalse(Floats(), shaft)) return shaft;
  return hn::And(shaft, meets_lanes(n.cone, fields + kCornerFields, i));
}

inline Vec3 at(const float* const* fields, std::uint32_t i) {
  return {fields[0][i], fields[1][i], fields[2][i]};
}
template <class Test>
bool meets_ball(const Test& n, const float* const* fields, std::uint32_t i) {
  return meets(n, at(fields, i), fields[3][i]);
}
template <class Test>
bool meets_corners(const Test& n, const float* const* fields, std::uint32_t i) {
  return meets(n, box_of_triangle(at(fields, i), at(fields + 3, i), at(fields + 6, i)));
}
inline bool meets_one(const ConeSphereTest& n, const float* const* fields, std::uint32_t i) {
  return meets_ball(n, fields, i);
}
inline bool meets_one(const FiniteConeTest& n, const float* const* fields, std::uint32_t i) {
  return meets_ball(n, fields, i);
}
inline bool meets_one(const BeamTest& n, const float* const* fields, std::uint32_t i) {
  return meets_corners(n, fields, i);
}
inline bool meets_one(const FrustumTest& n, const float* const* fields, std::uint32_t i) {
  return meets_corners(n, fields, i);
}
inline bool meets_one(const ShaftConeTest& n, const float* const* fields, std::uint32_t i) {
  return meets_corners(n.shaft, fields, i) && meets_ball(n.cone, fields + kCornerFields, i);
}

/// Appends base + lane for each lane of the mask. Highway 1.0.3's CompressStore under GCC 12 copies
/// its table every time on targets without a compress instruction; on these, this enumerates bits
/// instead.
HWY_INLINE std::uint32_t append(M mask, std::uint32_t base, std::uint32_t* out) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const Indices u;
  return static_cast<std::uint32_t>(
      hn::CompressStore(hn::Iota(u, base), hn::RebindMask(u, mask), u, out));
#else
  std::uint32_t n = 0;
  for (std::uint32_t bits = bits_of(Floats(), mask); bits != 0; bits &= bits - 1)
    out[n++] = base + static_cast<std::uint32_t>(__builtin_ctz(bits));
  return n;
#endif
}

template <class Test>
std::uint32_t filter_lanes(const Test& node, const float* const* fields, std::uint32_t count,
                           std::uint32_t* out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Floats()));
  const Test test = node;  // a local copy, which `out` cannot alias
  std::uint32_t hits = 0, i = 0;
  for (; i + lanes <= count; i += lanes)
    hits += append(meets_lanes(test, fields, i), i, out + hits);
  for (; i < count; ++i) {
    out[hits] = i;
    hits += meets_one(test, fields, i) ? 1 : 0;
  }
  return hits;
}

#define RAYSHEAF_FILTER(Test)                                                                   \
  std::uint32_t Filter##Test(const Test& node, const float* const* fields, std::uint32_t count, \
                             std::uint32_t* out) {                                              \
    return filter_lanes(node, fields, count, out);                                              \
  }
RAYSHEAF_FILTER(ConeSphereTest)
RAYSHEAF_FILTER(FiniteConeTest)
RAYSHEAF_FILTER(BeamTest)
RAYSHEAF_FILTER(FrustumTest)
RAYSHEAF_FILTER(ShaftConeTest)
#undef RAYSHEAF_FILTER

void GatherFloats(const float* from, const std::uint32_t* index, std::uint32_t count, float* out) {
  const Floats d;
  const Signed di;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  std::uint32_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto places = hn::BitCast(di, hn::LoadU(Indices(), index + i));
    hn::StoreU(hn::GatherIndex(d, from, places), d, out + i);
  }
  for (; i < count; ++i) out[i] = from[index[i]];
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FilterConeSphereTest);
HWY_EXPORT(FilterFiniteConeTest);
HWY_EXPORT(FilterBeamTest);
HWY_EXPORT(FilterFrustumTest);
HWY_EXPORT(FilterShaftConeTest);
HWY_EXPORT(GatherFloats);

std::uint32_t filter(const ConeSphereTest& node, const FieldPointers<kBallFields>& fields,
                     std::uint32_t count, std::uint32_t* out) {
  if (node.whole) {
    for (std::uint32_t i = 0; i < count; ++i) out[i] = i;
    return count;
  }
  return HWY_DYNAMIC_DISPATCH(FilterConeSphereTest)(node, fields.data(), count, out);
}
std::uint32_t filter(const FiniteConeTest& node, const FieldPointers<kBallFields>& fields,
                     std::uint32_t count, std::uint32_t* out) {
  return HWY_DYNAMIC_DISPATCH(FilterFiniteConeTest)(node, fields.data(), count, out);
}
std::uint32_t filter(const BeamTest& node, const FieldPointers<kCornerFields>& fields,
                     std::uint32_t count, std::uint32_t* out) {
  return HWY_DYNAMIC_DISPATCH(FilterBeamTest)(node, fields.data(), count, out);
}
std::uint32_t filter(const FrustumTest& node, const FieldPointers<kCornerFields>& fields,
                     std::uint32_t count, std::uint32_t* out) {
  return HWY_DYNAMIC_DISPATCH(FilterFrustumTest)(node, fields.data(), count, out);
}
std::uint32_t filter(const ShaftConeTest& node,
                     const FieldPointers<kCornerFields + kBallFields>& fields, std::uint32_t count,
                     std::uint32_t* out) {
  return HWY_DYNAMIC_DISPATCH(FilterShaftConeTest)(node, fields.data(), count, out);
}

void gather_floats(const float* from, const std::uint32_t* index, std::uint32_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(GatherFloats)(from, index, count, out);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
