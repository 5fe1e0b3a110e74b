// Fragments as SIMD vectors, and vectors of three. Included once for each SIMD target.
#if defined(RAYSHEAF_RAYGEN_FRAGMENT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_RAYGEN_FRAGMENT_LANES_INL_H_
#undef RAYSHEAF_RAYGEN_FRAGMENT_LANES_INL_H_
#else
#define RAYSHEAF_RAYGEN_FRAGMENT_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "rays/point_light.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLightLanes>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

struct V3 {
  V x, y, z;
};

/// The bits of a mask, lane 0 lowest.
HWY_INLINE std::uint32_t BitsOf(M mask) {
  const Floats d;
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return bits & ((1u << hn::Lanes(d)) - 1);
}

HWY_INLINE V3 Splat(Vec3 a) {
  const Floats d;
  return {hn::Set(d, a.x), hn::Set(d, a.y), hn::Set(d, a.z)};
}
HWY_INLINE V3 Load3(const float (&columns)[3][kLightBlock], std::size_t k) {
  const Floats d;
  return {hn::Load(d, columns[0] + k), hn::Load(d, columns[1] + k), hn::Load(d, columns[2] + k)};
}
HWY_INLINE V3 Sub(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 Select(M mask, const V3& yes, const V3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE V3 Add(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 Mul(const V3& a, const V3& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
HWY_INLINE V3 Scale(const V3& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
/// Treats NaN like `max`.
HWY_INLINE V Larger(V a, V b) {
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}
HWY_INLINE V MaxOf(const V3& a) {
  return Larger(Larger(a.x, a.y), a.z);
}
HWY_INLINE V Clamp(V x, float lo, float hi) {
  const Floats d;
  const V low = hn::Set(d, lo), high = hn::Set(d, hi);
  return hn::IfThenElse(hn::Lt(x, low), low, hn::IfThenElse(hn::Gt(x, high), high, x));
}

/// Whether `normalized` of a vector of this length is a plain division.
HWY_INLINE M IsUsual(V length) {
  const Floats d;
  return hn::And(hn::Gt(length, hn::Set(d, 1e-15f)), hn::Lt(length, hn::Set(d, 1e15f)));
}
HWY_INLINE V3 Divided(const V3& a, V length) {
  return {hn::Div(a.x, length), hn::Div(a.y, length), hn::Div(a.z, length)};
}

inline constexpr std::size_t kFragmentWords = sizeof(Fragment) / sizeof(float);
HWY_INLINE const float* WordsOf(const Fragment& fragment) {
  return reinterpret_cast<const float*>(&fragment);
}

/// Consecutive fragments from `k` on, as many as there are lanes; lanes after the last repeat the
/// first fragment of all.
class FragmentRow {
 public:
  HWY_INLINE FragmentRow(View<const Fragment> fragments, std::size_t k)
      : words_(WordsOf(fragments[k])) {
    const std::size_t left = fragments.size - k;
    if (HWY_LIKELY(left >= hn::Lanes(Floats()))) return;
    for (std::size_t lane = 0; lane < hn::Lanes(Floats()); ++lane)
      std::memcpy(padded_ + lane * kFragmentWords, WordsOf(fragments[lane < left ? k + lane : 0]),
                  sizeof(Fragment));
    words_ = padded_;
  }

  FragmentRow(const FragmentRow&) = delete;  // it may point to its own memory
  FragmentRow& operator=(const FragmentRow&) = delete;

  [[nodiscard]] HWY_INLINE const float* WordsAt(std::size_t lane) const {
    return words_ + lane * kFragmentWords;
  }

 private:
  const float* words_;
  alignas(64) float padded_[kLightLanes * kFragmentWords];
};

/// The same for arbitrary fragments: those of `slots` from `k` on.
class FragmentList {
 public:
  HWY_INLINE FragmentList(View<const Fragment> fragments, View<const std::uint32_t> slots,
                          std::size_t k) {
    for (std::size_t lane = 0; lane < hn::Lanes(Floats()); ++lane)
      words_[lane] = WordsOf(fragments[slots[k + lane < slots.size ? k + lane : 0]]);
  }

  [[nodiscard]] HWY_INLINE const float* WordsAt(std::size_t lane) const { return words_[lane]; }

 private:
  const float* words_[kLightLanes];
};

/// The fields of the lanes' fragments, a vector for each word. `Place`: where the fragments are.
template <class Place>
class LanesOf {
 public:
  /// With the arguments of `Place`.
  template <class... From>
  HWY_INLINE explicit LanesOf(const From&... from) : place_(from...) {}

  /// Word `kWord` of each.
  template <std::size_t kWord>
  [[nodiscard]] HWY_INLINE V At() const {
    constexpr std::size_t kFirst =
        kWord / 4 * 4 + 4 <= kFragmentWords ? kWord / 4 * 4 : kFragmentWords - 4;
    return Four<kFirst>().word[kWord - kFirst];
  }
  /// Three words each, from `kWord` on.
  template <std::size_t kWord>
  [[nodiscard]] HWY_INLINE V3 At3() const {
    return {At<kWord>(), At<kWord + 1>(), At<kWord + 2>()};
  }

 private:
  struct FourWords {
    V word[4];
  };

  /// Consecutive words, loaded as whole vectors and transposed in registers: loading them one by
  /// one takes twice as long. The compiler removes unused ones.
  template <std::size_t kFirst>
  [[nodiscard]] HWY_INLINE FourWords Four() const {
    const Floats d;
    const auto at = [&](std::size_t lane) HWY_ATTR { return place_.WordsAt(lane) + kFirst; };
#if HWY_TARGET == HWY_SCALAR
    const float* const from = at(0);
    return {{hn::Set(d, from[0]), hn::Set(d, from[1]), hn::Set(d, from[2]), hn::Set(d, from[3])}};
#else
    // Vector j holds the fragments j, 4 + j, 8 + j, ... in its blocks of four lanes.
    const auto blocks = [&](std::size_t j) HWY_ATTR {
      constexpr std::size_t kBlocks = hn::MaxLanes(Floats()) / 4;
      if constexpr (kBlocks == 4) {
        const hn::Half<Floats> d8;
        const hn::Half<hn::Half<Floats> > d4;
        return hn::Combine(d, hn::Combine(d8, hn::LoadU(d4, at(12 + j)), hn::LoadU(d4, at(8 + j))),
                           hn::Combine(d8, hn::LoadU(d4, at(4 + j)), hn::LoadU(d4, at(j))));
      } else if constexpr (kBlocks == 2) {
        const hn::Half<Floats> d4;
        return hn::Combine(d, hn::LoadU(d4, at(4 + j)), hn::LoadU(d4, at(j)));
      } else {
        return hn::LoadU(d, at(j));
      }
    };
    const V a = blocks(0), b = blocks(1), c = blocks(2), e = blocks(3);
    const hn::Repartition<std::uint64_t, Floats> d64;
    const auto low = [&](V x, V y) HWY_ATTR { return hn::BitCast(d64, hn::InterleaveLower(x, y)); };
    const auto high = [&](V x, V y)
                          HWY_ATTR { return hn::BitCast(d64, hn::InterleaveUpper(d, x, y)); };
    return {{hn::BitCast(d, hn::InterleaveLower(low(a, b), low(c, e))),
             hn::BitCast(d, hn::InterleaveUpper(d64, low(a, b), low(c, e))),
             hn::BitCast(d, hn::InterleaveLower(high(a, b), high(c, e))),
             hn::BitCast(d, hn::InterleaveUpper(d64, high(a, b), high(c, e)))}};
#endif
  }

  const Place place_;
};
using FragmentLanes = LanesOf<FragmentRow>;
using ListedLanes = LanesOf<FragmentList>;

/// The offset of a fragment's field, in words.
#define RAYSHEAF_WORD(field) (offsetof(Fragment, field) / sizeof(float))
#define RAYSHEAF_SURFACE_WORD(field) \
  (RAYSHEAF_WORD(surface) + offsetof(Surface, field) / sizeof(float))

/// Lanes with a surface, whose `triangle` is valid.
HWY_INLINE M HasTriangle(V triangle) {
  const hn::RebindToUnsigned<Floats> du;
  return hn::RebindMask(Floats(), hn::Ne(hn::BitCast(du, triangle), hn::Set(du, kInvalidId)));
}
/// Lanes whose `unlit` is false; `word` begins with it.
HWY_INLINE M IsLit(V word) {
  static_assert(sizeof(bool) == 1 && offsetof(Surface, unlit) % sizeof(float) == 0);
  struct Bytes {
    std::uint8_t byte[4];
  };
  constexpr auto kFirstByte = std::bit_cast<std::uint32_t>(Bytes{{0xff, 0, 0, 0}});
  const hn::RebindToUnsigned<Floats> du;
  return hn::RebindMask(
      Floats(), hn::Eq(hn::And(hn::BitCast(du, word), hn::Set(du, kFirstByte)), hn::Zero(du)));
}

/// Stores three values per lane interleaved, for `count` fragments.
HWY_INLINE void Give3(const V3& a, std::size_t count, Vec3* to) {
  const Floats d;
  if (count >= hn::Lanes(d)) return hn::StoreInterleaved3(a.x, a.y, a.z, d, &to->x);
  alignas(64) Vec3 part[kLightLanes];
  hn::StoreInterleaved3(a.x, a.y, a.z, d, &part[0].x);
  std::memcpy(static_cast<void*>(to), part, count * sizeof(Vec3));
}
/// The reverse; lanes after the last are 0.
HWY_INLINE V3 Take3(const Vec3* from, std::size_t count) {
  const Floats d;
  alignas(64) Vec3 part[kLightLanes] = {};
  if (count < hn::Lanes(d)) {
    std::memcpy(static_cast<void*>(part), from, count * sizeof(Vec3));
    from = part;
  }
  V3 a;
  hn::LoadInterleaved3(d, &from->x, a.x, a.y, a.z);
  return a;
}

HWY_INLINE void Store3(const V3& a, float (&columns)[3][kLightBlock], std::size_t k) {
  const Floats d;
  hn::Store(a.x, d, columns[0] + k);
  hn::Store(a.y, d, columns[1] + k);
  hn::Store(a.z, d, columns[2] + k);
}

/// SIMD version of `fresnel_schlick`.
HWY_INLINE V3 Schlick(const V3& at_normal, V at_edge, V cos_in) {
  const Floats d;
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V m = Clamp(hn::Sub(one, cos_in), 0, 1), m2 = hn::Mul(m, m);
  const V rise = hn::Mul(hn::Mul(m2, m2), m);
  const V3 rest{hn::Sub(at_edge, at_normal.x), hn::Sub(at_edge, at_normal.y),
                hn::Sub(at_edge, at_normal.z)};
  const V3 risen = Add(at_normal, Scale(rest, rise));
  const M none = hn::Le(MaxOf(at_normal), zero);
  return {hn::IfThenElse(none, zero, risen.x), hn::IfThenElse(none, zero, risen.y),
          hn::IfThenElse(none, zero, risen.z)};
}
/// SIMD version of `cos_arrival`.
HWY_INLINE V CosArrival(const V3& incoming, const V3& normal) {
  return Clamp(hn::Abs(Dot(incoming, normal)), 1e-4f, 1);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
