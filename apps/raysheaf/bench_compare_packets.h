// Rays into Embree's structures and hits out of them, a block of rays at a time. Both are timed:
// they answer the same call as the library does.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <span>

#include "raysheaf/types.h"

namespace raysheaf::app {

inline constexpr std::size_t kPacket = 16;
inline constexpr std::size_t kBlock = 1024;  ///< rays a task

/// Lane `lane` of a packet, or a single ray, which has the fields without lanes.
inline void set_ray(RTCRay16& to, std::size_t lane, const Ray& ray) {
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

inline void set_ray(RTCRay& to, const Ray& ray) {
  to = {ray.origin.x,    ray.origin.y,    ray.origin.z, ray.t_min, ray.direction.x,
        ray.direction.y, ray.direction.z, 0,            ray.t_max, ~0u,
        0,               0};
}

/// -1 for each lane with a ray; the others get a ray that is switched off.
inline void fill(RTCRay16& packet, int* valid, std::span<const Ray> rays) {
  for (std::size_t lane = 0; lane < kPacket; ++lane) {
    valid[lane] = lane < rays.size() ? -1 : 0;
    set_ray(packet, lane, rays[lane < rays.size() ? lane : 0]);
  }
}

inline void forget_hits(RTCHit16& hits) {
  for (std::size_t lane = 0; lane < kPacket; ++lane) {
    hits.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    hits.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
}

inline void read_hits(const RTCRayHit16& packet, std::span<Hit> hits) {
  for (std::size_t lane = 0; lane < hits.size(); ++lane) {
    Hit hit;
    if (packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID)
      hit = {packet.ray.tfar[lane],   packet.hit.u[lane],      packet.hit.v[lane],
             packet.hit.primID[lane], packet.hit.geomID[lane], kInvalidId};
    hits[lane] = hit;
  }
}

inline Hit read_hit(const RTCRayHit& from) {
  if (from.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {from.ray.tfar, from.hit.u, from.hit.v, from.hit.primID, from.hit.geomID, kInvalidId};
}

/// Embree marks an occluded ray by tfar = -inf.
inline std::uint8_t is_occluded(float tfar) {
  return tfar < 0 ? 1 : 0;
}

}  // namespace raysheaf::app
