// A ray in the space of a tree, as tests with its boxes and triangles need it. Three lanes of a
// vector are the axes. No branch depends on the direction, because rays go in all directions.
// Included once for each SIMD target by levels/trace_levels_simd.cpp, inside its namespace.

using Axes64 = hn::CappedTag<double, 4>;
using Axes32 = hn::Rebind<float, Axes64>;

/// A box that rays enter.
struct EnteredBox {
  alignas(32) float low[4] = {}, high[4] = {};
  Growth growth;
  float size = 0;  ///< the largest coordinate

  EnteredBox() = default;
  explicit EnteredBox(const Box& box)
      : growth(box), size(max_component(max(abs(box.min), abs(box.max)))) {
    for (int axis = 0; axis < 3; ++axis)
      low[axis] = component(box.min, axis), high[axis] = component(box.max, axis);
  }
};

/// As `LongRay`.
struct AxesRay {
  alignas(32) double origin[4], direction[4];
  double error;

  AxesRay(const Ray& ray, float from, float size) : error(0x1p-48 * (double{from} + size)) {
    const Axes64 d;
    const float* const at = reinterpret_cast<const float*>(&ray);
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      hn::Store(hn::PromoteTo(d, hn::LoadU(Axes32(), at + g)), d, origin + g);
      hn::Store(hn::PromoteTo(d, hn::LoadU(Axes32(), at + 4 + g)), d, direction + g);
    }
  }
  /// In the space of a mesh.
  AxesRay(const Ray& ray, float from, const Placing& placing) : error(placing.ray_error(from)) {
    const Axes64 d;
    const auto& m = placing.map.m;
    const auto image = [&](double x, double y, double z, double* to) HWY_ATTR {
      for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
        const auto part = [&](int column, double along) HWY_ATTR {
          return hn::Mul(hn::LoadU(d, placing.inverse[column] + g), hn::Set(d, along));
        };
        hn::Store(hn::Add(hn::Add(part(0, x), part(1, y)), part(2, z)), d, to + g);
      }
    };
    image(double{ray.origin.x} - m[0][3], double{ray.origin.y} - m[1][3],
          double{ray.origin.z} - m[2][3], origin);
    image(ray.direction.x, ray.direction.y, ray.direction.z, direction);
  }
};

struct EnteredRay {
  StreamRay record;
  const QuarterAxes* axes = nullptr;

  /// Moves the origin into the box (methods/dual/far_ray.h); returns whether the ray meets it.
  HWY_INLINE bool enter(const AxesRay& ray, float t_min, float t_max, const EnteredBox& box,
                        SingleSlabs* slabs) {
    static constexpr int kNext[3] = {1, 2, 0};
    const auto size = [&](int axis) { return std::fabs(ray.direction[axis]); };
    const int widest = static_cast<int>(size(1) >= size(0));
    const int z = widest + (2 - widest) * static_cast<int>(size(2) >= size(widest));
    const double along = size(z), off = ray.error + double{box.growth.least};
    FarSpan span(t_min, t_max, along);

    const Axes64 d;
    using V = hn::Vec<Axes64>;
    alignas(32) double near[4], far[4];
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      const V o = hn::Load(d, ray.origin + g), to = hn::Load(d, ray.direction + g);
      const auto plane = [&](const float* at)
                             HWY_ATTR { return hn::PromoteTo(d, hn::Load(Axes32(), at + g)); };
      const V low = hn::Sub(hn::Sub(plane(box.low), hn::Set(d, off)), o);
      const V high = hn::Sub(hn::Add(plane(box.high), hn::Set(d, off)), o);
      const V per = hn::Div(hn::Set(d, along), to), a = hn::Mul(low, per), b = hn::Mul(high, per);
      // Along an axis on which it stands still, a ray is within the planes for ever, or never.
      const auto still = hn::Eq(to, hn::Zero(d));
      const auto outside = hn::Lt(hn::Min(hn::Neg(low), high), hn::Zero(d));
      const V never = hn::Inf(d), at_once = hn::IfThenElse(outside, never, hn::Neg(never));
      hn::Store(hn::IfThenElse(still, at_once, hn::Min(a, b)), d, near + g);
      hn::Store(hn::IfThenElse(still, hn::Neg(at_once), hn::Max(a, b)), d, far + g);
    }
    const auto greater = [](double a, double b) { return a > b ? a : b; };
    const auto lesser = [](double a, double b) { return a < b ? a : b; };
    span.enter = greater(greater(span.enter, near[0]), greater(near[1], near[2]));
    span.leave = lesser(lesser(span.leave, far[0]), lesser(far[1], far[2]));
    if (!(span.enter <= span.leave)) return false;

    const double per_along = 1 / along;
    alignas(16) float origin[4], slope[4];
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      const V per_z = hn::Mul(hn::Load(d, ray.direction + g), hn::Set(d, per_along));
      const V at = hn::Add(hn::Load(d, ray.origin + g), hn::Mul(hn::Set(d, span.enter), per_z));
      hn::Store(hn::DemoteTo(Axes32(), at), Axes32(), origin + g);
      hn::Store(hn::DemoteTo(Axes32(), per_z), Axes32(), slope + g);
    }
    const FarRay moved = far_ray(span, {origin[0], origin[1], origin[2]}, off);
    const auto against = [&](int axis) {
      return static_cast<std::uint32_t>(std::signbit(ray.direction[axis]));
    };
    const int x = kNext[z], y = kNext[x];
    axes = &kAxesOfQuarters[static_cast<std::uint32_t>(8 * z) + 4 * against(z) + 2 * against(x) +
                            against(y)];
    StreamRay& r = record;
    r.along = rounded_up(along);
    Growth growth = box.growth;
    growth.include(r.along);
    alignas(16) float per[4], nears[4], fars[4];
    const hn::CappedTag<float, 4> f;
    for (std::size_t g = 0; g < 4; g += hn::Lanes(f)) {
      const auto o = hn::Load(f, origin + g), s = hn::Load(f, slope + g);
      const auto out = hn::Add(
          hn::Add(hn::Mul(hn::Abs(o), hn::Set(f, 2 * kUnitRoundoff)), hn::Set(f, growth.least)),
          hn::Set(f, moved.pad));
      hn::Store(inverse_slope(f, s), f, per + g);
      hn::Store(hn::Add(o, hn::CopySign(out, s)), f, nears + g);
      hn::Store(hn::Sub(o, hn::CopySign(out, s)), f, fars + g);
    }
    const int ax = axes->axis_x, ay = axes->axis_y;
    const float forward = axes->mirrored ? -1.0f : 1.0f;
    r.ox = origin[ax], r.oy = origin[ay], r.oz = origin[z], r.t_limit = t_max;
    r.shear_x = forward * slope[ax], r.shear_y = forward * slope[ay];
    r.shear_z = static_cast<float>(forward * per_along), r.t_min = moved.pad;
    r.per_x = per[ax], r.per_y = per[ay];
    r.s_near = 0, r.s_far = moved.s_far, r.start = moved.start;
    slabs->x_near = nears[ax], slabs->x_far = fars[ax];
    slabs->y_near = nears[ay], slabs->y_far = fars[ay];
    slabs->z_near = nears[z], slabs->z_far = fars[z];
    constexpr float kHalf = 6 * kUnitRoundoff;
    static_assert(kFarther == 1 + 2 * kHalf);
    slabs->per_x_near = per[ax] * (1 - kHalf), slabs->per_x_far = per[ax] * (1 + kHalf);
    slabs->per_y_near = per[ay] * (1 - kHalf), slabs->per_y_far = per[ay] * (1 + kHalf);
    return true;
  }
  /// Leaves out what is farther than a hit at t.
  void shorten(float t) {
    record.s_far = std::min(record.s_far, raysheaf::past(t, record.along) - record.start);
  }
};

/// Sixteen rays in the space of a mesh, a lane each: as `EnteredRay`, operation by operation,
/// except that `along` is rounded up by more.
class EnteredBundle {
 public:
  alignas(64) StreamRay records[kBundleWidth];
  alignas(64) std::uint32_t quarters[kBundleWidth];

  /// Moves the origins of `count` rays into the box. `index`, `limits`: kBundleWidth numbers of
  /// rays, and where each ends; below 0: it is left out. Returns the lanes that meet the box.
  HWY_INLINE std::uint32_t enter(const Ray* rays, const std::uint32_t* index, const float* limits,
                                 std::uint32_t count, const Placing& placing,
                                 const EnteredBox& box) {
    for (std::size_t g = 0; g < count; g += ray_lanes()) {
      const Rays d;
      RV part[8];
      gather4(rays, 0, index + g, part[0], part[1], part[2], part[6]);
      gather4(rays, 1, index + g, part[3], part[4], part[5], part[7]);
      for (int k = 0; k < 7; ++k) hn::Store(part[k], d, given_[k] + g);
    }
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < count; g += hn::Lanes(D64()))
      met |= move(g, limits, placing, box) << g;
    if (met == 0) return 0;
    for (std::size_t g = 0; g < count; g += ray_lanes()) keep(g, limits);
    return met & ((1u << count) - 1);
  }

 private:
  using D64 = hn::CappedTag<double, 8>;
  using D32 = hn::Rebind<float, D64>;
  using V64 = hn::Vec<D64>;

  static HWY_INLINE V64 all(double x) { return hn::Set(D64(), x); }
  static HWY_INLINE void store(V64 v, float* to) { hn::Store(hn::DemoteTo(D32(), v), D32(), to); }

  HWY_INLINE std::uint32_t move(std::size_t g, const float* limits, const Placing& placing,
                                const EnteredBox& box) {
    using hn::Abs, hn::Add, hn::Max, hn::Min, hn::Mul, hn::Sub;
    constexpr double kRounding = kUnitRoundoff, kFloats = 1e38;
    const D64 d;
    const auto wide = [&](const float* from)
                          HWY_ATTR { return hn::PromoteTo(d, hn::Load(D32(), from + g)); };
    V64 from = hn::Zero(d), offset[3], along_axis[3], o[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
      const V64 at = wide(given_[axis]);
      from = Max(from, Abs(at));
      offset[axis] = Sub(at, all(placing.map.m[axis][3]));
      along_axis[axis] = wide(given_[3 + axis]);
    }
    const auto image = [&](int row, const V64* v) HWY_ATTR {
      const auto part = [&](int c) HWY_ATTR { return Mul(all(placing.inverse[c][row]), v[c]); };
      return Add(Add(part(0), part(1)), part(2));
    };
    for (int axis = 0; axis < 3; ++axis) {
      o[axis] = image(axis, offset);
      to[axis] = image(axis, along_axis);
    }
    const V64 error =
        Add(Add(all(placing.drift), Mul(all(placing.per_origin), from)), all(placing.least_error));
    const V64 off = Add(error, all(box.growth.least));

    const auto second = hn::Ge(Abs(to[1]), Abs(to[0]));
    V64 along = hn::IfThenElse(second, Abs(to[1]), Abs(to[0]));
    V64 z = hn::IfThenElseZero(second, all(1));
    const auto third = hn::Ge(Abs(to[2]), along);
    along = hn::IfThenElse(third, Abs(to[2]), along);
    z = hn::IfThenElse(third, all(2), z);

    const V64 t_min = wide(given_[6]), limit = wide(limits);
    const V64 bounding = hn::IfThenElseZero(hn::Lt(t_min, all(kLargeStart)), t_min);
    V64 near = Mul(Mul(Sub(bounding, all(kLeastStep)), along), all(1 - 8 * kRounding));
    V64 far = Mul(Mul(Add(limit, all(kLeastStep)), along), all(1 + 8 * kRounding));
    for (int axis = 0; axis < 3; ++axis) {
      const V64 low = Sub(Sub(all(box.low[axis]), off), o[axis]);
      const V64 high = Sub(Add(all(box.high[axis]), off), o[axis]);
      const V64 per = hn::Div(along, to[axis]), a = Mul(low, per), b = Mul(high, per);
      // Along an axis on which it stands still, a ray is within the planes for ever, or never.
      const auto still = hn::Eq(to[axis], hn::Zero(d));
      const auto outside = hn::Lt(Min(hn::Neg(low), high), hn::Zero(d));
      const V64 at_once = hn::IfThenElse(outside, hn::Inf(d), hn::Neg(hn::Inf(d)));
      near = Max(near, hn::IfThenElse(still, at_once, Min(a, b)));
      far = Min(far, hn::IfThenElse(still, hn::Neg(at_once), Max(a, b)));
    }
    const auto met = hn::And(hn::Le(near, far), hn::Ge(limit, hn::Zero(d)));

    const V64 per_along = hn::Div(all(1), along);
    for (int axis = 0; axis < 3; ++axis) {
      const V64 slope = Mul(to[axis], per_along);
      store(Add(o[axis], Mul(near, slope)), at_[axis] + g);
      store(slope, slope_[axis] + g);
    }
    const V64 start = Min(Sub(near, Mul(Abs(near), all(4 * kRounding))), all(kFloats));
    store(Max(start, all(-kFloats)), start_ + g);
    const V64 length = Add(Mul(Sub(far, near), all(1 + 4 * kRounding)), off);
    store(Min(length, all(kFloats)), length_ + g);
    store(off, off_ + g);
    store(z, z_ + g);
    // Is rounded by less than what is added.
    store(Add(Mul(along, all(1 + 4 * kRounding)), all(0x1p-149)), along_ + g);
    return bits_of(d, met);
  }

  /// Makes the records along the axes of each ray's quarter.
  HWY_INLINE void keep(std::size_t g, const float* limits) {
    using hn::Abs, hn::Max;
    const Rays d;
    const RayInts di;
    const RM first = hn::Eq(load(z_ + g), hn::Zero(d)), second = hn::Eq(load(z_ + g), set(1));
    // The component `next` axes after a ray's z.
    const auto after = [&](const float(*of)[kBundleWidth], int next) HWY_ATTR {
      const auto at = [&](int z) HWY_ATTR { return load(of[(z + next) % 3] + g); };
      return hn::IfThenElse(first, at(0), hn::IfThenElse(second, at(1), at(2)));
    };
    const RV slope_z = after(slope_, 0), slope_1 = after(slope_, 1), slope_2 = after(slope_, 2);
    const RM mirrored = hn::Lt(slope_z, hn::Zero(d));
    const auto sign = [&](RV v) HWY_ATTR { return hn::ShiftRight<31>(hn::BitCast(di, v)); };
    const auto z = hn::BitCast(di, hn::ConvertTo(hn::RebindToSigned<Rays>(), load(z_ + g)));
    const auto quarter = hn::Or(hn::Or(hn::ShiftLeft<3>(z), hn::ShiftLeft<2>(sign(slope_z))),
                                hn::Or(hn::ShiftLeft<1>(sign(slope_1)), sign(slope_2)));
    hn::Store(quarter, di, quarters + g);
    const auto either = [&](RV one, RV other)
                            HWY_ATTR { return hn::IfThenElse(mirrored, other, one); };
    const RV o1 = after(at_, 1), o2 = after(at_, 2), oz = after(at_, 0);
    const RV x = either(slope_1, slope_2), y = either(slope_2, slope_1);
    const RV reach = Max(Max(Abs(o1), Abs(o2)), Abs(oz));
    const RV pad = hn::Add(hn::Mul(set(4 * kUnitRoundoff), reach),
                           hn::Mul(load(off_ + g), set(1 + 2 * kUnitRoundoff)));
    const auto forward = [&](RV v) HWY_ATTR { return hn::IfThenElse(mirrored, hn::Neg(v), v); };
    StreamRay* const to = records + g;
    store4(either(o1, o2), either(o2, o1), oz, load(limits + g), 0, to);
    store4(forward(x), forward(y), hn::Zero(d), pad, 1, to);
    store4(inverse_slope(d, x), inverse_slope(d, y), hn::Zero(d), load(length_ + g), 2, to);
    store4(load(along_ + g), hn::Zero(d), hn::Zero(d), load(start_ + g), 3, to);
  }

  alignas(64) float given_[7][kBundleWidth];  ///< origin, direction, t_min
  alignas(64) float at_[3][kBundleWidth], slope_[3][kBundleWidth];
  alignas(64) float start_[kBundleWidth], length_[kBundleWidth], off_[kBundleWidth];
  alignas(64) float along_[kBundleWidth], z_[kBundleWidth];
};
