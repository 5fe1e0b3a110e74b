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

#include "base/lanes-inl.h"
#include "render/rays/point_light.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLightLanes>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

using V3 = Lanes3<V>;

HWY_INLINE V3 Splat(Vec3 a) {
  return all3(Floats(), a);
}
HWY_INLINE V3 Load3(const float (&columns)[3][kLightBlock], std::size_t k) {
  const Floats d;
  return {hn::Load(d, columns[0] + k), hn::Load(d, columns[1] + k), hn::Load(d, columns[2] + k)};
}
/// Treats NaN like `max_component`.
HWY_INLINE V MaxOf(const V3& a) {
  return larger(larger(a.x, a.y), a.z);
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

  /// Consecutive words: loading them one by one takes twice as long. The compiler removes unused
  /// ones.
  template <std::size_t kFirst>
  [[nodiscard]] HWY_INLINE FourWords Four() const {
    FourWords words;
    const auto at = [&](std::size_t lane) HWY_ATTR { return place_.WordsAt(lane) + kFirst; };
    gather4(Floats(), at, words.word[0], words.word[1], words.word[2], words.word[3]);
    return words;
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
  const V3 rest = minus(V3{at_edge, at_edge, at_edge}, at_normal);
  const V3 risen = plus(at_normal, times(rest, rise));
  const M none = hn::Le(MaxOf(at_normal), zero);
  return select(none, {zero, zero, zero}, risen);
}
/// SIMD version of `cos_arrival`.
HWY_INLINE V CosArrival(const V3& incoming, const V3& normal) {
  return Clamp(hn::Abs(dot(incoming, normal)), 1e-4f, 1);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
