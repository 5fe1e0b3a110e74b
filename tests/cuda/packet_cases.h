// Every device function of packets and of the hierarchy over triangles, on random input.
#pragma once

#include "cuda/words.h"
#include "object_tree/bvh_node.h"
#include "paper/packets/cut_body.h"
#include "paper/packets/frustum_body.h"
#include "paper/packets/leaf_body.h"
#include "paper/packets/packet_cuts_device.h"
#include "paper/packets/packets.h"

namespace raysheaf::test {

struct PacketRays {
  static constexpr std::size_t kCount = 4;
  Ray rays[kCount];
  Box scene;
  int axis = 0;

  /// In one of eight cases the scene is too large to bound rays in it; in one of four, a ray is
  /// perpendicular to the axis.
  RAYSHEAF_HD explicit PacketRays(Draws& draws) {
    const Vec3 center = draws.in_box(5), along = draws.direction(), corner = draws.in_box(5);
    const float spread = draws.unit(), stretch = draws.below(8) == 0 ? 1e37f : 1;
    scene = {corner * stretch, (corner + abs(draws.in_box(9))) * stretch};
    axis = static_cast<int>(dominant_sense(along) / 2);
    for (Ray& ray : rays) {
      ray.origin = center + draws.in_box(1);
      ray.direction = along + draws.in_box(spread * spread);
      if (draws.below(2) == 0) ray.t_max = draws.between(0, 9);
    }
    if (draws.below(4) == 0) rays[1].direction = Vec3{0.5f, 0, 0};
  }
  [[nodiscard]] RAYSHEAF_HD View<const Ray> view() const { return {rays, kCount}; }
};

RAYSHEAF_HD inline void put_frustum(Words& out, const PacketFrustum& f) {
  for (int k = 0; k < 3; ++k) out.put(f.low[k], f.high[k]);
  for (int k = 0; k < 2; ++k) {
    out.put(f.upper_slope[k], f.upper_offset[k], f.lower_slope[k], f.lower_offset[k]);
  }
  out.put(f.lean, f.spread);
}

struct PacketBoundCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const PacketRays packet(draws);
    RayEnd ends[2 * PacketRays::kCount];
    const View<RayEnd> room(ends, 2 * PacketRays::kCount);
    const PacketFrustum f = bound_packet(packet.view(), packet.axis, packet.scene, room);
    put_frustum(out, f);
    for (int i = 0; i < 8; ++i) {
      const Vec3 a = draws.in_box(9), b = a + draws.in_box(2), c = a + draws.in_box(2);
      out.put(meets(f, a, b, c), meets(f, min(min(a, b), c), max(max(a, b), c)));
    }
  }
};

struct PacketPartsCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const PacketRays packet(draws);
    const RayPart part = part_in_scene(packet.rays[0], packet.scene);
    const RayEnd end = ray_end(packet.rays[0], packet.rays[1].origin, part.end);
    out.put(part.begin, part.end, end.at, end.slack, sum_of_sizes(end.at));
    RayEnd ends[2 * PacketRays::kCount];
    const View<RayEnd> room(ends, 2 * PacketRays::kCount);
    PacketFrustum f{};
    f.axis = packet.axis;
    out.put(measure_box(packet.view(), packet.scene, room, &f));
    choose_slopes(packet.view(), (packet.axis + 1) % 3, 0, &f);
    measure_planes({room.data, room.size}, (packet.axis + 1) % 3, 0, &f);
    put_frustum(out, f);
  }
};

struct PacketLeafCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const PacketRays packet(draws);
    RayEnd ends[2 * PacketRays::kCount];
    const PacketFrustum f = bound_packet(packet.view(), packet.axis, packet.scene,
                                         View<RayEnd>(ends, 2 * PacketRays::kCount));
    BvhNode node;
    node.children = kBvhWidth;
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      node.count[c] = static_cast<std::uint8_t>(draws.below(2));
      const Vec3 low = draws.in_box(9), high = low + abs(draws.in_box(3));
      node.set_box(c, {low, high});
    }
    const Met met = meet_children(f, node);
    out.put(std::uint32_t{met.nodes}, std::uint32_t{met.leaves}, ones(met.nodes), node.box(3).max);
    const float sign = packet_sign(f, packet.rays[0].direction);
    const Vec3 a = draws.in_box(9), b = draws.in_box(9), c = draws.in_box(9);
    out.put(sign, triangle_begin(f, sign, a, b, c), ordered_bits(a.x * draws.scale()));
    Depths depths;
    depths.enlarge(a.x);
    depths.enlarge(b.x);
    out.put(least_t(make_ray_setup(packet.rays[2]), c.x, depths), depths.begin, depths.end);
  }
};

struct PacketCutCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    constexpr std::uint32_t kRays = 12;
    std::uint32_t keys[kRays], key = 0;
    Ray rays[kRays];
    for (std::uint32_t i = 0; i < kRays; ++i) {
      keys[i] = key += draws.below(3) == 0 ? draws.below(1u << 20) : 0;
      rays[i].direction = draws.direction();
    }
    const View<const std::uint32_t> sorted(keys, draws.below(4) == 0 ? 0 : kRays);
    const std::uint32_t most = 1 + draws.below(5), place = draws.below(kRays);
    const Packet cell = packet_about(sorted, 24, most, kRays, place);
    const Packet part = even_part({3, kRays}, 1, even_parts({3, kRays}, most + 1));
    out.put(cell.first, cell.count, part.first, part.count,
            lower_half({keys, kRays}, {2, kRays - 2}, 1u << 19));
    std::uint32_t members[kRays], parted[kRays];
    for (std::uint32_t i = 0; i < kRays; ++i) members[i] = kRays - 1 - i;
    const View<const Ray> all(rays, kRays);
    const SenseCounts counts = count_senses(all, {members, kRays});
    part_members(all, counts, {members, kRays}, parted);
    Packet packets[kSenses];
    write_packets(counts, 5, packets);
    for (const std::uint32_t ray : parted) out.put(ray);
    for (std::uint32_t p = 0; p < counts.packets(); ++p) out.put(packets[p].first);
    const std::uint32_t starts[2] = {3, 5};
    out.put(cell_of({starts, 2}, place % 2, 9).count);
  }
};

struct BvhCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    BvhNode node;
    for (std::uint8_t& count : node.count) count = static_cast<std::uint8_t>(draws.below(3));
    for (std::uint32_t child = 0; child < kBvhWidth; ++child) out.put(node.is_leaf(child));
    out.put(leaf_ref(draws.below(1000), 3));
    out.put(dominant_sense(draws.in_box(1)));
  }
};

}  // namespace raysheaf::test
