#include "lab/bundle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "methods/dual/bundle16.h"
#include "methods/dual/ray_order.h"
#include "paper/bounds/bounds.h"
#include "paper/order/ray_order.h"
#include "paper/packets/frustum_body.h"
#include "paper/packets/packets.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "queries/plan.h"
#include "render/frame/dual_tracer.h"

namespace raysheaf {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Box kEverywhere{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};

// Describes the bounds of all methods as `BundleVolume`.

void describe(const RayBound& bound, BundleVolume* volume) {
  volume->has_cone = true;
  volume->center = bound.origins.center;
  volume->radius = bound.origins.radius;
  volume->axis = bound.directions.axis;
  volume->sin_angle = bound.directions.sin_angle;
  volume->reach = kInfinity;
}
void describe(const FiniteCone& bound, BundleVolume* volume) {
  describe(bound.rays, volume);
  volume->reach = bound.reach;
}
void describe_hull(const Box& origins, const Box& ends, const Box& within, BundleVolume* volume) {
  volume->has_hull = true;
  volume->origins = origins;
  volume->ends = ends;
  volume->within = within;
}
void describe(const Shaft& bound, BundleVolume* volume) {
  describe_hull(bound.origins, bound.ends, kEverywhere, volume);
}
void describe(const Frustum& bound, BundleVolume* volume) {
  describe_hull(bound.origins,
                {bound.origins.min + bound.directions.min * bound.reach,
                 bound.origins.max + bound.directions.max * bound.reach},
                bound.hull, volume);
}
void describe(const ShaftCone& bound, BundleVolume* volume) {
  describe(bound.shaft, volume);
  describe(bound.cone, volume);
}

Vec3 with(Vec3 v, int axis, float value) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = value;
  return v;
}

/// The planes at both ends of its box.
void describe(const PacketFrustum& f, BundleVolume* volume) {
  const auto across = [&f](float along) {
    Box box;
    for (int k = 0; k < 3; ++k) {
      const int plane = (k - f.axis + 2) % 3;  // 2: the axis itself
      const float low = plane == 2 ? along : f.lower_slope[plane] * along + f.lower_offset[plane];
      const float high = plane == 2 ? along : f.upper_slope[plane] * along + f.upper_offset[plane];
      box.min = with(box.min, k, component(f.origin, k) + std::fmin(low, high));
      box.max = with(box.max, k, component(f.origin, k) + std::fmax(low, high));
    }
    return box;
  };
  describe_hull(across(f.low[f.axis]), across(f.high[f.axis]),
                {f.origin + Vec3{f.low[0], f.low[1], f.low[2]},
                 f.origin + Vec3{f.high[0], f.high[1], f.high[2]}},
                volume);
}

/// A beam of `dual`: the cross-sections of its rays at the two ends of their extent along the axis.
void describe_beam(View<const Ray> rays, const Box& scene, int axis, BundleVolume* volume) {
  float low = kInfinity, high = -kInfinity;
  for (const Ray& ray : rays) {
    const Box end = end_of(ray, scene);
    const float start = component(ray.origin + ray.direction * ray.t_min, axis);
    low = std::fmin(low, std::fmin(start, component(end.min, axis)));
    high = std::fmax(high, std::fmax(start, component(end.max, axis)));
  }
  const auto across = [&](float along) {
    Box box;
    for (const Ray& ray : rays) {
      const float t = (along - component(ray.origin, axis)) / component(ray.direction, axis);
      const Vec3 at = with(ray.origin + ray.direction * t, axis, along);
      box = box_union(box, {at, at});
    }
    return box;
  };
  describe_hull(across(low), across(high), kEverywhere, volume);
}

std::string counted(std::size_t rays, const char* what) {
  return std::to_string(rays) + (rays == 1 ? " ray" : " rays") + what;
}

RayBundle alone(const Ray& ray, std::string what) {
  RayBundle bundle;
  bundle.rays.push_back(ray);
  bundle.what = std::move(what);
  return bundle;
}

/// The rays [first, first + count) of an order; one of them is `ray`.
template <class Order>
RayBundle taken(View<const Ray> rays, const Order& order, std::size_t first, std::size_t count,
                std::size_t ray) {
  RayBundle bundle;
  for (std::size_t i = first; i < first + count; ++i) {
    if (order[i] == ray) bundle.ray = bundle.rays.size();
    bundle.rays.push_back(rays[order[i]]);
  }
  return bundle;
}

std::size_t place_of(View<const std::uint32_t> order, std::size_t ray) {
  return static_cast<std::size_t>(
      std::find(order.begin(), order.end(), static_cast<std::uint32_t>(ray)) - order.begin());
}

RayBundle hierarchy_bundle(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                           std::size_t ray, const MethodSettings& settings) {
  BatchStatistics not_kept;
  const auto order = ray_order(executor, batch, scene.bounds, settings, &not_kept);
  std::vector<Ray> rays(order.size());
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = batch.rays[order[i]];
  std::size_t node = place_of(order, ray) / settings.branching;
  const std::size_t first = node * settings.branching;
  RayBundle bundle = taken(batch.rays, order, first,
                           std::min<std::size_t>(settings.branching, rays.size() - first), ray);
  with_bound(settings.bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
    const RayHierarchy<Bound> tree =
        build_hierarchy<Bound>(executor, rays, scene.bounds, settings.branching, settings.levels);
    std::size_t span = settings.branching;
    for (std::uint32_t level = 1; level <= tree.top(); ++level) {
      BundleVolume& volume = bundle.volumes.emplace_back();
      volume.ray_count = std::min(span, rays.size() - node * span);
      describe(tree.level(level)[node], &volume);
      node /= settings.branching;
      span *= settings.branching;
    }
  });
  bundle.what = counted(bundle.rays.size(), ", a leaf; ") + to_string(settings.bound) + ", " +
                std::to_string(settings.levels) + (settings.levels == 1 ? " level" : " levels");
  return bundle;
}

RayBundle packet_bundle(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                        std::size_t ray, const MethodSettings& settings) {
  BatchStatistics not_kept;
  auto order = ray_order(executor, batch, scene.bounds, settings, &not_kept);
  std::vector<std::uint32_t> keys;
  if (settings.key == RayKey::kCrsh)
    for (const std::uint32_t i : order) keys.push_back(batch.keys[i]);
  const std::vector<Packet> packets =
      make_packets(executor, batch.rays, keys, batch.key_bits, kPacketRays, order);
  const std::size_t place = place_of(order, ray);
  const Packet packet = *std::find_if(packets.begin(), packets.end(), [place](const Packet& p) {
    return place >= p.first && place < p.first + p.count;
  });
  RayBundle bundle = taken(batch.rays, order, packet.first, packet.count, ray);
  std::vector<RayEnd> ends(2 * bundle.rays.size());
  const auto axis = static_cast<int>(dominant_sense(bundle.rays[0].direction) / 2);
  BundleVolume& volume = bundle.volumes.emplace_back();
  volume.ray_count = packet.count;
  describe(bound_packet(bundle.rays, axis, scene.bounds, ends), &volume);
  bundle.what = counted(packet.count, ", a packet in its frustum");
  return bundle;
}

RayBundle dual_bundle(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                      std::size_t ray) {
  const bool any = asks_occlusion(batch);
  View<const Ray> rays = batch.rays;
  if (any) {
    const std::vector<std::size_t> ends = query_ends(batch);
    const auto end = std::upper_bound(ends.begin(), ends.end(), ray);
    rays = rays.slice(end[-1], *end - end[-1]);
    ray -= end[-1];
  }
  const RayPlan plan = plan_rays(RaysInPlace(rays));
  if (plan.bundle != Bundle::kStream)
    return alone(rays[ray], "1 ray of a long stream: a box is tested with each ray of its list");
  RayOrder order;
  order_rays(executor, rays, &order, plan.row);
  const std::size_t place = place_of({order.rays.data(), rays.size}, ray);
  const auto* after = std::upper_bound(order.starts.begin(), order.starts.end(), place);
  const std::size_t first = after[-1] + (place - after[-1]) / kBundleWidth * kBundleWidth;
  RayBundle bundle =
      taken(rays, order.rays, first, std::min<std::size_t>(kBundleWidth, *after - first), ray);
  BundleVolume& volume = bundle.volumes.emplace_back();
  volume.ray_count = bundle.rays.size();
  const auto axis = static_cast<int>(quarter_of(bundle.rays[0].direction) / 8);
  describe_beam(bundle.rays, scene.bounds, axis, &volume);
  bundle.what = counted(bundle.rays.size(), " of a stream, a bundle in its beam");
  return bundle;
}

}  // namespace

RayBundle find_bundle(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                      std::size_t ray, const MethodSettings& settings) {
  switch (settings.traversal) {
    case Traversal::kBruteForce:
      return alone(batch.rays[ray], "1 ray: brute force makes no bundles");
    case Traversal::kRayHierarchy:
      return hierarchy_bundle(executor, scene, batch, ray, settings);
    case Traversal::kPackets:
      return packet_bundle(executor, scene, batch, ray, settings);
    case Traversal::kDual:
      break;
  }
  return dual_bundle(executor, scene, batch, ray);
}

}  // namespace raysheaf
