#include <algorithm>

#include "base/bits.h"
#include "packet/packet_leaves.h"

namespace raysheaf {
namespace {

/// An integer that grows with `x`.
std::uint32_t ordered_bits(float x) {
  const std::uint32_t bits = float_bits(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// A bound from below on t of any hit of the ray with triangles between two depths.
///
/// t is a mean of the corners' scaled depths with weights of one sign, so it is at least the least
/// of them, but for gamma(8) of the largest (intersect/triangle_body.h); depths that are seen from
/// the frustum's origin err by two roundings more. gamma(64) is above both.
float least_t(const RaySetup& ray, float ray_depth, float begin, float end) {
  const float size = std::fmax(std::fabs(begin), std::fabs(end)) + std::fabs(ray_depth);
  return ((begin - ray_depth) - gamma(64) * size) * std::fabs(ray.shear_z);
}

}  // namespace

void PacketLeaves::meet(const PacketWork& work) {
  sign_ = component(work.rays[0].direction, work.frustum.axis) < 0 ? -1.0f : 1.0f;
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
      const Vec3 begin = sign_ < 0 ? max(max(a, b), c) : min(min(a, b), c);
      candidates_.push_back({ordered_bits(sign_ * component(begin - f.origin, f.axis)), triangle});
    }
    counts.triangle_tests += node.count[child];
  }
  counts.triangle_hits += candidates_.size();
  std::sort(candidates_.begin(), candidates_.end());
}

PacketLeaves::Depths PacketLeaves::gather(const PacketWork& work, std::size_t first,
                                          std::uint32_t count) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Depths depths{kInfinity, -kInfinity};
  const int depth_axis = work.frustum.axis;
  const float origin = component(work.frustum.origin, depth_axis);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t triangle = candidates_[first + i].triangle;
    ids_[i] = triangle;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        corners_[k][axis][i] = triangles_.vertex[k][axis][triangle];
      const float depth = sign_ * (triangles_.vertex[k][depth_axis][triangle] - origin);
      depths.begin = std::fmin(depths.begin, depth);
      depths.end = std::fmax(depths.end, depth);
    }
  }
  // Whole SIMD blocks: a triangle that is met twice changes nothing.
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
    const float nearest = least_t(setups_[i], depth, depths.begin, depths.end);
    if (nearest > best.t || nearest > setups_[i].t_max) continue;
    intersect_list(setups_[i], arrays, options_.facing, &best);
    counts.final_tests += count;
    if (!work.ray_tests.empty()) work.ray_tests[i] += static_cast<float>(count);
  }
}

}  // namespace raysheaf
