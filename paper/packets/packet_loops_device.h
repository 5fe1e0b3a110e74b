// The stages of `gl10` as loops. For sources that include a device.
#pragma once

#include "base/search.h"
#include "device/brute_force_body.h"
#include "exec/atomic.h"
#include "exec/device.h"
#include "paper/packets/leaf_body.h"
#include "paper/packets/packet_traverse.h"

namespace raysheaf {

/// The data that packets are tested with, on the device.
struct PacketView {
  View<const Ray> rays;
  View<const Packet> packets;
  const PacketFrustum* frusta = nullptr;
  TriangleList list;
  const BvhNode* nodes = nullptr;
  const std::uint32_t* triangles = nullptr;  ///< of the hierarchy's leaves
  Facing facing = Facing::kBoth;
  bool early_out = false;
};

/// Packets, and nodes or leaves.
struct PacketPairs {
  std::uint32_t *packets, *places;
};

template <class Device>
void bound_packets_on(Device& device, View<const Ray> rays, View<const Packet> packets, Box scene,
                      RayEnd* ends, PacketFrustum* frusta) {
  device.for_each("hierarchy: packets", packets.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Packet packet = packets.data[i];
    const View<const Ray> own(rays.data + packet.first, packet.count);
    const auto axis = static_cast<int>(dominant_sense(own.data[0].direction) / 2);
    frusta[i] = bound_packet(
        own, axis, scene,
        View<RayEnd>(ends + std::size_t{2} * packet.first, std::size_t{2} * packet.count));
  });
}

template <class Device>
void begin_queue_on(Device& device, std::uint32_t first, std::size_t count, PacketPairs out) {
  device.for_each("trace: queue", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out.packets[i] = first + static_cast<std::uint32_t>(i);
    out.places[i] = 0;
  });
}

/// Counts of each pair: tested boxes, intersected nodes and leaves.
struct PairCounts {
  std::uint32_t *boxes, *nodes, *leaves;
};

template <class Device>
void meet_nodes_on(Device& device, const PacketView& view, PacketPairs queue, std::size_t size,
                   Met* met, PairCounts counts) {
  device.for_each("trace: boxes", size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const BvhNode& node = view.nodes[queue.places[i]];
    met[i] = meet_children(view.frusta[queue.packets[i]], node);
    counts.boxes[i] = node.children;
    counts.nodes[i] = ones(met[i].nodes);
    counts.leaves[i] = ones(met[i].leaves);
  });
}

/// Moves the intersected nodes to `next` and the leaves to `leaves`, at places computed by scans.
template <class Device>
void advance_on(Device& device, const PacketView& view, PacketPairs queue, std::size_t size,
                const Met* met, const std::uint64_t* node_places, PacketPairs next,
                const std::uint64_t* leaf_places, PacketPairs leaves) {
  device.for_each("trace: queue", size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t packet = queue.packets[i], place = queue.places[i];
    const BvhNode& node = view.nodes[place];
    std::uint64_t to_next = node_places[i], to_leaves = leaf_places[i];
    for (std::uint32_t c = 0; c < node.children; ++c) {
      if ((met[i].nodes >> c & 1) != 0) {
        next.packets[to_next] = packet;
        next.places[to_next++] = node.first[c];
      }
      if ((met[i].leaves >> c & 1) != 0) {
        leaves.packets[to_leaves] = packet;
        leaves.places[to_leaves++] = leaf_ref(place, c);
      }
    }
  });
}

/// Calls `take(triangle, begin)` for the triangles of pair `i`'s leaf that its packet may hit;
/// returns how many were tested.
template <class Take>
RAYSHEAF_HD std::uint32_t meet_leaf_pair(const PacketView& view, PacketPairs leaves, std::size_t i,
                                         const Take& take) {
  const std::uint32_t packet = leaves.packets[i], leaf = leaves.places[i];
  const PacketFrustum& frustum = view.frusta[packet];
  const BvhNode& node = view.nodes[leaf / kBvhWidth];
  const std::uint32_t child = leaf % kBvhWidth;
  const Ray& first = view.rays.data[view.packets.data[packet].first];
  const float sign = packet_sign(frustum, first.direction);
  for (std::uint32_t k = 0; k < node.count[child]; ++k) {
    const std::uint32_t triangle = view.triangles[node.first[child] + k];
    const Vec3* const corner = view.list.corners.data + std::size_t{3} * triangle;
    if (meets(frustum, corner[0], corner[1], corner[2]))
      take(triangle, triangle_begin(frustum, sign, corner[0], corner[1], corner[2]));
  }
  return node.count[child];
}

template <class Device>
void count_candidates_on(Device& device, const PacketView& view, PacketPairs leaves,
                         std::size_t size, std::uint32_t* tests, std::uint32_t* hits) {
  device.for_each("trace: leaves", size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    std::uint32_t met = 0;
    tests[i] = meet_leaf_pair(view, leaves, i, [&](std::uint32_t, std::uint32_t) { ++met; });
    hits[i] = met;
  });
}

/// Triangles that a packet may hit: the keys have its packet in the upper bits, and where the
/// triangle begins in the lower ones.
struct Candidates {
  std::uint32_t* triangles;
  std::uint64_t* keys;
};

template <class Device>
void list_candidates_on(Device& device, const PacketView& view, PacketPairs leaves,
                        std::size_t size, const std::uint64_t* places, Candidates out) {
  device.for_each("trace: leaves", size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    std::uint64_t at = places[i];
    meet_leaf_pair(view, leaves, i, [&](std::uint32_t triangle, std::uint32_t begin) {
      out.triangles[at] = triangle;
      out.keys[at++] = std::uint64_t{leaves.packets[i]} << 32 | begin;
    });
  });
}

/// The input of a ray: its packet's sorted candidates.
struct SortedCandidates {
  View<const std::uint64_t> keys;  ///< ascending by (packet, begin), then by triangle
  const std::uint32_t* triangles;
};

/// Tests the rays [first, first + count) with their packets' candidates in order, chunk by chunk; a
/// ray skips a chunk that begins behind its hit.
template <class Device>
void meet_candidates_on(Device& device, const PacketView& view, SortedCandidates sorted,
                        Packet range, RayHit* best, std::uint64_t* final_tests) {
  device.for_each("trace: final tests", range.count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t number = range.first + i;
    const auto packet_begin = [&](std::size_t p) { return view.packets.data[p].first; };
    const std::size_t packet =
        first_not_below(packet_begin, view.packets.size, std::uint64_t{number} + 1) - 1;
    const auto key = [&](std::size_t k) { return sorted.keys.data[k]; };
    const std::size_t begin = first_not_below(key, sorted.keys.size, std::uint64_t{packet} << 32);
    const std::size_t end =
        first_not_below(key, sorted.keys.size, (std::uint64_t{packet} + 1) << 32);
    if (begin == end) return;
    const PacketFrustum& frustum = view.frusta[packet];
    const Ray& first_ray = view.rays.data[view.packets.data[packet].first];
    const float sign = packet_sign(frustum, first_ray.direction);
    const float origin = component(frustum.origin, frustum.axis);
    const RaySetup setup = make_ray_setup(view.rays.data[number]);
    const float depth =
        sign * component(view.rays.data[number].origin - frustum.origin, frustum.axis);
    RayHit nearest;
    std::uint64_t tests = 0;
    for (std::size_t chunk = begin; chunk < end; chunk += kPacketChunk) {
      if (view.early_out && nearest.found()) break;
      const std::size_t chunk_end = chunk + kPacketChunk < end ? chunk + kPacketChunk : end;
      Depths depths;
      for (std::size_t k = chunk; k < chunk_end; ++k) {
        const Vec3* const corner = view.list.corners.data + std::size_t{3} * sorted.triangles[k];
        for (int c = 0; c < 3; ++c)
          depths.enlarge(sign * (component(corner[c], frustum.axis) - origin));
      }
      const float least = least_t(setup, depth, depths);
      if (least > nearest.t || least > setup.t_max) continue;
      for (std::size_t k = chunk; k < chunk_end; ++k)
        meet_list(view.list, sorted.triangles[k], sorted.triangles[k] + 1, {view.facing}, setup,
                  [&](const IndexedHit& hit) { nearest.take(hit.t, hit.triangle); });
      tests += chunk_end - chunk;
    }
    best[number] = nearest;
    add_to(final_tests, tests);
  });
}

/// Initializes the hits of rays whose packets have no leaves.
template <class Device>
void begin_hits_on(Device& device, View<RayHit> best) {
  device.for_each("trace: final tests", best.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { best.data[i] = RayHit{}; });
}

/// Copies the hits of rays in the packets' order to the caller's places.
template <class Device>
void scatter_best_on(Device& device, const PacketView& view, View<const RayHit> best,
                     const std::uint32_t* order, IndexedHit* hits) {
  device.for_each("trace: hits", best.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const RayHit hit = best.data[i];
    const std::uint64_t word = hit.found() ? hit_word(hit.t, hit.triangle) : kNoHitWord;
    hits[order[i]] = hit_of_word(view.list, word, view.rays.data[i]);
  });
}

}  // namespace raysheaf
