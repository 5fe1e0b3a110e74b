// Converts rays to Embree's structures and hits back. Both conversions are timed, because they are
// part of the call that the library answers.
#include "lab/commands/compare/calls.h"

#include <algorithm>
#include <array>

namespace raysheaf::app {
namespace {

constexpr std::size_t kStreamWidth = 16;

using Rays = std::span<const Ray>;
using Hits = std::span<Hit>;
using Flags = std::span<std::uint8_t>;

template <std::size_t N>
void set_ray(embree::Rays<N>& to, std::size_t lane, const Ray& ray) {
  to.origin_x[lane] = ray.origin.x;
  to.origin_y[lane] = ray.origin.y;
  to.origin_z[lane] = ray.origin.z;
  to.t_near[lane] = ray.t_min;
  to.direction_x[lane] = ray.direction.x;
  to.direction_y[lane] = ray.direction.y;
  to.direction_z[lane] = ray.direction.z;
  to.time[lane] = 0;
  to.t_far[lane] = ray.t_max;
  to.mask[lane] = ~0u;
  to.id[lane] = 0;
  to.flags[lane] = 0;
}

/// -1 for each lane with a ray; the other lanes get a disabled ray.
template <std::size_t N>
void fill(embree::Rays<N>& packet, std::array<int, N>& valid, Rays rays) {
  for (std::size_t lane = 0; lane < N; ++lane) {
    valid[lane] = lane < rays.size() ? -1 : 0;
    set_ray(packet, lane, rays[lane < rays.size() ? lane : 0]);
  }
}

template <std::size_t N>
void forget_hits(embree::Hits<N>& hits) {
  hits.geom_id.fill(embree::kInvalid);
  hits.instance_id.fill(embree::kInvalid);
}

template <std::size_t N>
void read_hits(const embree::RayHits<N>& packet, Hits hits) {
  for (std::size_t lane = 0; lane < hits.size(); ++lane) {
    Hit hit;
    if (packet.hit.geom_id[lane] != embree::kInvalid)
      hit = {packet.ray.t_far[lane],   packet.hit.u[lane],       packet.hit.v[lane],
             packet.hit.prim_id[lane], packet.hit.geom_id[lane], packet.hit.instance_id[lane]};
    hits[lane] = hit;
  }
}

/// Embree marks an occluded ray by t_far = -inf.
std::uint8_t is_occluded(float t_far) {
  return t_far < 0 ? 1 : 0;
}

template <std::size_t N>
embree::Rays<N>& rays_of(embree::RayHits<N>& query) {
  return query.ray;
}

template <std::size_t N>
embree::Rays<N>& rays_of(embree::Rays<N>& query) {
  return query;
}

const embree::Queries<embree::RayHits>& queries_for(const embree::Api& api,
                                                    const embree::RayHits<1>*) {
  return api.intersect;
}

const embree::Queries<embree::Rays>& queries_for(const embree::Api& api, const embree::Rays<1>*) {
  return api.occluded;
}

/// One call of Embree.
template <std::size_t N, template <std::size_t> class Query>
void ask(EmbreeQuestion& q, const std::array<int, N>& valid, Query<N>& query) {
  static_assert(N == 1 || N == 8 || N == 16);
  const auto& queries = queries_for(q.api, static_cast<const Query<1>*>(nullptr));
  if (q.api.major_version == 3) {
    if constexpr (N == 1)
      queries.one_3(q.scene, &q.context, &query);
    else if constexpr (N == 8)
      queries.eight_3(valid.data(), q.scene, &q.context, &query);
    else
      queries.sixteen_3(valid.data(), q.scene, &q.context, &query);
  } else {
    if constexpr (N == 1)
      queries.one_4(q.scene, &query, &q.arguments);
    else if constexpr (N == 8)
      queries.eight_4(valid.data(), q.scene, &query, &q.arguments);
    else
      queries.sixteen_4(valid.data(), q.scene, &query, &q.arguments);
  }
}

template <std::size_t N>
void closest_packets(EmbreeQuestion& question, Rays rays, Hits hits) {
  for (std::size_t i = 0; i < rays.size(); i += N) {
    const std::size_t count = std::min(N, rays.size() - i);
    alignas(64) std::array<int, N> valid;
    embree::RayHits<N> query;
    fill(query.ray, valid, rays.subspan(i, count));
    forget_hits(query.hit);
    ask<N, embree::RayHits>(question, valid, query);
    read_hits(query, hits.subspan(i, count));
  }
}

template <std::size_t N>
void any_packets(EmbreeQuestion& question, Rays rays, Flags occluded) {
  for (std::size_t i = 0; i < rays.size(); i += N) {
    const std::size_t count = std::min(N, rays.size() - i);
    alignas(64) std::array<int, N> valid;
    embree::Rays<N> query;
    fill(query, valid, rays.subspan(i, count));
    ask<N, embree::Rays>(question, valid, query);
    for (std::size_t k = 0; k < count; ++k) occluded[i + k] = is_occluded(query.t_far[k]);
  }
}

/// A stream cannot disable lanes: its last packet is filled up with rays that end before they
/// begin.
template <std::size_t N>
void switch_off(embree::Rays<N>& packet, std::size_t from) {
  for (std::size_t lane = from; lane < N; ++lane) {
    packet.t_near[lane] = 1;
    packet.t_far[lane] = 0;
  }
}

template <class Query>
using Stream = std::array<Query, kRaysATask / kStreamWidth>;

template <class Query>
unsigned fill_stream(Stream<Query>& queries, Rays rays) {
  unsigned packets = 0;
  for (std::size_t i = 0; i < rays.size(); i += kStreamWidth, ++packets) {
    const std::size_t count = std::min(kStreamWidth, rays.size() - i);
    std::array<int, kStreamWidth> not_used;
    fill(rays_of(queries[packets]), not_used, rays.subspan(i, count));
    switch_off(rays_of(queries[packets]), count);
  }
  return packets;
}

void closest_stream(EmbreeQuestion& question, Rays rays, Hits hits) {
  Stream<embree::RayHits<kStreamWidth>> queries;
  const unsigned packets = fill_stream(queries, rays);
  for (unsigned p = 0; p < packets; ++p) forget_hits(queries[p].hit);
  question.api.intersect.stream_3(question.scene, &question.context, queries.data(), kStreamWidth,
                                  packets, sizeof(queries[0]));
  for (std::size_t i = 0; i < rays.size(); i += kStreamWidth)
    read_hits(queries[i / kStreamWidth], hits.subspan(i, std::min(kStreamWidth, rays.size() - i)));
}

void any_stream(EmbreeQuestion& question, Rays rays, Flags occluded) {
  Stream<embree::Rays<kStreamWidth>> queries;
  const unsigned packets = fill_stream(queries, rays);
  question.api.occluded.stream_3(question.scene, &question.context, queries.data(), kStreamWidth,
                                 packets, sizeof(queries[0]));
  for (std::size_t i = 0; i < rays.size(); ++i)
    occluded[i] = is_occluded(queries[i / kStreamWidth].t_far[i % kStreamWidth]);
}

constexpr EmbreeCall kCalls[] = {
    {"intersect1", "occluded1", false, false, closest_packets<1>, any_packets<1>},
    {"intersect8", "occluded8", false, false, closest_packets<8>, any_packets<8>},
    {"intersect8 coherent", "occluded8 coherent", true, false, closest_packets<8>, any_packets<8>},
    {"intersect16", "occluded16", false, false, closest_packets<16>, any_packets<16>},
    {"intersect16 coherent", "occluded16 coherent", true, false, closest_packets<16>,
     any_packets<16>},
    {"intersectNM", "occludedNM", false, true, closest_stream, any_stream},
    {"intersectNM coherent", "occludedNM coherent", true, true, closest_stream, any_stream},
};

}  // namespace

std::span<const EmbreeCall> embree_calls() {
  return kCalls;
}

}  // namespace raysheaf::app
