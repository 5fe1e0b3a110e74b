  // One ray through a subtree, eight boxes at a time. Part of the class Walk (dual/walk-inl.h).

  void walk_single(std::uint32_t lane, std::uint32_t root) {
    const RayPacket& p = packet_;
    std::size_t top = open_single(lane, root, 0);
    while (top != 0) {
      const WaitingNode next = waiting_nodes_[--top];
      if (next.near > p.s_far[lane]) continue;
      if (next.count == 0) {
        top = open_single(lane, next.first, top);
      } else {
        leaf_single(lane, next.first, next.count);
        if (Mode::kAny && (done_ >> lane & 1) != 0) return;
      }
    }
  }

  std::size_t open_single(std::uint32_t lane, std::uint32_t number, std::size_t top) {
    using hn::Max, hn::Min, hn::Mul, hn::Sub;
    const RayPacket& p = packet_;
    if (top + kBvhWidth > waiting_nodes_.size()) waiting_nodes_.resize(2 * waiting_nodes_.size());
    const BvhNode& node = tree_.nodes[number];
    counts_.ray_box_tests += node.children;
    const Boxes d;
    alignas(64) float nears[kBvhWidth];
    std::uint32_t met = 0;
    const bool right = p.per_x[lane] > 0, up = p.per_y[lane] > 0;
    const float* x0 = node.bound[right ? p.row_x : p.row_x + 3];
    const float* x1 = node.bound[right ? p.row_x + 3 : p.row_x];
    const float* y0 = node.bound[up ? p.row_y : p.row_y + 3];
    const float* y1 = node.bound[up ? p.row_y + 3 : p.row_y];
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const auto at = [&](const float* row, float from) {
        return Sub(hn::Load(d, row + g), hn::Set(d, from));
      };
      const BV per_x = hn::Set(d, p.per_x[lane]), per_y = hn::Set(d, p.per_y[lane]);
      const BV xn = Mul(at(x0, right ? p.x_high[lane] : p.x_low[lane]), per_x);
      const BV xf = Mul(at(x1, right ? p.x_low[lane] : p.x_high[lane]), per_x);
      const BV yn = Mul(at(y0, up ? p.y_high[lane] : p.y_low[lane]), per_y);
      const BV yf = Mul(at(y1, up ? p.y_low[lane] : p.y_high[lane]), per_y);
      const BV zl = hn::Load(d, node.bound[p.row_z] + g), zh = hn::Load(d, node.bound[p.row_z + 3] + g);
      const BV zn = p.mirrored ? Sub(hn::Set(d, p.z_low[lane]), zh) : Sub(zl, hn::Set(d, p.z_high[lane]));
      const BV zf = p.mirrored ? Sub(hn::Set(d, p.z_high[lane]), zl) : Sub(zh, hn::Set(d, p.z_low[lane]));
      const BV near = Max(Max(xn, yn), Max(zn, hn::Set(d, p.s_near[lane])));
      const BV far = Min(Min(xf, yf), Min(zf, hn::Set(d, p.s_far[lane])));
      hn::StoreU(near, d, nears + g);
      met |= bits_of(d, hn::Le(near, far)) << g;
    }
    const std::size_t bottom = top;
    for (; met != 0; met &= met - 1) {
      const int c = __builtin_ctz(met);
      std::size_t place = top++;
      for (; place > bottom && waiting_nodes_[place - 1].near < nears[c]; --place)
        waiting_nodes_[place] = waiting_nodes_[place - 1];
      waiting_nodes_[place] = {nears[c], node.first[c], node.count[c]};
    }
    return top;
  }

  void leaf_single(std::uint32_t lane, std::uint32_t quad, std::uint32_t count) {
    using Quad = hn::CappedTag<float, 4>;
    const Quad d;
    const RayPacket& p = packet_;
    counts_.triangle_tests += count;
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
          take_exactly(lane, q, static_cast<std::uint32_t>(__builtin_ctz(lanes)));
      }
    }
  }
