  // One ray through a subtree, eight boxes at a time. Part of the class Walk (dual/walk-inl.h).

  HWY_NOINLINE void walk_single(std::uint32_t lane, std::uint32_t number) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const RayPacket& p = packet_;
    const Boxes d;
    const bool right = p.per_x[lane] > 0, up = p.per_y[lane] > 0, ahead = !p.mirrored;
    const int near_x = right ? p.row_x : p.row_x + 3, far_x = right ? p.row_x + 3 : p.row_x;
    const int near_y = up ? p.row_y : p.row_y + 3, far_y = up ? p.row_y + 3 : p.row_y;
    const int near_z = ahead ? p.row_z : p.row_z + 3, far_z = ahead ? p.row_z + 3 : p.row_z;
    const BV per_x = hn::Set(d, p.per_x[lane]), per_y = hn::Set(d, p.per_y[lane]);
    const BV per_z = hn::Set(d, ahead ? 1.0f : -1.0f);
    const BV x0 = hn::Set(d, right ? p.x_high[lane] : p.x_low[lane]);
    const BV x1 = hn::Set(d, right ? p.x_low[lane] : p.x_high[lane]);
    const BV y0 = hn::Set(d, up ? p.y_high[lane] : p.y_low[lane]);
    const BV y1 = hn::Set(d, up ? p.y_low[lane] : p.y_high[lane]);
    const BV z0 = hn::Set(d, ahead ? p.z_high[lane] : p.z_low[lane]);
    const BV z1 = hn::Set(d, ahead ? p.z_low[lane] : p.z_high[lane]);
    const BV s_near = hn::Set(d, p.s_near[lane]);
    std::size_t top = 0, visited = 0;
    WaitingNode* waiting = waiting_nodes_.data();
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
        const BV near = Max(Max(at(near_x, x0, per_x), at(near_y, y0, per_y)),
                            Max(at(near_z, z0, per_z), s_near));
        const BV far = Min(Min(at(far_x, x1, per_x), at(far_y, y1, per_y)),
                           Min(at(far_z, z1, per_z), hn::Set(d, s_far)));
        hn::Store(near, d, nears + g);
        met |= bits_of(d, hn::Le(near, far)) << g;
      }
      WaitingNode next{0, 0, 0};
      if (met != 0) {
        int c = __builtin_ctz(met);
        met &= met - 1;
        next = {nears[c], node.first[c], node.count[c]};
        if (met != 0) {
          if (top + kBvhWidth > waiting_nodes_.size()) {
            waiting_nodes_.resize(2 * waiting_nodes_.size());
            waiting = waiting_nodes_.data();
          }
          const std::size_t bottom = top;
          do {
            c = __builtin_ctz(met);
            met &= met - 1;
            WaitingNode other{nears[c], node.first[c], node.count[c]};
            if (other.near < next.near) std::swap(other, next);
            std::size_t place = top++;
            for (; place > bottom && waiting[place - 1].near < other.near; --place)
              waiting[place] = waiting[place - 1];
            waiting[place] = other;
          } while (met != 0);
        }
      } else {
        do {
          if (top == 0) {
            counts_.ray_box_tests += visited;
            return;
          }
          next = waiting[--top];
        } while (next.near > s_far);
      }
      while (next.count != 0) {
        if (leaf_single(lane, next.first, next.count)) {
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
          next = waiting[--top];
        } while (next.near > s_far);
      }
      number = next.first;
    }
  }

  /// Whether the ray now ends earlier.
  HWY_INLINE bool leaf_single(std::uint32_t lane, std::uint32_t quad, std::uint32_t count) {
    using Quad = hn::CappedTag<float, 4>;
    const Quad d;
    const RayPacket& p = packet_;
    counts_.triangle_tests += count;
    bool shortened = false;
    for (std::uint32_t done = 0; done < count; done += 4, ++quad) {
      const TriangleQuad& q = tree_.quads[quad];
      const std::uint32_t used = std::min(4u, count - done);
      for (std::size_t g = 0; g < 4; g += hn::Lanes(d)) {
        const auto from = [&](float x) { return hn::Set(d, x); };
        const auto moved = [&](int i) {
          return sheared(d, hn::Sub(hn::LoadU(d, q.vertex[i][p.axis_x] + g), from(p.ox[lane])),
                         hn::Sub(hn::LoadU(d, q.vertex[i][p.axis_y] + g), from(p.oy[lane])),
                         hn::Sub(hn::LoadU(d, q.vertex[i][p.axis_z] + g), from(p.oz[lane])),
                         from(p.shear_x[lane]), from(p.shear_y[lane]));
        };
        Tested<Quad> tested;
        if (!test_lanes(d, moved(0), moved(1), moved(2), from(p.shear_z[lane]),
                        from(p.t_min[lane]), from(p.t_limit[lane]), &tested))
          continue;
        std::uint32_t lanes = (bits_of(d, tested.hit) | bits_of(d, tested.unsettled)) << g;
        for (lanes &= (1u << used) - 1; lanes != 0; lanes &= lanes - 1)
          shortened |= take_exactly(lane, q, static_cast<std::uint32_t>(__builtin_ctz(lanes)));
      }
    }
    return shortened;
  }
