// Tests the triangles of one tile with its bundles, and with the rays of the bundles that they
// overlap. Compiled once for each SIMD target and chosen at run time (Google Highway).
//
// Runs stage 1 of the ray-triangle test (intersect/triangle_body.h) for 16 rays at once; rays that
// it does not decide go to stage 2. Rays that were hit are removed, and bundles without rays, too.
#include <algorithm>
#include <bit>

#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/fan/tile_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "intersect/values-inl.h"
#include "methods/fan/overlap-inl.h"
#include "methods/fan/stream.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

struct Corner {
  V x, y, z;
};

HWY_INLINE V Edge(const Corner& p, const Corner& q) {
  return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
}

/// Lanes that are hit, by the side of the hit, and those that stage 2 must decide.
struct Verdict {
  std::uint32_t front = 0, back = 0, unsettled = 0;
};

class Tile {
 public:
  Tile(const FanTileTask& task, std::uint32_t tile)
      : task_(task),
        c_(task.cells),
        face_(fan_face(c_.face_of_tile[tile])),
        slot_(std::size_t{tile} * kTileSlots) {
    const std::uint32_t rays = c_.rays_of_tile[tile];
    for (std::uint32_t p = 0; p * kBundleSlots < rays; ++p) {
      alive_[p] = (1u << std::min(kBundleSlots, rays - p * kBundleSlots)) - 1;
      bundles_ |= 1u << p;
    }
    const float* const origin = &c_.origin.x;
    std::fill_n(origin_[0], kBundleSlots, origin[face_.x]);
    std::fill_n(origin_[1], kBundleSlots, origin[face_.y]);
    std::fill_n(origin_[2], kBundleSlots, origin[face_.z]);
    place(c_.tiles.at(tile), std::size_t{tile} * kTileBundles);
    if (!task_.ray_tests.empty()) {
      std::fill_n(bundle_tests_, kTileBundles, 0u);
      std::fill_n(tests_, kTileSlots, 0u);
    }
  }

  FanTileCounts run(View<const FanTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size && bundles_ != 0; i += kBundleSlots) {
      triangles_ = triangles.data + i;
      const auto count =
          static_cast<std::uint32_t>(std::min<std::size_t>(triangles.size - i, kBundleSlots));
      prepare(count);
      for (std::uint32_t lane = 0; lane < count && bundles_ != 0; ++lane) meet(lane);
    }
    finish();
    return counts_;
  }

 private:
  /// Stores bundles' rectangles relative to the tile's middle, around which the edges are written.
  void place(const FanBound& bound, std::size_t bundle) {
    s0_ = (bound.u0 + bound.u1) * 0.5f, r0_ = (bound.v0 + bound.v1) * 0.5f;
    radius_ = std::max(bound.u1 - bound.u0, bound.v1 - bound.v0);  // larger than necessary
    const FanBounds& b = c_.bundles;
    for (std::uint32_t p = 0; p < kTileBundles; ++p) {
      du0_[p] = b.u0[bundle + p] - s0_, du1_[p] = b.u1[bundle + p] - s0_;
      dv0_[p] = b.v0[bundle + p] - r0_, dv1_[p] = b.v1[bundle + p] - r0_;
    }
    columns_ = {b.u0.data() + bundle,
                b.u1.data() + bundle,
                b.v0.data() + bundle,
                b.v1.data() + bundle,
                b.reach.data() + bundle,
                du0_,
                du1_,
                dv0_,
                dv1_};
  }

  void prepare(std::uint32_t count) {
    const Floats d;
    const float o[3] = {component(c_.origin, static_cast<int>(face_.x)),
                        component(c_.origin, static_cast<int>(face_.y)),
                        component(c_.origin, static_cast<int>(face_.z))};
    for (std::uint32_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        const float* p = &triangles_[k].corners[i].x;
        t_.corner[i][0][k] = p[face_.x] - o[0];
        t_.corner[i][1][k] = p[face_.y] - o[1];
        t_.corner[i][2][k] = p[face_.z] - o[2];
      }
      const auto& [a, b, c] = triangles_[k].corners;
      reach_[k] = reach_of(a, b, c);
    }
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
      V x[3], y[3], z[3];
      for (int i = 0; i < 3; ++i) {
        x[i] = hn::Load(d, t_.corner[i][0] + k);
        y[i] = hn::Load(d, t_.corner[i][1] + k);
        z[i] = hn::Load(d, t_.corner[i][2] + k);
      }
      MakeRectangles(x, y, z, face_.sign, k, &t_);
      MakeEdges(x, y, z, s0_, r0_, radius_, k, &t_);
    }
  }

  /// Tests one triangle with all bundles that have rays left.
  HWY_INLINE void meet(std::uint32_t lane) {
    const Floats d;
    std::uint32_t met = 0;
    for (std::size_t p = 0; p < kTileBundles; p += hn::Lanes(d)) {
      const M mask = RectanglesMeet(columns_, p, t_, lane);
      if (hn::AllFalse(d, mask)) continue;
      met |= BitsOf(hn::And(mask, EdgesMeet(columns_, p, t_, lane))) << p;
    }
    counts_.bound_tests += static_cast<std::uint32_t>(std::popcount(bundles_));
    if (!task_.ray_tests.empty()) count_bundles();
    const bool single = task_.facing != Facing::kBoth && task_.source.flags != nullptr;
    for (met &= bundles_; met != 0; met &= met - 1) {
      const auto p = static_cast<std::uint32_t>(std::countr_zero(met));
      if (!task_.ray_tests.empty()) count_rays(p);
      counts_.triangle_tests += static_cast<std::uint32_t>(std::popcount(alive_[p]));
      const Verdict verdict = test(p, lane);
      const std::uint32_t any = (verdict.front | verdict.back | verdict.unsettled) & alive_[p];
      if (HWY_LIKELY(any == 0)) continue;
      take(p, lane, verdict, single);
    }
  }

  void take(std::uint32_t p, std::uint32_t lane, const Verdict& verdict, bool single) {
    std::uint32_t hits = verdict.front | verdict.back;
    if (single) {
      const std::uint8_t flags = task_.source.flags[triangles_[lane].id];
      hits = (shows(task_.facing, flags, true) ? verdict.front : 0) |
             (shows(task_.facing, flags, false) ? verdict.back : 0);
    }
    std::uint32_t rest = verdict.unsettled & alive_[p];
    if (rest != 0) rest &= ~beyond(p, lane);
    for (; rest != 0; rest &= rest - 1) {
      const auto ray = static_cast<std::uint32_t>(std::countr_zero(rest));
      hits |= settle(p * kBundleSlots + ray, lane, single) ? 1u << ray : 0;
    }
    alive_[p] &= ~hits;
    if (alive_[p] == 0) bundles_ &= ~(1u << p);
  }

  /// Rays of a bundle that intersect the triangle's plane outside their intervals, such as those
  /// that end on it.
  HWY_NOINLINE std::uint32_t beyond(std::uint32_t p, std::uint32_t lane) const {
    const FanRays& r = c_.rays;
    const std::size_t at = slot_ + p * kBundleSlots;
    const auto along_axes = [&](const Vec3& v) {
      const float* x = &v.x;
      return Vec3{x[face_.x], x[face_.y], x[face_.z]};
    };
    const auto& [a, b, c] = triangles_[lane].corners;
    return lanes_beyond(
        kBundleSlots,
        {origin_[0], origin_[1], origin_[2], r.shear_x.data() + at, r.shear_y.data() + at,
         r.shear_z.data() + at, r.t_min.data() + at, r.t_max.data() + at},
        along_axes(a), along_axes(b), along_axes(c));
  }

  /// Stages 2 and 3.
  bool settle(std::uint32_t slot, std::uint32_t lane, bool single) const {
    const Ray& ray = task_.rays[c_.rays.ray[slot_ + slot]];
    TriangleHit hit;
    const auto& [a, b, c] = triangles_[lane].corners;
    return line_meets_triangle(ray.origin, ray.direction, a, b, c, &hit) &&
           is_within(hit.t, ray.t_min, ray.t_max) &&
           (!single || shows(task_.facing, task_.source.flags[triangles_[lane].id], hit.front));
  }

  HWY_INLINE Corner corner(int i, std::uint32_t lane, V shear_x, V shear_y) const {
    const Floats d;
    const V z = hn::Set(d, t_.corner[i][2][lane]);
    return {hn::Sub(hn::Set(d, t_.corner[i][0][lane]), hn::Mul(shear_x, z)),
            hn::Sub(hn::Set(d, t_.corner[i][1][lane]), hn::Mul(shear_y, z)), z};
  }

  /// Tests the rays of a bundle, whether they are left or not.
  HWY_INLINE Verdict test(std::uint32_t p, std::uint32_t lane) const {
    using hn::Abs, hn::Add, hn::And, hn::Ge, hn::Gt, hn::Le, hn::Lt, hn::Max, hn::Min, hn::Mul,
        hn::Neg, hn::Or;
    const Floats d;
    const auto all = [&](float x) { return hn::Set(d, x); };
    const FanRays& r = c_.rays;
    const V reach = all(reach_[lane]);
    const V edge_error = all(kErrorOfReach * reach_[lane]);
    Verdict verdict;
    for (std::size_t k = 0; k < kBundleSlots; k += hn::Lanes(d)) {
      const std::size_t at = slot_ + p * kBundleSlots + k;
      const V sx = hn::Load(d, r.shear_x.data() + at), sy = hn::Load(d, r.shear_y.data() + at);
      const Corner a = corner(0, lane, sx, sy), b = corner(1, lane, sx, sy),
                   c = corner(2, lane, sx, sy);
      const V u = Edge(c, b), v = Edge(a, c), w = Edge(b, a);
      const V extent = Add(Abs(a.z), reach);
      const V error = Mul(extent, Add(Mul(all(kErrorOfSquare), extent), edge_error));
      const V least = Min(Min(u, v), w), most = Max(Max(u, v), w);
      const M possible = hn::Not(Gt(Min(Neg(least), most), error));
      const M reaches = Ge(hn::Load(d, r.reach.data() + at), all(t_.depth[lane]));
      const M asked = And(possible, reaches);
      if (HWY_LIKELY((BitsOf(asked) & alive_[p] >> k) == 0)) continue;
      const V det = Add(Add(u, v), w), size = Abs(det), per_det = hn::Div(all(1), det);
      const V sz = hn::Load(d, r.shear_z.data() + at);
      const V distance = Add(Add(Mul(u, Mul(sz, a.z)), Mul(v, Mul(sz, b.z))), Mul(w, Mul(sz, c.z)));
      const V t = Mul(distance, per_det), far = Abs(distance);
      const V half =
          Mul(Abs(sz), Add(Mul(Mul(all(kErrorOfWeights), Mul(error, reach)), Abs(per_det)),
                           Mul(all(kErrorOfDepth), extent)));
      const V low = hn::Sub(t, half), high = Add(t, half);
      const M normal = And(And(Ge(size, all(kSmallDeterminant)), Le(size, all(kLargeDeterminant))),
                           And(And(Ge(far, all(kSmallDistance)), Le(far, all(kLargeDeterminant))),
                               Ge(half, all(kSmallInterval))));
      const M sure = And(Gt(Max(least, Neg(most)), error), normal);
      const V t_min = hn::Load(d, r.t_min.data() + at), t_max = hn::Load(d, r.t_max.data() + at);
      const M hit = And(And(sure, reaches), And(Ge(low, t_min), Le(high, t_max)));
      const M beyond = And(sure, Or(Lt(high, t_min), Gt(low, t_max)));
      verdict.front |= BitsOf(And(hit, Gt(det, hn::Zero(d)))) << k;
      verdict.back |= BitsOf(And(hit, Lt(det, hn::Zero(d)))) << k;
      verdict.unsettled |= BitsOf(hn::AndNot(Or(hit, beyond), asked)) << k;
    }
    return verdict;
  }

  void count_bundles() {
    for (std::uint32_t rest = bundles_; rest != 0; rest &= rest - 1)
      ++bundle_tests_[std::countr_zero(rest)];
  }

  void count_rays(std::uint32_t p) {
    for (std::uint32_t rest = alive_[p]; rest != 0; rest &= rest - 1)
      ++tests_[p * kBundleSlots + static_cast<std::uint32_t>(std::countr_zero(rest))];
  }

  void finish() {
    const std::uint32_t count = c_.rays_of_tile[slot_ / kTileSlots];
    const std::uint32_t* rays = c_.rays.ray.data() + slot_;
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t alive = alive_[k / kBundleSlots] >> (k % kBundleSlots) & 1;
      task_.occluded.data[rays[k]] = static_cast<std::uint8_t>(alive ^ 1);
    }
    if (task_.ray_tests.empty()) return;
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t p = k / kBundleSlots;
      const std::uint32_t sharers = std::min(kBundleSlots, count - p * kBundleSlots);
      task_.ray_tests[rays[k]] +=
          static_cast<float>(tests_[k]) +
          static_cast<float>(bundle_tests_[p]) / static_cast<float>(sharers);
    }
  }

  const FanTileTask& task_;
  const FanCells& c_;
  const FanFace face_;
  const std::size_t slot_;
  float s0_, r0_, radius_;
  const FanTriangle* triangles_ = nullptr;  ///< up to 16, one lane each
  std::uint32_t alive_[kTileBundles] = {};
  std::uint32_t bundles_ = 0;  ///< bundles with rays left
  FanTileCounts counts_;
  std::uint32_t bundle_tests_[kTileBundles], tests_[kTileSlots];  ///< if requested
  BoundColumns columns_;
  alignas(64) float du0_[kTileBundles], du1_[kTileBundles], dv0_[kTileBundles], dv1_[kTileBundles];
  alignas(64) float origin_[3][kBundleSlots];  ///< of all rays, along the face's axes
  TriangleLanes t_;
  float reach_[kBundleSlots];  ///< of the triangles
};

FanTileCounts RunTile(const FanTileTask& task, std::uint32_t tile,
                      View<const FanTriangle> triangles) {
  return Tile(task, tile).run(triangles);
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(RunTile);

FanTileCounts fan_tile(const FanTileTask& task, std::uint32_t tile,
                       View<const FanTriangle> triangles) {
  return HWY_DYNAMIC_DISPATCH(RunTile)(task, tile, triangles);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
