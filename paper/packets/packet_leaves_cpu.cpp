#include <algorithm>

#include "base/bits.h"
#include "paper/packets/packet_leaves.h"

namespace raysheaf {
void PacketLeaves::meet(const PacketWork& work) {
  sign_ = packet_sign(work.frustum, work.rays[0].direction);
  find_candidates(work);
  if (candidates_.empty()) return;
  setups_.clear();
  for (const Ray& ray : work.rays) setups_.push_back(make_ray_setup(ray));
  for (std::size_t first = 0; first < candidates_.size(); first += kPacketChunk) {
    const auto count =
        static_cast<std::uint32_t>(std::min<std::size_t>(kPacketChunk, candidates_.size() - first));
    meet_chunk(work, gather(work, first, count), count);
  }
}

void PacketLeaves::find_candidates(const PacketWork& work) {
  candidates_.clear();
  const PacketFrustum& f = work.frustum;
  for (const std::uint32_t leaf : work.leaves) {
    const BvhNode& node = bvh_.nodes[leaf / kBvhWidth];
    const std::uint32_t child = leaf % kBvhWidth;
    for (std::uint32_t i = 0; i < node.count[child]; ++i) {
      const std::uint32_t triangle = bvh_.triangles[node.first[child] + i];
      const Vec3 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
      if (!meets(f, a, b, c)) continue;
      candidates_.push_back({triangle_begin(f, sign_, a, b, c), triangle});
    }
    counts.triangle_tests += node.count[child];
  }
  counts.triangle_hits += candidates_.size();
  std::sort(candidates_.begin(), candidates_.end());
}

Depths PacketLeaves::gather(const PacketWork& work, std::size_t first, std::uint32_t count) {
  Depths depths;
  const int depth_axis = work.frustum.axis;
  const float origin = component(work.frustum.origin, depth_axis);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t triangle = candidates_[first + i].triangle;
    ids_[i] = triangle;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        corners_[k][axis][i] = triangles_.vertex[k][axis][triangle];
      depths.enlarge(sign_ * (triangles_.vertex[k][depth_axis][triangle] - origin));
    }
  }
  // Fills the last SIMD block: testing a triangle twice changes nothing.
  for (std::uint32_t i = count; i % kTriangleBlock != 0; ++i) {
    ids_[i] = ids_[i - 1];
    for (auto& corner : corners_)
      for (auto& axis : corner) axis[i] = axis[i - 1];
  }
  return depths;
}

void PacketLeaves::meet_chunk(const PacketWork& work, Depths depths, std::uint32_t count) {
  TriangleArrays arrays;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) arrays.vertex[k][axis] = corners_[k][axis].data();
  arrays.ids = ids_;
  arrays.count = div_ceil(count, kTriangleBlock) * kTriangleBlock;
  arrays.flags = triangles_.flags;
  for (std::size_t i = 0; i < work.rays.size; ++i) {
    RayHit& best = work.best[i];
    if (options_.early_out && best.found()) continue;
    const Vec3 from = work.rays[i].origin - work.frustum.origin;
    const float depth = sign_ * component(from, work.frustum.axis);
    const float nearest = least_t(setups_[i], depth, depths);
    if (nearest > best.t || nearest > setups_[i].t_max) continue;
    intersect_list(setups_[i], arrays, options_.facing, &best);
    counts.final_tests += count;
    if (!work.ray_tests.empty()) work.ray_tests[i] += static_cast<float>(count);
  }
}

}  // namespace raysheaf
