#include "paper/bundle_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/bits.h"
#include "paper/bounds/bounds.h"
#include "paper/packets/frustum_body.h"
#include "paper/ray_hierarchy/node_test.h"

namespace raysheaf {
namespace {

using Triangles = std::vector<std::uint32_t>;

/// The triangles that a node's test accepts.
template <class Test>
Triangles accepted_by(const Test& test, const TriangleView& triangles) {
  Triangles found(std::size_t{div_ceil(triangles.count, kTriangleBlock)} * kTriangleBlock);
  found.resize(filter(test, fields_of<Test>(triangles), triangles.count, found.data()));
  return found;
}

/// In double precision and without slack: the reference for bounds.
bool passes_through(const Ray& ray, Vec3 center, float radius) {
  double v[3], d[3], dd = 0, vd = 0, distance2 = 0;
  for (int k = 0; k < 3; ++k) {
    v[k] = double{component(center, k)} - component(ray.origin, k);
    d[k] = component(ray.direction, k);
    dd += d[k] * d[k];
    vd += v[k] * d[k];
  }
  const double t = std::clamp<double>(vd / dd, ray.t_min, ray.t_max);
  for (int k = 0; k < 3; ++k) distance2 += (v[k] - t * d[k]) * (v[k] - t * d[k]);
  return distance2 <= double{radius} * radius;
}

/// The number of triangles whose bounding sphere a ray intersects. A finite cone around the rays
/// preselects triangles without missing any; these are tested one by one.
std::uint64_t needed_by(View<const Ray> rays, const TriangleView& triangles) {
  FiniteCone cone;
  bound_rays(rays, triangles.bounds, &cone);
  const Triangles near = accepted_by(make_node_test(cone), triangles);
  return static_cast<std::uint64_t>(
      std::count_if(near.begin(), near.end(), [&](std::uint32_t triangle) {
        const auto field = [&](int k) { return triangles.sphere[k][triangle]; };
        const Vec3 center{field(0), field(1), field(2)};
        return std::any_of(rays.begin(), rays.end(),
                           [&](const Ray& ray) { return passes_through(ray, center, field(3)); });
      }));
}

float origin_spread(View<const Ray> rays, const Box& scene) {
  Box box;
  for (const Ray& ray : rays) {
    box.min = min(box.min, ray.origin);
    box.max = max(box.max, ray.origin);
  }
  const float whole = length(scene.max - scene.min);
  return whole > 0 ? length(box.max - box.min) / whole : 0;
}

float direction_spread(View<const Ray> rays) {
  Vec3 sum{0, 0, 0};
  for (const Ray& ray : rays) sum = sum + normalized(ray.direction);
  if (!(length(sum) > 0)) return 180;
  const Vec3 mean = normalized(sum);
  double widest = 0;
  for (const Ray& ray : rays) {
    const Vec3 d = normalized(ray.direction);
    widest = std::max(widest, std::atan2(double{length(cross(mean, d))}, double{dot(mean, d)}));
  }
  return static_cast<float>(widest * 180 / std::numbers::pi);
}

BundleSample measured(View<const Ray> rays, const TriangleView& triangles, std::uint32_t level,
                      std::uint64_t accepted) {
  BundleSample sample;
  sample.level = level;
  sample.rays = static_cast<std::uint32_t>(rays.size);
  sample.origin_spread = origin_spread(rays, triangles.bounds);
  sample.direction_spread = direction_spread(rays);
  sample.accepted = accepted;
  sample.needed = needed_by(rays, triangles);
  return sample;
}

/// Adds `measure(i)` for `most` of `count` bundles, evenly spaced.
template <class Measure>
void add_samples(const Executor& executor, std::size_t count, std::uint32_t most,
                 std::vector<BundleSample>* samples, const Measure& measure) {
  const std::size_t taken = std::min<std::size_t>(count, most), before = samples->size();
  samples->resize(before + taken);
  executor.for_each(taken, 1,
                    [&](std::size_t i) { (*samples)[before + i] = measure(i * count / taken); });
}

std::uint64_t triangles_in(const PacketFrustum& frustum, const TriangleView& triangles) {
  std::uint64_t count = 0;
  for (std::uint32_t t = 0; t < triangles.count; ++t)
    count += meets(frustum, triangles.corner(t, 0), triangles.corner(t, 1), triangles.corner(t, 2))
                 ? 1
                 : 0;
  return count;
}

}  // namespace

template <class Bound>
void sample_bundles(const Executor& executor, const TriangleView& triangles,
                    const RayHierarchy<Bound>& tree, View<const Ray> rays, std::uint32_t most,
                    std::vector<BundleSample>* samples) {
  for (std::uint32_t level = tree.top(); level >= 1; --level) {
    std::size_t node_rays = 1;
    for (std::uint32_t l = 0; l < level; ++l) node_rays *= tree.branching;
    const std::vector<Bound>& nodes = tree.level(level);
    add_samples(executor, nodes.size(), most, samples, [&](std::size_t i) {
      const std::size_t first = i * node_rays;
      const View<const Ray> in = rays.slice(first, std::min(node_rays, rays.size - first));
      return measured(in, triangles, level,
                      accepted_by(make_node_test(nodes[i]), triangles).size());
    });
  }
}

#define RAYSHEAF_SAMPLE(Bound)                                                                   \
  template void sample_bundles(const Executor&, const TriangleView&, const RayHierarchy<Bound>&, \
                               View<const Ray>, std::uint32_t, std::vector<BundleSample>*);
RAYSHEAF_SAMPLE(RayBound)
RAYSHEAF_SAMPLE(FiniteCone)
RAYSHEAF_SAMPLE(Shaft)
RAYSHEAF_SAMPLE(Frustum)
RAYSHEAF_SAMPLE(ShaftCone)
#undef RAYSHEAF_SAMPLE

void sample_bundles(const Executor& executor, const TriangleView& triangles,
                    View<const Packet> packets, View<const Ray> rays, std::uint32_t most,
                    std::vector<BundleSample>* samples) {
  add_samples(executor, packets.size, most, samples, [&](std::size_t i) {
    const View<const Ray> in = rays.slice(packets[i].first, packets[i].count);
    std::vector<RayEnd> ends(2 * in.size);
    const auto axis = static_cast<int>(dominant_sense(in[0].direction) / 2);
    const PacketFrustum frustum = bound_packet(in, axis, triangles.bounds, ends);
    return measured(in, triangles, 1, triangles_in(frustum, triangles));
  });
}

}  // namespace raysheaf
