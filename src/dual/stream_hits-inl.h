// What a stream keeps of the hits it meets. Included once a SIMD target by dual/trace_simd.cpp,
// inside its namespace.

/// Hits go back to rays that stand far apart.
inline constexpr std::uint32_t kWritesAhead = 24;

template <class Mode>
class StreamHits {
 protected:
  explicit StreamHits(const TraceJob& job)
      : job_(job),
        tree_(*job.scene.tree),
        in_blocks_(job.scene.bundle == Bundle::kStream),
        own_(job.streams->take()),
        stream_(*own_) {
    stream_.rows.clear();
  }
  ~StreamHits() { job_.streams->give(std::move(own_)); }
  StreamHits(const StreamHits&) = delete;
  StreamHits& operator=(const StreamHits&) = delete;

  /// `place`: of a triangle in the tree's quads, four each; so for all that take hits.
  HWY_NOINLINE void take_lanes(std::uint32_t place, const std::uint32_t* block, std::uint32_t used,
                               std::size_t g, const Tested<Rays>& tested) {
    const Rays d;
    std::uint32_t hit = bits_of(d, tested.hit) & used >> g;
    std::uint32_t unsettled = bits_of(d, tested.unsettled) & used >> g;
    if ((hit | unsettled) == 0) return;
    alignas(64) float t[kPacketWidth], u[kPacketWidth], v[kPacketWidth];
    hn::Store(tested.t, d, t);
    hn::Store(hn::Div(tested.v, tested.det), d, u);
    hn::Store(hn::Div(tested.w, tested.det), d, v);
    const std::uint32_t front = bits_of(d, hn::Gt(tested.det, hn::Zero(d)));
    for (; hit != 0; hit &= hit - 1) {
      const int i = __builtin_ctz(hit);
      take(block[g + static_cast<std::size_t>(i)], place,
           {t[i], u[i], v[i], (front >> i & 1) != 0});
    }
    for (; unsettled != 0; unsettled &= unsettled - 1)
      take_exactly(block[g + static_cast<std::size_t>(__builtin_ctz(unsettled))], place);
  }

  HWY_NOINLINE void take_exactly(std::uint32_t n, std::uint32_t place) {
    const Stream& s = stream_;
    const TriangleQuad& q = tree_.quads[place / 4];
    const std::uint32_t k = place % 4;
    RaySetup r;
    float o[3];
    o[s.axis_x] = s.rays[n].ox;
    o[s.axis_y] = s.rays[n].oy;
    o[s.axis_z] = s.rays[n].oz;
    r.origin = {o[0], o[1], o[2]};
    r.shear_x = s.rays[n].shear_x;
    r.shear_y = s.rays[n].shear_y;
    r.shear_z = s.rays[n].shear_z;
    r.t_min = s.rays[n].t_min;
    r.t_max = s.rays[n].t_limit;
    r.axis_x = s.axis_x;
    r.axis_y = s.axis_y;
    r.axis_z = s.axis_z;
    const auto corner = [&](int i) {
      return Vec3{q.vertex[i][0][k], q.vertex[i][1][k], q.vertex[i][2][k]};
    };
    TriangleHit hit;
    if (intersect_triangle(r, corner(0), corner(1), corner(2), &hit)) take(n, place, hit);
  }

  void take(std::uint32_t n, std::uint32_t place, const TriangleHit& hit) {
    Stream& s = stream_;
    StreamRay& ray = s.rays[n];
    const std::uint32_t id = id_at(tree_, place);
    if (job_.scene.facing != Facing::kBoth && job_.scene.flags != nullptr &&
        !shows(job_.scene.facing, job_.scene.flags[id], hit.front))
      return;
    if constexpr (Mode::kAll) {
      s.rows.push_back({s.first + n, {hit.t, hit.u, hit.v, id}});
    } else if constexpr (Mode::kAny) {
      // The least of a leaf's, whatever order a SIMD target finds them in.
      ray.triangle = std::min(ray.triangle, place);
      ray.t_limit = -1;
      end_ray(n, -std::numeric_limits<float>::infinity());
    } else {
      // The limit is the best so far, and at hand.
      if (!(hit.t < ray.t_limit || (hit.t == ray.t_limit && id < ray.triangle))) return;
      ray.t_limit = hit.t;
      ray.u = hit.u;
      ray.v = hit.v;
      ray.triangle = id;
      const float far = past(hit.t, ray.along, s.pad);
      end_ray(n, far < ray.s_far ? far : ray.s_far);
    }
  }

  HWY_INLINE void prefetch_ray(std::uint32_t n) const { hwy::Prefetch(stream_.rays.data() + n); }

  /// The ray looks no farther.
  void end_ray(std::uint32_t n, float s_far) {
    stream_.rays[n].s_far = s_far;
    if (in_blocks_) stream_.blocks[n / kPacketWidth].s_far[n % kPacketWidth] = s_far;
  }

  void write_back() {
    const Stream& s = stream_;
    for (std::uint32_t i = 0; i < s.count; ++i) {
      if constexpr (Mode::kAny) {
        job_.occluded[s.index[i]] = s.rays[i].triangle != kInvalidId ? 1 : 0;
      } else if constexpr (!Mode::kAll) {
        if (i + kWritesAhead < s.count)
          __builtin_prefetch(job_.hits + s.index[i + kWritesAhead], 1);
        const StreamRay& ray = s.rays[i];
        const float t = ray.triangle != kInvalidId ? ray.t_limit : EngineHit().t;
        job_.hits[s.index[i]] = {t, ray.u, ray.v, ray.triangle};
      }
    }
  }

  const TraceJob& job_;
  const ObjectTree& tree_;
  const bool in_blocks_;  ///< neighbours are expected to stay together for a while
  std::unique_ptr<Stream> own_;
  Stream& stream_;
  DualCounts counts_;
};
