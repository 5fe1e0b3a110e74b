// Lanes of rays and lanes of boxes, and how records come into them. Included once a SIMD target by
// methods/dual/trace_simd.cpp, inside its namespace.

using Rays = hn::CappedTag<float, kBundleWidth>;
using RayInts = hn::RebindToUnsigned<Rays>;
using RV = hn::Vec<Rays>;
using RM = hn::Mask<Rays>;
using Boxes = hn::CappedTag<float, kBvhWidth>;
using BV = hn::Vec<Boxes>;

HWY_INLINE std::size_t ray_lanes() {
  return hn::Lanes(Rays());
}

HWY_INLINE RV load(const float* p) {
  return hn::Load(Rays(), p);
}
HWY_INLINE RV set(float x) {
  return hn::Set(Rays(), x);
}

/// Reads no more bytes than were written, so that the load is forwarded from the store.
template <class D, class M>
HWY_INLINE std::uint32_t bits_of(D d, M mask) {
  if constexpr (hn::MaxLanes(D()) <= 8) {
    std::uint8_t bits;
    hn::StoreMaskBits(d, mask, &bits);
    return bits;
  } else {
    std::uint8_t bytes[2];
    hn::StoreMaskBits(d, mask, bytes);
    std::uint16_t bits;
    hwy::CopyBytes<2>(bytes, &bits);
    return bits;
  }
}

HWY_INLINE RM lanes_of(std::uint32_t bits, std::size_t g) {
  const Rays d;
  const std::uint32_t from_g = bits >> g;
  std::uint8_t bytes[8] = {};
  hwy::CopyBytes<4>(&from_g, bytes);
  return hn::LoadMaskBits(d, bytes);
}

#if HWY_MAX_BYTES >= 32 && HWY_TARGET != HWY_SCALAR
#if HWY_TARGET == HWY_AVX2
/// For each choice of eight lanes their numbers, four bits each: first those that are chosen.
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

/// Moves chosen lanes to the front, in their order. Lanes behind them are the others or 0. Returns
/// how many were chosen.
template <class D>
HWY_INLINE std::uint32_t compress(D d, hn::Mask<D> chosen, hn::Vec<D>* v) {
#if HWY_TARGET == HWY_AVX2
  // As hn::Compress does it, with a table that stays where it is: gcc 12 copies that of Highway 1.0
  // to the stack for each call.
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

/// Clamps away from zero, keeping the sign, so that the inverse is finite.
HWY_INLINE RV inverse_slope(RV slope) {
  const RV tiny = set(1e-20f);
  const RV safe = hn::Max(hn::Abs(slope), tiny);
  return hn::Div(hn::CopySign(set(1), slope), safe);
}
inline float inverse_slope(float slope) {
  const float size = std::fabs(slope) > 1e-20f ? std::fabs(slope) : 1e-20f;
  return std::copysign(1.0f, slope) / size;
}
#if HWY_TARGET != HWY_SCALAR
/// Blocks of four lanes that a vector has, block k from the four floats at `at(k)`.
inline constexpr std::size_t kBlocks = hn::MaxLanes(Rays()) / 4;
template <class At>
HWY_INLINE RV load_blocks(const At& at) {
  const Rays d;
  if constexpr (kBlocks == 4) {
    const hn::Half<Rays> d8;
    const hn::Half<hn::Half<Rays> > d4;
    return hn::Combine(d, hn::Combine(d8, hn::LoadU(d4, at(3)), hn::LoadU(d4, at(2))),
                       hn::Combine(d8, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0))));
  } else if constexpr (kBlocks == 2) {
    const hn::Half<Rays> d4;
    return hn::Combine(d, hn::LoadU(d4, at(1)), hn::LoadU(d4, at(0)));
  } else {
    return hn::LoadU(d, at(0));
  }
}
#endif

/// Four floats of a record each for as many records as a vector has lanes: field k of list[i] comes
/// to lane i of fk. In registers: what was stored in parts cannot be loaded whole at once.
template <class Record>
HWY_INLINE void gather4(const Record* records, int quad, const std::uint32_t* list, RV& f0, RV& f1,
                        RV& f2, RV& f3) {
  static_assert(sizeof(Record) % 16 == 0);
  const Rays d;
  const auto at = [&](std::size_t i) {
    return reinterpret_cast<const float*>(records + list[i]) + 4 * quad;
  };
#if HWY_TARGET == HWY_SCALAR
  const float* from = at(0);
  f0 = hn::Set(d, from[0]);
  f1 = hn::Set(d, from[1]);
  f2 = hn::Set(d, from[2]);
  f3 = hn::Set(d, from[3]);
#else
  // Vector j has the records j, 4 + j, 8 + j, ... in its blocks of four lanes.
  const auto blocks = [&](std::size_t j) __attribute__((always_inline)) {
    return load_blocks([&](std::size_t k) __attribute__((always_inline)) { return at(4 * k + j); });
  };
  const RV a = blocks(0), b = blocks(1), c = blocks(2), e = blocks(3);
  const hn::Repartition<std::uint64_t, Rays> d64;
  const auto low = [&](RV x, RV y) { return hn::BitCast(d64, hn::InterleaveLower(x, y)); };
  const auto high = [&](RV x, RV y) { return hn::BitCast(d64, hn::InterleaveUpper(d, x, y)); };
  f0 = hn::BitCast(d, hn::InterleaveLower(low(a, b), low(c, e)));
  f1 = hn::BitCast(d, hn::InterleaveUpper(d64, low(a, b), low(c, e)));
  f2 = hn::BitCast(d, hn::InterleaveLower(high(a, b), high(c, e)));
  f3 = hn::BitCast(d, hn::InterleaveUpper(d64, high(a, b), high(c, e)));
#endif
}

/// The opposite for records that stand together: lane i of fk goes to field k of records[i].
template <class Record>
HWY_INLINE void store4(RV f0, RV f1, RV f2, RV f3, int quad, Record* records) {
  static_assert(sizeof(Record) % 16 == 0);
  const Rays d;
  const auto at = [&](std::size_t i) { return reinterpret_cast<float*>(records + i) + 4 * quad; };
#if HWY_TARGET == HWY_SCALAR
  float* to = at(0);
  to[0] = hn::GetLane(f0);
  to[1] = hn::GetLane(f1);
  to[2] = hn::GetLane(f2);
  to[3] = hn::GetLane(f3);
  static_cast<void>(d);
#else
  const auto store_blocks = [&](RV v, std::size_t j) __attribute__((always_inline)) {
    if constexpr (hn::MaxLanes(Rays()) == 16) {
      const hn::Half<Rays> d8;
      const hn::Half<hn::Half<Rays> > d4;
      const auto low = hn::LowerHalf(d8, v), high = hn::UpperHalf(d8, v);
      hn::Store(hn::LowerHalf(d4, low), d4, at(j));
      hn::Store(hn::UpperHalf(d4, low), d4, at(4 + j));
      hn::Store(hn::LowerHalf(d4, high), d4, at(8 + j));
      hn::Store(hn::UpperHalf(d4, high), d4, at(12 + j));
    } else if constexpr (hn::MaxLanes(Rays()) == 8) {
      const hn::Half<Rays> d4;
      hn::Store(hn::LowerHalf(d4, v), d4, at(j));
      hn::Store(hn::UpperHalf(d4, v), d4, at(4 + j));
    } else {
      hn::Store(v, d, at(j));
    }
  };
  const hn::Repartition<std::uint64_t, Rays> d64;
  const auto as64 = [&](RV v) { return hn::BitCast(d64, v); };
  const auto a = as64(hn::InterleaveLower(f0, f1)), b = as64(hn::InterleaveLower(f2, f3));
  const auto c = as64(hn::InterleaveUpper(d, f0, f1)), e = as64(hn::InterleaveUpper(d, f2, f3));
  store_blocks(hn::BitCast(d, hn::InterleaveLower(a, b)), 0);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, a, b)), 1);
  store_blocks(hn::BitCast(d, hn::InterleaveLower(c, e)), 2);
  store_blocks(hn::BitCast(d, hn::InterleaveUpper(d64, c, e)), 3);
#endif
}
