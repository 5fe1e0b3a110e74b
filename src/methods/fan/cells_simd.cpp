// Keys and gathering of rays, compiled once for each SIMD target and chosen at run time (Google
// Highway).
#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/float.h"
#include "methods/fan/cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fan/cells_simd.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kBundleSlots>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using M = hn::Mask<Floats>;

/// floor((c + 1) / 2 * 2^bits), clamped to the face. Monotonic, because every operation is.
HWY_INLINE I Quantized(V c, float half, float last) {
  const Floats d;
  const V scaled = hn::Mul(hn::Add(c, hn::Set(d, 1.0f)), hn::Set(d, half));
  return hn::ConvertTo(Ints(), hn::Max(hn::Min(scaled, hn::Set(d, last)), hn::Zero(d)));
}

/// The position of a cell along the Hilbert curve (J. Skilling 2004, "Programming the Hilbert
/// Curve"; here by quadrant, most significant first).
HWY_INLINE I Hilbert(I x, I y, std::uint32_t bits) {
  const Ints d;
  const I one = hn::Set(d, 1);
  I place = hn::Zero(d);
  for (std::uint32_t bit = bits; bit-- > 0;) {
    const I rx = hn::And(hn::ShiftRightSame(x, static_cast<int>(bit)), one);
    const I ry = hn::And(hn::ShiftRightSame(y, static_cast<int>(bit)), one);
    const I quadrant = hn::Xor(hn::Or(hn::Add(rx, rx), rx), ry);
    place = hn::Or(hn::ShiftLeft<2>(place), quadrant);
    const I swap = hn::Sub(ry, one);  // all ones if ry is 0
    const I flip = hn::And(swap, hn::Neg(rx));
    x = hn::Xor(x, flip);
    y = hn::Xor(y, flip);
    const I differ = hn::And(hn::Xor(x, y), swap);
    x = hn::Xor(x, differ);
    y = hn::Xor(y, differ);
  }
  return place;
}

struct RayLanes {
  V ox, oy, oz;
  V x, y, z, t_min, t_max;
};

HWY_INLINE RayLanes LoadRays(const Ray* rays) {
  static_assert(sizeof(Ray) == 8 * sizeof(float));
  const Floats d;
#if HWY_TARGET == HWY_SCALAR
  return {hn::Set(d, rays->origin.x),    hn::Set(d, rays->origin.y),
          hn::Set(d, rays->origin.z),    hn::Set(d, rays->direction.x),
          hn::Set(d, rays->direction.y), hn::Set(d, rays->direction.z),
          hn::Set(d, rays->t_min),       hn::Set(d, rays->t_max)};
#else
  const float* p = &rays->origin.x;
  V a0, a1, a2, a3, b0, b1, b2, b3;
  hn::LoadInterleaved4(d, p, a0, a1, a2, a3);
  hn::LoadInterleaved4(d, p + 4 * hn::Lanes(d), b0, b1, b2, b3);
  return {hn::ConcatEven(d, b0, a0), hn::ConcatEven(d, b1, a1), hn::ConcatEven(d, b2, a2),
          hn::ConcatOdd(d, b0, a0),  hn::ConcatOdd(d, b1, a1),  hn::ConcatOdd(d, b2, a2),
          hn::ConcatEven(d, b3, a3), hn::ConcatOdd(d, b3, a3)};
#endif
}

struct KeyState {
  V origin[3];
  I differs;  ///< bits in which any origin differs
  M forward;
  V largest;
};

/// The comparisons and quotients of `make_ray_setup`.
HWY_INLINE I KeysOf(const RayLanes& r, std::uint32_t bits, KeyState* state) {
  const Floats d;
  const Ints di;
  const auto difference = [&](V a, V b) { return hn::Xor(hn::BitCast(di, a), hn::BitCast(di, b)); };
  state->differs = hn::Or(state->differs, hn::Or3(difference(r.ox, state->origin[0]),
                                                  difference(r.oy, state->origin[1]),
                                                  difference(r.oz, state->origin[2])));
  const V mx = hn::Abs(r.x), my = hn::Abs(r.y), mz = hn::Abs(r.z);
  const M x_over_y = hn::Gt(mx, my);
  const M is_x = hn::And(x_over_y, hn::Gt(mx, mz));
  const M is_y = hn::AndNot(x_over_y, hn::Gt(my, mz));
  const V along = hn::IfThenElse(is_x, r.x, hn::IfThenElse(is_y, r.y, r.z));
  const V first = hn::IfThenElse(is_x, r.y, hn::IfThenElse(is_y, r.z, r.x));
  const V second = hn::IfThenElse(is_x, r.z, hn::IfThenElse(is_y, r.x, r.y));
  const M negative = hn::Lt(along, hn::Zero(d));
  const V u = hn::Div(hn::IfThenElse(negative, second, first), along);
  const V v = hn::Div(hn::IfThenElse(negative, first, second), along);
  const M live = hn::And(hn::And(hn::Eq(u, u), hn::Eq(v, v)), hn::Le(r.t_min, r.t_max));
  state->forward = hn::And(state->forward, hn::Or(hn::Ge(r.t_min, hn::Zero(d)), hn::Not(live)));
  state->largest = hn::Max(state->largest, hn::IfThenElseZero(live, hn::Abs(along)));
  const auto half = static_cast<float>(1u << (bits - 1));
  const auto last = static_cast<float>((1u << bits) - 1);
  const I place = Hilbert(Quantized(u, half, last), Quantized(v, half, last), bits);
  const I axis =
      hn::IfThenElse(hn::RebindMask(di, is_x), hn::Zero(di),
                     hn::IfThenElse(hn::RebindMask(di, is_y), hn::Set(di, 2), hn::Set(di, 4)));
  const I side = hn::IfThenElseZero(hn::RebindMask(di, negative), hn::Set(di, 1));
  const I face = hn::IfThenElse(hn::RebindMask(di, live), hn::Or(axis, side),
                                hn::Set(di, static_cast<std::int32_t>(kDeadFace)));
  const I low = hn::IfThenElseZero(hn::RebindMask(di, live), place);
  return hn::Or(hn::ShiftLeftSame(face, static_cast<int>(2 * bits)), low);
}

void Keys(const Ray* rays, std::size_t begin, std::size_t end, std::uint32_t bits,
          std::uint32_t* keys, FanRange* range) {
  assert(bits > 0);
  const Floats d;
  const Ints di;
  const std::size_t lanes = hn::Lanes(d);
  const Vec3 origin = rays[0].origin;
  KeyState state{{hn::Set(d, origin.x), hn::Set(d, origin.y), hn::Set(d, origin.z)},
                 hn::Zero(di),
                 hn::Eq(hn::Zero(d), hn::Zero(d)),
                 hn::Zero(d)};
  auto* out = reinterpret_cast<std::int32_t*>(keys);
  std::size_t i = begin;
  for (; i + lanes <= end; i += lanes)
    hn::StoreU(KeysOf(LoadRays(rays + i), bits, &state), di, out + i);
  if (i < end) {
    Ray rest[kBundleSlots];
    std::int32_t rest_keys[kBundleSlots];
    for (std::size_t k = 0; k < lanes; ++k) rest[k] = rays[std::min(i + k, end - 1)];
    hn::StoreU(KeysOf(LoadRays(rest), bits, &state), di, rest_keys);
    std::copy_n(rest_keys, end - i, out + i);
  }
  range->one_origin = hn::AllTrue(di, hn::Eq(state.differs, hn::Zero(di)));
  range->forward = hn::AllTrue(d, state.forward);
  range->largest_along = hn::GetLane(hn::MaxOfLanes(d, state.largest));
}

/// Merges consecutive slots with the same cell, and updates the grid when the next cell comes. The
/// first and the last cell of a task go to the seam.
class CellRuns {
 public:
  CellRuns(FanCells* cells, FanSeam* seam) : cells_(cells), seam_(seam) {}
  ~CellRuns() {
    if (at_ == FanSeam::kNone) return;
    const int end = seam_->at[0] == FanSeam::kNone ? 0 : 1;
    seam_->at[end] = at_, seam_->cell[end] = cell_;
  }
  CellRuns(const CellRuns&) = delete;
  CellRuns& operator=(const CellRuns&) = delete;

  void add(std::size_t at, float reach, std::uint32_t tile) {
    if (at != at_) flush(at);
    cell_.include({reach, tile, tile});
  }

 private:
  void flush(std::size_t next) {
    if (at_ != FanSeam::kNone) {
      if (seam_->at[0] == FanSeam::kNone)
        seam_->at[0] = at_, seam_->cell[0] = cell_;
      else
        cells_->cells[at_] = cell_;
    }
    at_ = next;
    cell_ = {};
  }

  FanCells* cells_;
  FanSeam* seam_;
  std::size_t at_ = FanSeam::kNone;
  FanCell cell_;
};

/// An upper bound, except for one rounding, of the distance of a hit along the axis: see
/// methods/fan/stream_simd.cpp. Infinite for directions so short or long that quotients lose bits.
HWY_INLINE V ReachOf(V along, V t_max) {
  const Floats d;
  const V size = hn::Abs(along);
  const V reach = hn::Mul(hn::Max(t_max, hn::Set(d, 0x1p-60f)), size);
  const M tame = hn::And(hn::Ge(size, hn::Set(d, 0x1p-60f)), hn::Le(size, hn::Set(d, 0x1p100f)));
  const M known = hn::And(tame, hn::Ge(reach, hn::Zero(d)));
  return hn::IfThenElse(known, reach, hn::Set(d, std::numeric_limits<float>::infinity()));
}

/// Fills one bundle: `count` of its slots have the rays in `order`; the others repeat the last.
HWY_INLINE FanBound GatherPacket(const Ray* rays, const std::uint32_t* order, std::uint32_t count,
                                 const FanFace& face, std::size_t slot, FanCells* c,
                                 std::int32_t* cell) {
  const Floats d;
  const Ints di;
  alignas(64) float x[kBundleSlots], y[kBundleSlots], z[kBundleSlots];
  for (std::uint32_t k = 0; k < kBundleSlots; ++k) {
    const std::uint32_t ray = order[std::min(k, count - 1)];
    const float* direction = &rays[ray].direction.x;
    x[k] = direction[face.x], y[k] = direction[face.y], z[k] = direction[face.z];
    c->rays.t_min[slot + k] = rays[ray].t_min;
    c->rays.t_max[slot + k] = rays[ray].t_max;
    c->rays.ray[slot + k] = ray;
  }
  const auto half = static_cast<float>(1u << (c->axis_bits - 1));
  const auto last = static_cast<float>((1u << c->axis_bits) - 1);
  const int shift = static_cast<int>(c->axis_bits - c->level);
  FanBound bound;
  for (std::size_t k = 0; k < kBundleSlots; k += hn::Lanes(d)) {
    const V along = hn::Load(d, z + k);
    const V u = hn::Div(hn::Load(d, x + k), along), v = hn::Div(hn::Load(d, y + k), along);
    hn::Store(u, d, c->rays.shear_x.data() + slot + k);
    hn::Store(v, d, c->rays.shear_y.data() + slot + k);
    hn::Store(hn::Div(hn::Set(d, 1.0f), along), d, c->rays.shear_z.data() + slot + k);
    const V reach = ReachOf(along, hn::Load(d, c->rays.t_max.data() + slot + k));
    hn::Store(reach, d, c->rays.reach.data() + slot + k);
    bound.include({hn::GetLane(hn::MinOfLanes(d, u)), hn::GetLane(hn::MaxOfLanes(d, u)),
                   hn::GetLane(hn::MinOfLanes(d, v)), hn::GetLane(hn::MaxOfLanes(d, v)),
                   hn::GetLane(hn::MaxOfLanes(d, reach))});
    const I cx = hn::ShiftRightSame(Quantized(u, half, last), shift);
    const I cy = hn::ShiftRightSame(Quantized(v, half, last), shift);
    hn::Store(hn::Or(hn::ShiftLeftSame(cy, static_cast<int>(c->level)), cx), di, cell + k);
  }
  return bound;
}

/// Prefetch distance in slots: the rays are scattered over the batch.
constexpr std::uint32_t kPrefetch = 64;

/// Prefetches the bundle that is this far ahead, out of `left` slots from `order` on.
HWY_INLINE void Prefetch(const Ray* rays, const std::uint32_t* order, std::uint32_t left) {
  const std::uint32_t end = std::min(left, kPrefetch + kBundleSlots);
  for (std::uint32_t k = kPrefetch; k < end; ++k) hwy::Prefetch(rays + order[k]);
}

void Gather(const Ray* rays, FanCells* c, std::uint32_t begin_tile, std::uint32_t end_tile,
            FanSeam* seam) {
  alignas(64) std::int32_t cell[kBundleSlots];
  CellRuns runs(c, seam);
  for (std::uint32_t tile = begin_tile; tile < end_tile; ++tile) {
    const std::uint32_t f = c->face_of_tile[tile], count = c->rays_of_tile[tile];
    const FanFaceRays& face = c->faces[f];
    const std::size_t grid = FanCells::cell_at(c->level, f, 0, 0);
    // A group's last tiles may be beyond the face's rays.
    const std::uint32_t left =
        count > 0 ? face.ray_count - (tile - face.first_tile) * kTileSlots : 0;
    const std::uint32_t* order = c->order.data() + face.first_ray + face.ray_count - left;
    FanBound tile_bound;
    for (std::uint32_t p = 0; p < kTileBundles; ++p) {
      const std::uint32_t first = p * kBundleSlots;
      const std::uint32_t n = first < count ? std::min(count - first, kBundleSlots) : 0;
      FanBound bound;
      if (n > 0) {
        Prefetch(rays, order + first, left - first);
        bound = GatherPacket(rays, order + first, n, fan_face(f),
                             std::size_t{tile} * kTileSlots + first, c, cell);
        if (cell[0] == cell[n - 1]) {  // the curve does not return to a cell
          runs.add(grid + static_cast<std::uint32_t>(cell[0]), bound.reach, tile);
        } else {
          const float* reach = c->rays.reach.data() + std::size_t{tile} * kTileSlots + first;
          for (std::uint32_t k = 0; k < n; ++k)
            runs.add(grid + static_cast<std::uint32_t>(cell[k]), reach[k], tile);
        }
      }
      c->bundles.set(std::size_t{tile} * kTileBundles + p, bound);
      tile_bound.include(bound);
    }
    c->tiles.set(tile, tile_bound);
  }
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(Keys);
HWY_EXPORT(Gather);

void fan_keys(const Ray* rays, std::size_t begin, std::size_t end, std::uint32_t axis_bits,
              std::uint32_t* keys, FanRange* range) {
  HWY_DYNAMIC_DISPATCH(Keys)(rays, begin, end, axis_bits, keys, range);
}

void fan_gather(const Ray* rays, FanCells* cells, std::uint32_t begin_tile, std::uint32_t end_tile,
                FanSeam* seam) {
  HWY_DYNAMIC_DISPATCH(Gather)(rays, cells, begin_tile, end_tile, seam);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
