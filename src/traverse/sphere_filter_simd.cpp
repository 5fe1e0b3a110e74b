// Compiled once a SIMD target and chosen at run time (Google Highway). The operations and their
// order are those of `meets`, without fused ones.
#include "traverse/sphere_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traverse/sphere_filter_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Indices = hn::RebindToUnsigned<Floats>;
using Signed = hn::RebindToSigned<Floats>;

struct NodeLanes {
  explicit NodeLanes(const ConeSphereTest& n)
      : cx(Set(n.center.x)),
        cy(Set(n.center.y)),
        cz(Set(n.center.z)),
        ax(Set(n.axis.x)),
        ay(Set(n.axis.y)),
        az(Set(n.axis.z)),
        radius(Set(n.radius)),
        sine(Set(n.sin_angle)),
        sin2(Set(n.sin2_angle)),
        cos2(Set(n.cos2_angle)) {}
  static hn::Vec<Floats> Set(float x) { return hn::Set(Floats(), x); }
  hn::Vec<Floats> cx, cy, cz, ax, ay, az, radius, sine, sin2, cos2;
};

template <class V>
HWY_INLINE hn::Mask<Floats> meets_lanes(const NodeLanes& n, V px, V py, V pz, V pr) {
  using hn::Add, hn::Mul, hn::Sub, hn::Abs, hn::And, hn::Or, hn::Not, hn::Ge, hn::Le, hn::Lt;
  const Floats d;
  const V zero = hn::Zero(d);
  const V vx = Sub(px, n.cx), vy = Sub(py, n.cy), vz = Sub(pz, n.cz);
  const V qx = Sub(Mul(vy, n.az), Mul(vz, n.ay));
  const V qy = Sub(Mul(vz, n.ax), Mul(vx, n.az));
  const V qz = Sub(Mul(vx, n.ay), Mul(vy, n.ax));
  const V a = Add(Add(Mul(vx, n.ax), Mul(vy, n.ay)), Mul(vz, n.az));
  const V b2 = Add(Add(Mul(qx, qx), Mul(qy, qy)), Mul(qz, qz));
  const V v2 = Add(Add(Mul(vx, vx), Mul(vy, vy)), Mul(vz, vz));
  const V sum = Add(n.radius, pr);
  const V size = Add(Add(Add(Abs(vx), Abs(vy)), Abs(vz)), sum);
  const V slack = Add(Mul(hn::Set(d, kConeSphereSlack), size), hn::Set(d, kConeSphereTiny));
  const V reach = Add(sum, slack);
  const V line = Add(reach, Mul(a, n.sine));
  const auto beside = And(Ge(line, zero), Le(Mul(b2, n.cos2), Mul(line, line)));
  const auto ahead = Or(Ge(a, zero), Ge(Mul(b2, n.sin2), Mul(Mul(a, a), n.cos2)));
  const auto near = Le(v2, Mul(reach, reach));
  return Or(Or(near, And(beside, ahead)), Not(Lt(v2, hn::Set(d, kConeSphereHuge))));
}

/// Appends base + lane for each lane of the mask. Highway 1.0.3's CompressStore under GCC 12 copies
/// its table every time on targets without a compress instruction; there, bits are walked instead.
HWY_INLINE std::uint32_t append(hn::Mask<Floats> mask, std::uint32_t base, std::uint32_t* out) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const Indices u;
  return static_cast<std::uint32_t>(
      hn::CompressStore(hn::Iota(u, base), hn::RebindMask(u, mask), u, out));
#else
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Floats(), mask, bytes);
  std::uint64_t bits = 0;
  hwy::CopyBytes<8>(bytes, &bits);
  std::uint32_t n = 0;
  for (; bits != 0; bits &= bits - 1)
    out[n++] = base + static_cast<std::uint32_t>(__builtin_ctzll(bits));
  return n;
#endif
}

std::uint32_t FilterSpheres(const ConeSphereTest& node, const SphereArrays& s, std::uint32_t count,
                            std::uint32_t* out) {
  const Floats d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const NodeLanes n(node);
  std::uint32_t hits = 0, i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto mask = meets_lanes(n, hn::LoadU(d, s.x + i), hn::LoadU(d, s.y + i),
                                  hn::LoadU(d, s.z + i), hn::LoadU(d, s.radius + i));
    hits += append(mask, i, out + hits);
  }
  for (; i < count; ++i) {
    out[hits] = i;
    hits += meets(node, {s.x[i], s.y[i], s.z[i]}, s.radius[i]) ? 1 : 0;
  }
  return hits;
}

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

HWY_EXPORT(FilterSpheres);
HWY_EXPORT(GatherFloats);

std::uint32_t filter_spheres(const ConeSphereTest& node, const SphereArrays& spheres,
                             std::uint32_t count, std::uint32_t* out) {
  if (node.whole) {
    for (std::uint32_t i = 0; i < count; ++i) out[i] = i;
    return count;
  }
  return HWY_DYNAMIC_DISPATCH(FilterSpheres)(node, spheres, count, out);
}

void gather_floats(const float* from, const std::uint32_t* index, std::uint32_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(GatherFloats)(from, index, count, out);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
