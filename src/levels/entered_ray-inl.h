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
