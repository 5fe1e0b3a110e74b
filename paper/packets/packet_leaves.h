// The last step of a packet: tests of its rays with its leaves' triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "paper/packets/leaf_body.h"
#include "paper/packets/packet_traverse.h"

namespace raysheaf {

/// A packet, its bound, and its leaves.
struct PacketWork {
  const PacketFrustum& frustum;
  View<const Ray> rays;
  View<const std::uint32_t> leaves;
  View<RayHit> best;
  View<float> ray_tests;  ///< may be empty
};

struct LeafCounts {
  std::uint64_t triangle_tests = 0, triangle_hits = 0, final_tests = 0;
};

/// A thread's memory and code for this step, for one packet after another.
class PacketLeaves {
 public:
  PacketLeaves(const TriangleView& triangles, const Bvh& bvh, const PacketOptions& options)
      : triangles_(triangles), bvh_(bvh), options_(options) {
    for (auto& corner : corners_)
      for (auto& axis : corner) axis.resize(kPacketChunk);
  }

  void meet(const PacketWork& work);

  LeafCounts counts;  ///< summed over packets

 private:
  /// A triangle, and where it begins along the packet's axis, as an integer in the same order.
  struct Candidate {
    std::uint32_t begin;
    std::uint32_t triangle;
    bool operator<(const Candidate& other) const {
      return begin != other.begin ? begin < other.begin : triangle < other.triangle;
    }
  };
  void find_candidates(const PacketWork& work);
  Depths gather(const PacketWork& work, std::size_t first, std::uint32_t count);
  void meet_chunk(const PacketWork& work, Depths depths, std::uint32_t count);
  [[nodiscard]] Vec3 corner(std::uint32_t triangle, int k) const {
    return triangles_.corner(triangle, k);
  }

  const TriangleView triangles_;
  const Bvh& bvh_;
  const PacketOptions& options_;
  float sign_ = 1;  ///< of the packet's rays along its axis
  std::vector<Candidate> candidates_;
  std::vector<RaySetup> setups_;
  AlignedVector<float> corners_[3][3];
  std::uint32_t ids_[kPacketChunk] = {};
};

}  // namespace raysheaf
