// Rays go into Embree's structures and hits come out of them in here: both are timed, for they
// answer the same call as the library does.
#include "compare/calls.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>

namespace raysheaf::app {
namespace {

constexpr std::size_t kPacket = 16;

/// Lane `lane` of a packet, or a single ray, which has the fields without lanes.
void set_ray(RTCRay16& to, std::size_t lane, const Ray& ray) {
  to.org_x[lane] = ray.origin.x;
  to.org_y[lane] = ray.origin.y;
  to.org_z[lane] = ray.origin.z;
  to.tnear[lane] = ray.t_min;
  to.dir_x[lane] = ray.direction.x;
  to.dir_y[lane] = ray.direction.y;
  to.dir_z[lane] = ray.direction.z;
  to.time[lane] = 0;
  to.tfar[lane] = ray.t_max;
  to.mask[lane] = ~0u;
  to.id[lane] = 0;
  to.flags[lane] = 0;
}

void set_ray(RTCRay& to, const Ray& ray) {
  to = {ray.origin.x,
        ray.origin.y,
        ray.origin.z,
        ray.t_min,
        ray.direction.x,
        ray.direction.y,
        ray.direction.z,
        0,
        ray.t_max,
        ~0u,
        0,
        0};
}

/// -1 for each lane with a ray; the others get a ray that is switched off.
void fill(RTCRay16& packet, int* valid, std::span<const Ray> rays) {
  for (std::size_t lane = 0; lane < kPacket; ++lane) {
    valid[lane] = lane < rays.size() ? -1 : 0;
    set_ray(packet, lane, rays[lane < rays.size() ? lane : 0]);
  }
}

void forget_hits(RTCHit16& hits) {
  for (std::size_t lane = 0; lane < kPacket; ++lane) {
    hits.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    hits.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

void read_hits(const RTCRayHit16& packet, std::span<Hit> hits) {
  for (std::size_t lane = 0; lane < hits.size(); ++lane) {
    Hit hit;
    if (packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID)
      hit = {packet.ray.tfar[lane],   packet.hit.u[lane],      packet.hit.v[lane],
             packet.hit.primID[lane], packet.hit.geomID[lane], kInvalidId};
    hits[lane] = hit;
  }
}

Hit read_hit(const RTCRayHit& from) {
  if (from.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {from.ray.tfar, from.hit.u, from.hit.v, from.hit.primID, from.hit.geomID, kInvalidId};
}

/// Embree marks an occluded ray by tfar = -inf.
std::uint8_t is_occluded(float tfar) {
  return tfar < 0 ? 1 : 0;
}

using Rays = std::span<const Ray>;
using Hits = std::span<Hit>;
using Flags = std::span<std::uint8_t>;

void closest_single(RTCScene scene, RTCIntersectContext& context, Rays rays, Hits hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RTCRayHit query;
    set_ray(query.ray, rays[i]);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    hits[i] = read_hit(query);
  }
}

void any_single(RTCScene scene, RTCIntersectContext& context, Rays rays, Flags occluded) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RTCRay query;
    set_ray(query, rays[i]);
    rtcOccluded1(scene, &context, &query);
    occluded[i] = is_occluded(query.tfar);
  }
}

void closest_packets(RTCScene scene, RTCIntersectContext& context, Rays rays, Hits hits) {
  for (std::size_t i = 0; i < rays.size(); i += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - i);
    alignas(64) int valid[kPacket];
    RTCRayHit16 query;
    fill(query.ray, valid, rays.subspan(i, count));
    forget_hits(query.hit);
    rtcIntersect16(valid, scene, &context, &query);
    read_hits(query, hits.subspan(i, count));
  }
}

void any_packets(RTCScene scene, RTCIntersectContext& context, Rays rays, Flags occluded) {
  for (std::size_t i = 0; i < rays.size(); i += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - i);
    alignas(64) int valid[kPacket];
    RTCRay16 query;
    fill(query, valid, rays.subspan(i, count));
    rtcOccluded16(valid, scene, &context, &query);
    for (std::size_t k = 0; k < count; ++k) occluded[i + k] = is_occluded(query.tfar[k]);
  }
}

/// A stream has no lanes to switch off: what its last packet lacks are rays that end before they
/// begin.
void switch_off(RTCRay16& packet, std::size_t from) {
  for (std::size_t lane = from; lane < kPacket; ++lane) {
    packet.tnear[lane] = 1;
    packet.tfar[lane] = 0;
  }
}

template <class Query, class RayOf>
unsigned fill_stream(std::array<Query, kRaysATask / kPacket>& queries, Rays rays,
                     const RayOf& ray_of) {
  unsigned packets = 0;
  for (std::size_t i = 0; i < rays.size(); i += kPacket, ++packets) {
    const std::size_t count = std::min(kPacket, rays.size() - i);
    int not_used[kPacket];
    fill(ray_of(queries[packets]), not_used, rays.subspan(i, count));
    switch_off(ray_of(queries[packets]), count);
  }
  return packets;
}

void closest_stream(RTCScene scene, RTCIntersectContext& context, Rays rays, Hits hits) {
  std::array<RTCRayHit16, kRaysATask / kPacket> queries;
  const unsigned packets =
      fill_stream(queries, rays, [](RTCRayHit16& q) -> RTCRay16& { return q.ray; });
  for (unsigned p = 0; p < packets; ++p) forget_hits(queries[p].hit);
  rtcIntersectNM(scene, &context, reinterpret_cast<RTCRayHitN*>(queries.data()), kPacket, packets,
                 sizeof(RTCRayHit16));
  for (std::size_t i = 0; i < rays.size(); i += kPacket)
    read_hits(queries[i / kPacket], hits.subspan(i, std::min(kPacket, rays.size() - i)));
}

void any_stream(RTCScene scene, RTCIntersectContext& context, Rays rays, Flags occluded) {
  std::array<RTCRay16, kRaysATask / kPacket> queries;
  const unsigned packets = fill_stream(queries, rays, [](RTCRay16& q) -> RTCRay16& { return q; });
  rtcOccludedNM(scene, &context, reinterpret_cast<RTCRayN*>(queries.data()), kPacket, packets,
                sizeof(RTCRay16));
  for (std::size_t i = 0; i < rays.size(); ++i)
    occluded[i] = is_occluded(queries[i / kPacket].tfar[i % kPacket]);
}

constexpr EmbreeCall kCalls[] = {
    {"intersect1", "occluded1", false, closest_single, any_single},
    {"intersect16", "occluded16", false, closest_packets, any_packets},
    {"intersect16 coherent", "occluded16 coherent", true, closest_packets, any_packets},
    {"intersectNM", "occludedNM", false, closest_stream, any_stream},
    {"intersectNM coherent", "occludedNM coherent", true, closest_stream, any_stream},
};

}  // namespace

std::span<const EmbreeCall> embree_calls() {
  return kCalls;
}

}  // namespace raysheaf::app
