// Shared by SIMD kernels: masks as bits, vectors of three, and records of four floats. No
// operation is fused, and sums are in the order of base/vec.h. Included once for each SIMD target.
#if defined(RAYSHEAF_BASE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_BASE_LANES_INL_H_
#undef RAYSHEAF_BASE_LANES_INL_H_
#else
#define RAYSHEAF_BASE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "base/vec.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The bits of a mask of at most 16 lanes, lane 0 lowest. Reads no more bytes than were written, so
/// that the processor forwards the store to the load.
template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
  static_assert(hn::MaxLanes(D()) <= 16);
  std::uint8_t bytes[8];
  hn::StoreMaskBits(d, mask, bytes);
  if constexpr (hn::MaxLanes(D()) <= 8) return bytes[0];
  std::uint16_t bits;
  hwy::CopyBytes<2>(bytes, &bits);
  return bits;
}
/// The lanes of the lowest bits.
template <class D>
HWY_INLINE hn::Mask<D> mask_of(D d, std::uint32_t bits) {
  std::uint8_t bytes[8] = {};
  hwy::CopyBytes<4>(&bits, bytes);
  return hn::LoadMaskBits(d, bytes);
}

/// Vectors of three, one in each lane.
template <class V>
struct Lanes3 {
  V x, y, z;
};

template <class D>
HWY_INLINE Lanes3<hn::Vec<D>> all3(D d, Vec3 a) {
  return {hn::Set(d, a.x), hn::Set(d, a.y), hn::Set(d, a.z)};
}
template <class V>
HWY_INLINE Lanes3<V> plus(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class V>
HWY_INLINE Lanes3<V> minus(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class V>
HWY_INLINE Lanes3<V> times(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
template <class V>
HWY_INLINE Lanes3<V> times(const Lanes3<V>& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class V>
HWY_INLINE Lanes3<V> divided(const Lanes3<V>& a, V s) {
  return {hn::Div(a.x, s), hn::Div(a.y, s), hn::Div(a.z, s)};
}
template <class V>
HWY_INLINE Lanes3<V> negated(const Lanes3<V>& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}
template <class V>
HWY_INLINE V dot(const Lanes3<V>& a, const Lanes3<V>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class V>
HWY_INLINE Lanes3<V> cross(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class M, class V>
HWY_INLINE Lanes3<V> select(M mask, const Lanes3<V>& yes, const Lanes3<V>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
/// The largest of the magnitudes.
template <class V>
HWY_INLINE V largest(const Lanes3<V>& a) {
  return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
/// The larger; `b` where one is NaN.
template <class V>
HWY_INLINE V larger(V a, V b) {
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}

#if HWY_TARGET != HWY_SCALAR
/// Loads a vector's blocks of four lanes: block k from the four floats at `at(k)`.
template <class D, class At>
HWY_INLINE hn::Vec<D> load_blocks(D d, const At& at) {
  if constexpr (hn::MaxLanes(D()) == 16) {
    const hn::Half<D> d8;
    const hn::Half<hn::Half<D>> d4;
    return hn::Combine(d, hn::Combine(d8, hn::LoadU(d4, at(3)), hn::LoadU(d4, at(2))),
                       hn::Combine(d8, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0))));
  } else if constexpr (hn::MaxLanes(D()) == 8) {
    const hn::Half<D> d4;
    return hn::Combine(d, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0)));
  } else {
    return hn::LoadU(d, at(0));
  }
}
#endif

/// Loads the four floats at `at(i)` for each lane i: one to lane i of each vector. Uses registers
/// only, because memory that was stored in parts cannot be loaded as a whole without waiting.
template <class D, class At, class V = hn::Vec<D>>
HWY_INLINE void gather4(D d, const At& at, V& f0, V& f1, V& f2, V& f3) {
#if HWY_TARGET == HWY_SCALAR
  const float* const from = at(0);
  f0 = hn::Set(d, from[0]);
  f1 = hn::Set(d, from[1]);
  f2 = hn::Set(d, from[2]);
  f3 = hn::Set(d, from[3]);
#else
  // Vector j holds the records j, 4 + j, 8 + j, ... in its blocks of four lanes.
  const auto blocks = [&](std::size_t j) __attribute__((always_inline)) {
    return load_blocks(
        d, [&](std::size_t k) __attribute__((always_inline)) { return at(4 * k + j); });
  };
  const V a = blocks(0), b = blocks(1), c = blocks(2), e = blocks(3);
  const hn::Repartition<std::uint64_t, D> d64;
  const auto low = [&](V x, V y) HWY_ATTR { return hn::BitCast(d64, hn::InterleaveLower(x, y)); };
  const auto high = [&](V x, V y)
                        HWY_ATTR { return hn::BitCast(d64, hn::InterleaveUpper(d, x, y)); };
  f0 = hn::BitCast(d, hn::InterleaveLower(low(a, b), low(c, e)));
  f1 = hn::BitCast(d, hn::InterleaveUpper(d64, low(a, b), low(c, e)));
  f2 = hn::BitCast(d, hn::InterleaveLower(high(a, b), high(c, e)));
  f3 = hn::BitCast(d, hn::InterleaveUpper(d64, high(a, b), high(c, e)));
#endif
}

/// The reverse: stores lane i of each vector at `at(i)`, which is aligned to 16 bytes.
template <class D, class At, class V = hn::Vec<D>>
HWY_INLINE void scatter4(D d, V f0, V f1, V f2, V f3, const At& at) {
#if HWY_TARGET == HWY_SCALAR
  float* const to = at(0);
  to[0] = hn::GetLane(f0);
  to[1] = hn::GetLane(f1);
  to[2] = hn::GetLane(f2);
  to[3] = hn::GetLane(f3);
  static_cast<void>(d);
#else
  const auto store_blocks = [&](V v, std::size_t j) __attribute__((always_inline)) {
    if constexpr (hn::MaxLanes(D()) == 16) {
      const hn::Half<D> d8;
      const hn::Half<hn::Half<D>> d4;
      const auto low = hn::LowerHalf(d8, v), high = hn::UpperHalf(d8, v);
      hn::Store(hn::LowerHalf(d4, low), d4, at(j));
      hn::Store(hn::UpperHalf(d4, low), d4, at(4 + j));
      hn::Store(hn::LowerHalf(d4, high), d4, at(8 + j));
      hn::Store(hn::UpperHalf(d4, high), d4, at(12 + j));
    } else if constexpr (hn::MaxLanes(D()) == 8) {
      const hn::Half<D> d4;
      hn::Store(hn::LowerHalf(d4, v), d4, at(j));
      hn::Store(hn::UpperHalf(d4, v), d4, at(4 + j));
    } else {
      hn::Store(v, d, at(j));
    }
  };
  const hn::Repartition<std::uint64_t, D> d64;
  const auto as64 = [&](V v) HWY_ATTR { return hn::BitCast(d64, v); };
  const auto a = as64(hn::InterleaveLower(f0, f1)), b = as64(hn::InterleaveLower(f2, f3));
  const auto c = as64(hn::InterleaveUpper(d, f0, f1)), e = as64(hn::InterleaveUpper(d, f2, f3));
  store_blocks(hn::BitCast(d, hn::InterleaveLower(a, b)), 0);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, a, b)), 1);
  store_blocks(hn::BitCast(d, hn::InterleaveLower(c, e)), 2);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, c, e)), 3);
#endif
}

struct FourLanes {
  alignas(16) float lane[4];
};
/// Reduces the lanes of four vectors by `pick` in a third of the steps of four separate reductions.
template <class D, class Pick, class V = hn::Vec<D>>
HWY_INLINE FourLanes of_lanes4(D d, V a, V b, V c, V e, const Pick& pick) {
  FourLanes four;
#if HWY_TARGET == HWY_SCALAR
  const V all[4] = {a, b, c, e};
  for (int i = 0; i < 4; ++i) four.lane[i] = hn::GetLane(all[i]);
  static_cast<void>(d);
  static_cast<void>(pick);
#else
  const hn::Repartition<std::uint64_t, D> d64;
  // a b a b, and of their halves a b c e, in each block of four lanes.
  const auto ab = hn::BitCast(d64, pick(hn::InterleaveLower(a, b), hn::InterleaveUpper(d, a, b)));
  const auto ce = hn::BitCast(d64, pick(hn::InterleaveLower(c, e), hn::InterleaveUpper(d, c, e)));
  const auto in_blocks = pick(hn::BitCast(d, hn::InterleaveLower(ab, ce)),
                              hn::BitCast(d, hn::InterleaveUpper(d64, ab, ce)));
  const auto fold = [&](auto half, auto v)
                        HWY_ATTR { return pick(hn::LowerHalf(half, v), hn::UpperHalf(half, v)); };
  if constexpr (hn::MaxLanes(D()) == 16) {
    const hn::Half<D> d8;
    const hn::Half<hn::Half<D>> d4;
    hn::Store(fold(d4, fold(d8, in_blocks)), d4, four.lane);
  } else if constexpr (hn::MaxLanes(D()) == 8) {
    const hn::Half<D> d4;
    hn::Store(fold(d4, in_blocks), d4, four.lane);
  } else {
    hn::Store(in_blocks, d, four.lane);
  }
#endif
  return four;
}

#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
#if HWY_TARGET == HWY_AVX2
/// For each selection of eight lanes: the lanes' numbers, four bits each, selected ones first.
struct ChosenFirst {
  std::uint32_t lanes[256] = {};
  constexpr ChosenFirst() {
    for (std::uint32_t chosen = 0; chosen < 256; ++chosen) {
      std::uint32_t shift = 0;
      for (const std::uint32_t turn : {1u, 0u}) {
        for (std::uint32_t lane = 0; lane < 8; ++lane) {
          if ((chosen >> lane & 1) != turn) continue;
          lanes[chosen] |= lane << shift;
          shift += 4;
        }
      }
    }
  }
};
inline constexpr ChosenFirst kChosenFirst;
#endif

/// Moves selected lanes to the front, in order. The lanes after them hold the others or 0. Returns
/// how many were selected.
template <class D>
HWY_INLINE std::uint32_t compress(D d, hn::Mask<D> chosen, hn::Vec<D>* v) {
#if HWY_TARGET == HWY_AVX2
  // Works like hn::Compress, with a static table: gcc 12 copies the table of Highway 1.0 to the
  // stack for each call.
  static_assert(hn::MaxLanes(D()) == 8 && sizeof(hn::TFromD<D>) == 4);
  alignas(32) static constexpr std::uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
  const std::uint32_t bits = bits_of(d, chosen);
  const hn::RebindToUnsigned<D> du;
  const auto lanes = hn::Set(du, kChosenFirst.lanes[bits]) >> hn::Load(du, kShifts);
  *v = hn::TableLookupLanes(*v, hn::IndicesFromVec(d, hn::And(lanes, hn::Set(du, 7))));
  return static_cast<std::uint32_t>(__builtin_popcount(bits));
#else
  *v = hn::Compress(*v, chosen);
  return static_cast<std::uint32_t>(hn::CountTrue(d, chosen));
#endif
}
#endif

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
