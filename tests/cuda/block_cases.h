// One thread tests a block's rays against its tree and records the hits.
#pragma once

#include "cuda/words.h"
#include "out_of_core/block_queries_device.h"

namespace raysheaf::test {

/// Eight triangles in two parts.
struct TinyBlock {
  static constexpr std::uint32_t kCount = 8;
  Vec3 positions[12];
  std::uint32_t corners[3 * kCount];
  std::uint32_t prim_ids[kCount];
  BlockPart parts[2] = {{4, 1, 0, 3}, {4, 6, 3, 5}};

  RAYSHEAF_HD explicit TinyBlock(Draws& draws) {
    for (Vec3& p : positions) p = draws.in_box(3);
    for (std::uint32_t& c : corners) c = draws.below(12);
    for (std::uint32_t i = 0; i < kCount; ++i) prim_ids[i] = 10 + i;
  }
  [[nodiscard]] RAYSHEAF_HD BlockView view() const {
    BlockView block;
    block.number = 5;
    block.positions = View<const Vec3>(positions, 12);
    block.corners = corners;
    block.prim_ids = View<const std::uint32_t>(prim_ids, kCount);
    block.parts = View<const BlockPart>(parts, 2);
    return block;
  }
};

struct BlockHitCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const TinyBlock block(draws);
    StreamHit best;
    for (int i = 0; i < 4; ++i) {
      IndexedHit found;
      found.t = static_cast<float>(draws.below(3));
      found.triangle = draws.below(TinyBlock::kCount);
      const Hit named = hit_in_block(block.view(), found);
      out.put(named.t, named.prim_id, named.inst_id, comes_before(named, best.hit));
      out.put(take_least(block.view(), found, &best), best.part, best.hit.t);
    }
    out.put(part_of_triangle(block.view().parts, draws.below(8)), best.corner[2]);
  }
};

struct BlockRayCase {
  static constexpr std::uint32_t kRays = 40;

  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    Ray rays[kRays];
    std::uint32_t numbers[kRays];
    const Box scene{{-4, -4, -4}, {4, 4, 4}};
    for (std::uint32_t i = 0; i < kRays; ++i) {
      rays[i].origin = draws.in_box(6);
      rays[i].direction = draws.direction();
      rays[i].t_max = draws.below(2) == 0 ? draws.between(0, 5) : rays[i].t_max;
      numbers[i] = draws.below(5) == 0 ? kInvalidId : i;
    }
    Shaft shafts[3];
    BeamTest tests[4];
    for (std::uint32_t i = 0; i < nodes_above(kRays); ++i) {
      const std::uint32_t first = i * kRayBranching;
      const std::uint32_t count = kRays - first < kRayBranching ? kRays - first : kRayBranching;
      bound_rays(View<const Ray>(rays + first, count), scene, &shafts[i]);
      tests[i] = make_node_test(shafts[i]);
    }
    Shaft top;
    bound_children(View<const Shaft>(shafts, 3), &top);
    tests[3] = make_node_test(top);
    RayState state;
    state.rays = View<Ray>(rays, kRays);
    state.numbers = numbers;
    state.levels.count = 2;
    state.levels.level[0] = tests;
    state.levels.level[1] = tests + 3;
    state.levels.size[0] = 3;
    state.levels.size[1] = 1;
    const Vec3 corner = draws.in_box(4);
    const Box box{corner, corner + abs(draws.in_box(1))};
    std::uint32_t found = 0, reached = 0, flag = 0;
    for_leaves_met(state.levels, 1, 0, box, [&](std::size_t leaf) {
      found += leaf_meets(state, leaf, box) ? 1u << leaf : 0;
      return true;
    });
    BlockPassage passage;
    passage.state = state;
    passage.met = &flag;
    WalkCounts counts[kRays];
    passage.counts = counts;
    for (std::uint32_t i = 0; i < kRays; ++i) {
      reached += comes_to(passage, i, box) ? 1 + i : 0;
      add_counts(passage, i, {i, 2});
    }
    raise_flag(&flag);
    out.put(found, reached, flag, squared_gap(shafts[1].origins, box), may_meet(rays[7], box));
    out.put(is_reached(state.levels, 0, 2, box), counts[3].box_tests, counts[9].triangle_tests);
  }
};

}  // namespace raysheaf::test
