// Compiled once for each SIMD target and chosen at run time (Google Highway).
#include "object_tree/tree_kernels.h"

#include <cstring>
#include <limits>

#include "base/bits.h"
#include "scene/flatten_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "object_tree/tree_kernels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Words = hn::RebindToUnsigned<Floats>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

/// Triangles per batch of `measure_centers`.
constexpr std::uint32_t kBatch = 64;

struct Batch {
  alignas(64) float corner[9][kBatch];  ///< a.x, a.y, a.z, b.x, ...
};

/// Loads the corners of [first, first + count) of a run, and repeats the last up to the batch's
/// size.
HWY_INLINE void load_batch(const TriangleRun& run, std::uint32_t first, std::uint32_t count,
                           Batch* batch) {
  for (std::uint32_t i = 0; i < kBatch; ++i) {
    const std::uint32_t t = first + (i < count ? i : count - 1);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3 p =
          run.positions[run.triangles == nullptr ? std::size_t{3} * t + k : run.triangles[t][k]];
      batch->corner[3 * k][i] = p.x;
      batch->corner[3 * k + 1][i] = p.y;
      batch->corner[3 * k + 2][i] = p.z;
    }
  }
}

/// Whether one component of a cross product is certainly not zero in the sense of `has_no_area`.
/// The two products of differences, and their difference, have errors of at most gamma(4) of the
/// sum of the products' magnitudes, and of 2^-148 if they underflow; the thresholds are at least
/// sixteen times these errors. Infinite values and NaN are not certain.
template <class D, class Vec>
HWY_INLINE hn::Mask<D> surely_differ(D d, Vec p, Vec q) {
  const Vec margin = hn::Add(hn::Mul(hn::Set(d, 0x1p-20f), hn::Add(hn::Abs(p), hn::Abs(q))),
                             hn::Set(d, 0x1p-100f));
  return hn::Gt(hn::Abs(hn::Sub(p, q)), margin);
}

/// Lanes whose triangle certainly has an area.
template <class D, class Vec>
HWY_INLINE hn::Mask<D> surely_has_area(D d, const Vec (&c)[9]) {
  using hn::Mul, hn::Sub;
  const Vec ux = Sub(c[3], c[0]), uy = Sub(c[4], c[1]), uz = Sub(c[5], c[2]);
  const Vec vx = Sub(c[6], c[0]), vy = Sub(c[7], c[1]), vz = Sub(c[8], c[2]);
  return hn::Or(surely_differ(d, Mul(uy, vz), Mul(uz, vy)),
                hn::Or(surely_differ(d, Mul(uz, vx), Mul(ux, vz)),
                       surely_differ(d, Mul(ux, vy), Mul(uy, vx))));
}

HWY_INLINE V center(V a, V b, V c) {
  return hn::Add(hn::Min(hn::Min(a, b), c), hn::Max(hn::Max(a, b), c));
}

class CenterPass {
 public:
  CenterPass(CenterColumns centers, std::vector<std::uint32_t>* left_out)
      : centers_(centers), left_out_(left_out) {
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = hn::Set(Floats(), std::numeric_limits<float>::infinity());
      high_[axis] = hn::Set(Floats(), -std::numeric_limits<float>::infinity());
    }
  }

  /// Takes the first `count` lanes of a batch whose first triangle has the number `id`.
  HWY_INLINE void take(const Batch& batch, std::uint32_t count, std::uint32_t id) {
    const Floats d;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
    for (std::uint32_t i = 0; i < count; i += lanes) {
      V c[9];
      for (int k = 0; k < 9; ++k) c[k] = hn::Load(d, batch.corner[k] + i);
      M has_area = surely_has_area(d, c);
      if (left_out_ == nullptr)
        has_area = hn::Eq(hn::Zero(d), hn::Zero(d));
      else if (HWY_UNLIKELY(!hn::AllTrue(d, has_area)))
        has_area = settled(batch, i, i + lanes < count ? i + lanes : count, id, has_area);
      store(c, has_area, id + i, i + lanes <= count ? lanes : count - i);
    }
  }

  void finish(Box* bounds) const {
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = hn::GetLane(hn::MinOfLanes(Floats(), low_[axis]));
      high[axis] = hn::GetLane(hn::MaxOfLanes(Floats(), high_[axis]));
    }
    *bounds = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

 private:
  HWY_INLINE void store(const V (&c)[9], M has_area, std::uint32_t id, std::uint32_t count) {
    const Floats d;
    const V infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    for (int axis = 0; axis < 3; ++axis) {
      const V middle = center(c[axis], c[3 + axis], c[6 + axis]);
      low_[axis] = hn::Min(low_[axis], hn::IfThenElse(has_area, middle, infinity));
      high_[axis] = hn::Max(high_[axis], hn::IfThenElse(has_area, middle, hn::Neg(infinity)));
      const V marked = axis == 0 ? hn::IfThenElse(has_area, middle, hn::NaN(d)) : middle;
      if (HWY_LIKELY(count == hn::Lanes(d))) {
        hn::StoreU(marked, d, centers_.axis[axis] + id);
        continue;
      }
      HWY_ALIGN float lanes[16];
      hn::Store(marked, d, lanes);
      std::memcpy(centers_.axis[axis] + id, lanes, count * sizeof(float));
    }
  }

  /// The lanes [begin, end), decided by `has_no_area` where SIMD is not certain.
  HWY_NOINLINE M settled(const Batch& batch, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t id, M certain) {
    const Floats d;
    HWY_ALIGN float flags[16];
    hn::Store(hn::IfThenElseZero(certain, hn::Set(d, 1.0f)), d, flags);
    for (std::uint32_t i = begin; i < end; ++i) {
      if (flags[i - begin] != 0) continue;
      const auto corner = [&](int k) {
        return Vec3{batch.corner[3 * k][i], batch.corner[3 * k + 1][i], batch.corner[3 * k + 2][i]};
      };
      if (has_no_area(corner(0), corner(1), corner(2))) {
        left_out_->push_back(id + i);
      } else {
        flags[i - begin] = 1;
      }
    }
    return hn::Gt(hn::Load(d, flags), hn::Zero(d));
  }

  CenterColumns centers_;
  std::vector<std::uint32_t>* left_out_;
  V low_[3], high_[3];
};

void MeasureCenters(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                    CenterColumns centers, Box* bounds, std::vector<std::uint32_t>* left_out) {
  CenterPass pass(centers, left_out);
  Batch batch;
  source.for_each_part(begin, end,
                       [&](const TriangleRun& run, std::uint32_t first, std::uint32_t stop) {
                         for (std::uint32_t i = first; i < stop; i += kBatch) {
                           const std::uint32_t count = stop - i < kBatch ? stop - i : kBatch;
                           load_batch(run, i, count, &batch);
                           pass.take(batch, count, run.first + i);
                         }
                       });
  pass.finish(bounds);
}

template <class W>
HWY_INLINE W spread_by_3(W x) {
  const Words d;
  const auto step = [&](W v, W shifted, std::uint32_t mask) {
    return hn::And(hn::Or(v, shifted), hn::Set(d, mask));
  };
  x = step(x, hn::ShiftLeft<16>(x), 0x030000ffu);
  x = step(x, hn::ShiftLeft<8>(x), 0x0300f00fu);
  x = step(x, hn::ShiftLeft<4>(x), 0x030c30c3u);
  return step(x, hn::ShiftLeft<2>(x), 0x09249249u);
}

/// The keys' low thirty bits and those above, for a batch of centres.
HWY_INLINE void make_keys(CenterColumns centers, const MortonCurve& curve, std::uint32_t first,
                          std::uint32_t count, std::uint32_t* low, std::uint32_t* high) {
  const Floats d;
  const Words w;
  const hn::RebindToSigned<Floats> s;
  using W = hn::Vec<Words>;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const V last = hn::Set(d, static_cast<float>((1u << curve.bits) - 1));
  const W ten_bits = hn::Set(w, 0x3ffu);
  const float origin[3] = {curve.low.x, curve.low.y, curve.low.z};
  for (std::uint32_t i = 0; i < count; i += lanes) {
    W lo = hn::Zero(w), hi = hn::Zero(w);
    for (int axis = 2; axis >= 0; --axis) {
      const V c = hn::LoadU(d, centers.axis[axis] + first + i);
      const V place = hn::Mul(hn::Mul(hn::Sub(c, hn::Set(d, origin[axis])), hn::Set(d, curve.up)),
                              hn::Set(d, curve.scale));
      const W cell = hn::BitCast(w, hn::ConvertTo(s, hn::Min(place, last)));
      lo = hn::Or(hn::ShiftLeft<1>(lo), spread_by_3(hn::And(cell, ten_bits)));
      hi = hn::Or(hn::ShiftLeft<1>(hi), spread_by_3(hn::And(hn::ShiftRight<10>(cell), ten_bits)));
    }
    hn::StoreU(lo, w, low + i);
    hn::StoreU(hi, w, high + i);
  }
}

std::uint32_t WriteKeys(CenterColumns centers, const std::uint32_t* strips,
                        const MortonCurve& curve, std::uint32_t begin, std::uint32_t end,
                        std::uint32_t bucket_shift, std::uint64_t* keys,
                        std::uint32_t* bucket_counts) {
  HWY_ALIGN std::uint32_t low[kBatch], high[kBatch];
  std::uint32_t written = 0;
  for (std::uint32_t first = begin; first < end; first += kBatch) {
    const std::uint32_t count = end - first < kBatch ? end - first : kBatch;
    make_keys(centers, curve, first, count, low, high);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float x = centers.axis[0][first + i];
      if (HWY_UNLIKELY(x != x)) continue;
      const std::uint64_t key = std::uint64_t{high[i]} << 30 | low[i];
      ++bucket_counts[key >> bucket_shift];
      keys[written++] = key << curve.id_bits | (strips != nullptr ? strips[first + i] : first + i);
    }
  }
  return written;
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(MeasureCenters);
HWY_EXPORT(WriteKeys);

void measure_centers(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                     CenterColumns centers, Box* bounds, std::vector<std::uint32_t>* left_out) {
  HWY_DYNAMIC_DISPATCH(MeasureCenters)(source, begin, end, centers, bounds, left_out);
}

std::uint32_t write_keys(CenterColumns centers, const std::uint32_t* strips,
                         const MortonCurve& curve, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t bucket_shift, std::uint64_t* keys,
                         std::uint32_t* bucket_counts) {
  return HWY_DYNAMIC_DISPATCH(WriteKeys)(centers, strips, curve, begin, end, bucket_shift, keys,
                                         bucket_counts);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
