// Stage 1 of the ray-triangle test (intersect/triangle_body.h), over rays in lanes or over the
// triangles of a quad. Included by methods/dual/trace_simd.cpp, inside its namespace.
//
// For each lane that hits, an interval contains the rounded t. Lanes that are neither certainly a
// hit within the ray's limits nor certainly a miss go to stage 2. No operation is fused, so that
// intervals, and with them the nodes that rays visit, are the same on every target.

/// The result of stage 1.
template <class D>
struct Tested {
  hn::Mask<D> hit, unsettled;
  hn::Vec<D> low, high;  ///< of t, for hits
  hn::Vec<D> det;        ///< its sign tells which side is hit
};

/// Rejects only, for rays whose origins are moved (methods/dual/far_ray.h).
template <class D>
HWY_INLINE void test_far_lanes(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                               hn::Vec<D> reach, hn::Vec<D> pad, Tested<D>* out) {
  const auto depth = hn::Add(hn::Abs(a.z), hn::Mul(pad, hn::Set(d, kDepthOfPad)));
  out->unsettled = edges_of(d, a, b, c, reach, depth).possible;
  out->hit = hn::MaskFromVec(hn::Zero(d));
  out->low = out->high = out->det = hn::Zero(d);
}

template <class D>
HWY_INLINE void finish_lanes(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                             const Edges<D>& e, hn::Vec<D> reach, hn::Vec<D> shear_z,
                             hn::Vec<D> t_min, hn::Vec<D> t_limit, Tested<D>* out) {
  using hn::Abs, hn::Add, hn::And, hn::AndNot, hn::Ge, hn::Gt, hn::Le, hn::Lt, hn::Mul, hn::Or;
  using V = hn::Vec<D>;
  const auto all = [&](float x) { return hn::Set(d, x); };
  const V det = Add(Add(e.u, e.v), e.w), size = Abs(det), per_det = hn::Div(all(1), det);
  const V distance = Add(Add(Mul(e.u, Mul(shear_z, a.z)), Mul(e.v, Mul(shear_z, b.z))),
                         Mul(e.w, Mul(shear_z, c.z)));
  const V t = Mul(distance, per_det), far = Abs(distance);
  const V of_weights = Mul(Mul(all(kErrorOfWeights), Mul(e.error, reach)), Abs(per_det));
  const V half = Mul(Abs(shear_z), Add(of_weights, Mul(all(kErrorOfDepth), e.size)));
  out->low = hn::Sub(t, half);
  out->high = Add(t, half);
  out->det = det;
  const auto around = Gt(hn::Max(e.least, hn::Neg(e.most)), e.error);
  const auto normal = And(And(Ge(size, all(kSmallDeterminant)), Le(size, all(kLargeDeterminant))),
                          And(And(Ge(far, all(kSmallDistance)), Le(far, all(kLargeDeterminant))),
                              Ge(half, all(kSmallInterval))));
  const auto sure = And(around, normal);
  const auto beyond = Or(Lt(out->high, t_min), Gt(out->low, t_limit));
  out->hit = And(sure, And(Ge(out->low, t_min), Le(out->high, t_limit)));
  const auto settled = Or(Or(out->hit, And(sure, beyond)), Gt(t_min, t_limit));
  out->unsettled = AndNot(settled, e.possible);
}

/// Returns false if no lane can be a hit; `out` is then not written.
template <class D>
HWY_INLINE bool test_lanes(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                           hn::Vec<D> reach, hn::Vec<D> shear_z, hn::Vec<D> t_min,
                           hn::Vec<D> t_limit, Tested<D>* out) {
  const Edges<D> edges = edges_of(d, a, b, c, reach);
  if (HWY_LIKELY(hn::AllFalse(d, edges.possible))) return false;
  finish_lanes(d, a, b, c, edges, reach, shear_z, t_min, t_limit, out);
  return true;
}

/// The corners of the triangle at a place in the tree's quads, four each.
struct PlacedCorners {
  Vec3 a, b, c;
  PlacedCorners(const TriangleQuad* quads, std::uint32_t place)
      : PlacedCorners(quads, place, 0, 1, 2) {}
  PlacedCorners(const ObjectTree& tree, std::uint32_t place)
      : PlacedCorners(tree.quads.data(), place) {}
  /// In the rays' axes.
  PlacedCorners(const ObjectTree& tree, std::uint32_t place, const QuarterAxes& axes)
      : PlacedCorners(tree.quads.data(), place, axes.axis_x, axes.axis_y, axes.axis_z) {}

 private:
  PlacedCorners(const TriangleQuad* quads, std::uint32_t place, int x, int y, int z) {
    const TriangleQuad& q = quads[place / 4];
    const std::uint32_t k = place % 4;
    const auto corner = [&](int i) {
      return Vec3{q.vertex[i][x][k], q.vertex[i][y][k], q.vertex[i][z][k]};
    };
    a = corner(0), b = corner(1), c = corner(2);
  }
};

/// The number of the triangle at a place.
inline std::uint32_t id_at(const ObjectTree& tree, std::uint32_t place) {
  return tree.quads[place / 4].id[place % 4];
}

/// Whether the triangles at two places have equal corners, in the same order.
inline bool have_same_corners(const ObjectTree& tree, std::uint32_t one, std::uint32_t other) {
  const float* const a = &tree.quads[one / 4].vertex[0][0][one % 4];
  const float* const b = &tree.quads[other / 4].vertex[0][0][other % 4];
  for (std::size_t k = 0; k < 9; ++k)
    if (a[4 * k] != b[4 * k]) return false;
  return true;
}

/// Whether some hits within rays' intervals do not count.
inline bool chooses_hits(const DualScene& scene) {
  return scene.filter != nullptr || (scene.facing != Facing::kBoth && scene.flags != nullptr);
}

/// Whether the hit of a ray, by the caller's number, with a triangle counts.
inline HWY_NOINLINE bool counts_as_hit(const DualScene& scene, std::uint32_t ray,
                                       std::uint32_t triangle, bool front) {
  if (scene.filter != nullptr && !scene.filter->takes(ray, triangle, front)) return false;
  return scene.flags == nullptr || shows(scene.facing, scene.flags[triangle], front);
}

/// The hits that a query stores.
struct ClosestMode {
  static constexpr bool kAny = false, kAll = false;
};
struct AnyMode {
  static constexpr bool kAny = true, kAll = false;
};
struct AllMode {
  static constexpr bool kAny = false, kAll = true;
};

/// The interval of a hit's t; both ends equal t once it is settled.
struct Interval {
  float low, high;
};

/// The best hit so far of a ray that searches for the closest.
struct BestHit {
  float *low, *high;     ///< of its t; the ray's t_max if there is no hit
  std::uint32_t* place;  ///< of its triangle; kInvalidId: none

  /// Takes a hit of the triangle at `at`, with distance `t`, if it is better; settles the stored
  /// hit if the intervals overlap. Returns whether it was taken.
  bool take_settled(const ObjectTree& tree, const Ray& ray, std::uint32_t at, float t) const {
    if (t > *high) return false;
    if (!(t < *low) && *place != kInvalidId) {
      if (*low != *high) {
        const PlacedCorners p(tree, *place);
        *low = *high = values_of_hit(ray.origin, ray.direction, p.a, p.b, p.c).t;
      }
      if (t > *high || (t == *high && id_at(tree, at) >= id_at(tree, *place))) return false;
    }
    *low = *high = t;
    *place = at;
    return true;
  }
};

/// The fields that store a ray's best hit and its end; `start` as in StreamRay.
struct RayLimits {
  BestHit best;
  float* s_far;
  float along, start;
};

/// The ray of a record along its axes; if records `are_far`, their origins are moved, and this one
/// begins where the given ray does.
HWY_INLINE SlopedRay sloped_ray(const StreamRay& r, const QuarterAxes& axes, bool are_far,
                                const Ray& given) {
  SlopedRay ray{{r.ox, r.oy, r.oz}, r.shear_x, r.shear_y, r.shear_z, r.t_min, r.t_limit};
  if (HWY_UNLIKELY(are_far)) {
    ray.origin = axes.along_axes(given.origin);
    ray.t_min = given.t_min;
  }
  return ray;
}

/// Stages 2 and 3 for a ray of the caller and the triangle at a place, in [t_min, t_max].
inline HWY_NOINLINE bool settle_at(const ObjectTree& tree, const Ray& ray, std::uint32_t place,
                                   float t_max, TriangleHit* hit) {
  const PlacedCorners p(tree, place);
  return line_meets_triangle(ray.origin, ray.direction, p.a, p.b, p.c, hit) &&
         is_within(hit->t, ray.t_min, t_max);
}

/// Lanes whose interval ends before the plane of the triangle at a place, or begins beyond it.
inline HWY_NOINLINE std::uint32_t lanes_beyond_plane(const ObjectTree& tree,
                                                     const QuarterAxes& axes, std::uint32_t place,
                                                     const SetupColumns& rays) {
  const PlacedCorners p(tree, place, axes);
  return lanes_beyond(ray_lanes(), rays, p.a, p.b, p.c);
}
/// The columns of a bundle's rays from lane `g` on.
HWY_INLINE SetupColumns columns_from(const StreamBundle& r, std::size_t g) {
  return {r.ox + g,      r.oy + g,      r.oz + g,    r.shear_x + g,
          r.shear_y + g, r.shear_z + g, r.t_min + g, r.t_limit + g};
}

/// The values of sixteen rays' hits, each with the triangle at its place; kInvalidId: none.
class HitValues {
 public:
  /// `index`: kBundleWidth indices into `rays`, of which `count` matter. A triangle is read once,
  /// however many rays hit it.
  HWY_INLINE void fill(const ObjectTree& tree, const Ray* rays, const std::uint32_t* index,
                       const std::uint32_t* places, std::size_t count = kBundleWidth) {
    const Rays d;
    const RayInts di;
    hits_ = 0;
    count_ = count;
    for (std::size_t g = 0; g < count; g += ray_lanes()) {
      RV o[3], l[3], t_min, t_max;
      gather4(rays, 0, index + g, o[0], o[1], o[2], t_min);
      gather4(rays, 1, index + g, l[0], l[1], l[2], t_max);
      for (int axis = 0; axis < 3; ++axis) {
        hn::Store(o[axis], d, columns_.origin[axis] + g);
        hn::Store(l[axis], d, columns_.direction[axis] + g);
      }
      const auto place = hn::Load(di, places + g);
      auto id = hn::Set(di, kInvalidId);
      std::uint32_t rest = bits_of(d, hn::RebindMask(d, hn::Ne(place, id)));
      hits_ |= rest << g;
      RV corner[9];
      for (RV& c : corner) c = hn::Zero(d);
      while (rest != 0) {
        const std::uint32_t one = places[g + static_cast<std::uint32_t>(__builtin_ctz(rest))];
        const auto same = hn::Eq(place, hn::Set(di, one));
        const float* const from = &tree.quads[one / 4].vertex[0][0][one % 4];
        for (int k = 0; k < 9; ++k)
          corner[k] = hn::IfThenElse(hn::RebindMask(d, same), set(from[4 * k]), corner[k]);
        id = hn::IfThenElse(same, hn::Set(di, id_at(tree, one)), id);
        rest &= ~bits_of(d, hn::RebindMask(d, same));
      }
      for (int k = 0; k < 9; ++k) hn::Store(corner[k], d, columns_.corner[k / 3][k % 3] + g);
      hn::Store(id, di, ids_ + g);
    }
  }
  /// Writes `hits`, in whole vectors, with triangle numbers instead of places.
  HWY_INLINE void store(IndexedHit* hits) {
    settle_values(hits_, &columns_, count_);
    const Rays d;
    const RayInts di;
    for (std::size_t g = 0; g < count_; g += ray_lanes()) {
      const RM met = lanes_of(hits_, g);
      store4(hn::IfThenElse(met, load(columns_.t + g), set(IndexedHit().t)),
             hn::IfThenElseZero(met, load(columns_.u + g)),
             hn::IfThenElseZero(met, load(columns_.v + g)), hn::BitCast(d, hn::Load(di, ids_ + g)),
             0, hits + g);
    }
  }

 private:
  ValueColumns columns_;
  alignas(64) std::uint32_t ids_[kBundleWidth];
  std::uint32_t hits_ = 0;
  std::size_t count_ = 0;
};
static_assert(kValueLanes == kBundleWidth);

/// Stores the hits of a task's rays, given by places of triangles in the tree.
inline void hand_over_rows(const StreamJob& job, const TraceTask& task,
                           std::vector<RowHit>& found) {
  if (job.results.rows == nullptr) return;
  const ObjectTree& tree = *job.scene.tree;
  HitValues values;
  for (std::size_t base = 0; base < found.size(); base += kBundleWidth) {
    alignas(64) std::uint32_t index[kBundleWidth], places[kBundleWidth];
    alignas(64) IndexedHit hits[kBundleWidth];
    const std::size_t count = std::min<std::size_t>(kBundleWidth, found.size() - base);
    // Hits are in the order of the traversal, so their rays are scattered.
    const std::size_t ahead = std::min(base + 4 * kBundleWidth, found.size());
    for (std::size_t i = base + 3 * kBundleWidth; i < ahead; ++i)
      hwy::Prefetch(job.rays + job.order.rays[found[i].place]);
    for (std::size_t i = 0; i < kBundleWidth; ++i) {
      const RowHit& row = found[base + (i < count ? i : 0)];
      index[i] = job.order.rays[row.place];
      places[i] = row.hit.triangle;
    }
    values.fill(tree, job.rays, index, places);
    values.store(hits);
    for (std::size_t i = 0; i < count; ++i) found[base + i].hit = hits[i];
  }
  const BundleRange last = job.bundle(task.end - 1);
  make_rows(job.executor, found, job.bundle(task.begin).first, last.first + last.count,
            &(*job.results.rows)[task.number]);
}
