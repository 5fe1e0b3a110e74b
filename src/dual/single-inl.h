// One ray through a subtree, eight boxes at a time. Part of the class Walk (dual/walk-inl.h).

HWY_NOINLINE void walk_single(std::uint32_t lane, std::uint32_t number) {
  using hn::Max, hn::Min, hn::Mul, hn::Sub;
  const RayPacket& p = packet_;
  const Boxes d;
  const BV per_x = hn::Set(d, p.per_x[lane]), per_y = hn::Set(d, p.per_y[lane]);
  const BV per_z = hn::Set(d, p.mirrored ? -1.0f : 1.0f);
  const BV x0 = hn::Set(d, p.x_near[lane]), x1 = hn::Set(d, p.x_far[lane]);
  const BV y0 = hn::Set(d, p.y_near[lane]), y1 = hn::Set(d, p.y_far[lane]);
  const BV z0 = hn::Set(d, p.z_near[lane]), z1 = hn::Set(d, p.z_far[lane]);
  const BV s_near = hn::Set(d, p.s_near[lane]);
  std::size_t top = 0, visited = 0;
  Waiting* waiting = waiting_nodes_.data();
  std::size_t room = waiting_nodes_.size() - kBvhWidth;
  float s_far = p.s_far[lane];
  for (;;) {
    const BvhNode& node = tree_.nodes[number];
    visited += node.children;
    alignas(64) float nears[kBvhWidth];
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const auto at = [&](int row, BV from, BV per) {
        return Mul(Sub(hn::Load(d, node.bound[row] + g), from), per);
      };
      const BV near = Max(Max(at(p.near_x, x0, per_x), at(p.near_y, y0, per_y)),
                          Max(at(p.near_z, z0, per_z), s_near));
      const BV far = Min(Min(at(p.far_x, x1, per_x), at(p.far_y, y1, per_y)),
                         Min(at(p.far_z, z1, per_z), hn::Set(d, s_far)));
      hn::Store(near, d, nears + g);
      met |= bits_of(d, hn::Le(near, far)) << g;
    }
    Waiting next;
    if (met != 0) {
      int c = __builtin_ctz(met);
      met &= met - 1;
      Waiting(nears[c], 0, node.first[c], node.count[c]).copy_to(&next);
      if (met != 0) {
        if (HWY_UNLIKELY(top > room)) {
          waiting_nodes_.resize(2 * waiting_nodes_.size());
          waiting = waiting_nodes_.data();
          room = waiting_nodes_.size() - kBvhWidth;
        }
        const std::size_t bottom = top;
        do {
          c = __builtin_ctz(met);
          met &= met - 1;
          Waiting other(nears[c], 0, node.first[c], node.count[c]);
          if (other.near() < next.near()) std::swap(other, next);
          std::size_t place = top++;
          for (; place > bottom && waiting[place - 1].near() < other.near(); --place)
            waiting[place - 1].copy_to(waiting + place);
          other.copy_to(waiting + place);
        } while (met != 0);
      }
    } else {
      do {
        if (top == 0) {
          counts_.ray_box_tests += visited;
          return;
        }
        waiting[--top].copy_to(&next);
      } while (next.near() > s_far);
    }
    while (next.count() != 0) {
      if (leaf_single(lane, next.first(), next.count())) {
        if (Mode::kAny) {
          counts_.ray_box_tests += visited;
          return;
        }
        s_far = p.s_far[lane];
      }
      do {
        if (top == 0) {
          counts_.ray_box_tests += visited;
          return;
        }
        waiting[--top].copy_to(&next);
      } while (next.near() > s_far);
    }
    number = next.first();
  }
}

/// Whether the ray now ends earlier.
HWY_NOINLINE bool leaf_single(std::uint32_t lane, std::uint32_t quad, std::uint32_t count) {
  using Quad = hn::CappedTag<float, 4>;
  const Quad d;
  const RayPacket& p = packet_;
  counts_.triangle_tests += count;
  bool shortened = false;
  for (std::uint32_t done = 0; done < count; done += 4, ++quad) {
    const TriangleQuad& q = tree_.quads[quad];
    const std::uint32_t used = std::min(4u, count - done);
    const float* x = q.vertex[0][p.axis_x];
    const float* y = q.vertex[0][p.axis_y];
    const float* z = q.vertex[0][p.axis_z];
    for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
      const auto from = [&](float o) { return hn::Set(d, o); };
      const auto moved = [&](int i) {
        return sheared(d, hn::Sub(hn::LoadU(d, x + 12 * i + g), from(p.ox[lane])),
                       hn::Sub(hn::LoadU(d, y + 12 * i + g), from(p.oy[lane])),
                       hn::Sub(hn::LoadU(d, z + 12 * i + g), from(p.oz[lane])),
                       from(p.shear_x[lane]), from(p.shear_y[lane]));
      };
      Tested<Quad> tested;
      if (!test_lanes(d, moved(0), moved(1), moved(2), from(p.shear_z[lane]), from(p.t_min[lane]),
                      from(p.t_limit[lane]), &tested))
        continue;
      const std::uint32_t lanes = (1u << used) - 1;
      std::uint32_t hit = bits_of(d, tested.hit) << g & lanes;
      std::uint32_t unsettled = bits_of(d, tested.unsettled) << g & lanes;
      if ((hit | unsettled) == 0) continue;
      alignas(16) float t[4], v[4], w[4], det[4];
      hn::Store(tested.t, d, t + g);
      hn::Store(tested.v, d, v + g);
      hn::Store(tested.w, d, w + g);
      hn::Store(tested.det, d, det + g);
      for (; hit != 0; hit &= hit - 1) {
        const int k = __builtin_ctz(hit);
        shortened |= take(lane, q.id[k], {t[k], v[k] / det[k], w[k] / det[k], det[k] > 0});
      }
      for (; unsettled != 0; unsettled &= unsettled - 1)
        shortened |= take_exactly(lane, q, static_cast<std::uint32_t>(__builtin_ctz(unsettled)));
    }
  }
  return shortened;
}
