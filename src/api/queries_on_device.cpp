// A device's answers. Rays, points and answers may each be in its memory.
#include <algorithm>

#include "api/name_rows.h"
#include "api/query_call.h"
#include "api/scene_queries.h"
#include "nearest/point_rows_body.h"

namespace raysheaf {
namespace {

/// The most points that a device answers at once, and the most triangles that it finds for them.
constexpr std::size_t kMostDevicePoints = std::size_t{1} << 20;
constexpr std::size_t kMostDeviceFound = std::size_t{1} << 21;

/// Calls `ask(device, rays, query)` with all rays, for the instances where they stand or for placed
/// triangles.
template <class Ask>
void with_rays(QueryCall& call, const QueryRays& rays, const Ask& ask) {
  Buffer<Ray> room;
  // Rays in a device's memory are validated there.
  const View<const Ray> all =
      call.is_on_device(rays.data(), rays.name()) ? rays.rays() : call.take_all(rays, &room);
  DeviceQuery query = call.device_query();
  DeviceQueries* device = query.brute ? nullptr : call.enter_on_device();
  query.enters = device != nullptr;
  query.filter.choice = choice_of_hits(call.options());
  if (device == nullptr) {
    call.open();
    device = &call.device_queries();
    if (call.filter() != nullptr) query.filter = *call.filter();
  }
  ask(*device, all, query);
}

/// The points in the device's memory; without rows if they are in the host's.
DevicePoints points_there(QueryCall& call, const QueryPoints& points) {
  const PointParts& parts = points.parts();
  DevicePoints there;
  if (!call.is_on_device(parts.points.data, "points")) return there;
  there.rows = parts.points;
  there.check = points.is_checked();
  if (call.is_on_device(parts.radii.data, "radii"))
    there.radii = parts.radii;
  else if (parts.radii.data != nullptr)
    there.radius = number_at(parts.radii, 0, 0);
  return there;
}

/// Calls `ask(device, points, query)` for parts of the points, of which each finds `k` triangles.
/// `rule`: the query asks what is inside.
template <class Ask>
void for_each_part(QueryCall& call, const QueryPoints& points, std::size_t k,
                   const InsideRule* rule, const Ask& ask) {
  const std::size_t most =
      std::max<std::size_t>(1, std::min(kMostDevicePoints, kMostDeviceFound / k));
  call.open();
  DeviceQueries& device = call.device_queries();
  DeviceQuery query = call.device_query();
  if (rule != nullptr) query.rule = *rule;
  query.closed = rule != nullptr && !query.brute && call.is_closed(*rule);
  const DevicePoints all = points_there(call, points);
  DevicePoints part = all;
  Buffer<QueryPoint> packed;
  for (; part.first < points.size(); part.first += most) {
    call.executor().check();
    part.count = std::min(most, points.size() - part.first);
    if (all.rows.data != nullptr) {
      part.rows = rows_from(all.rows, part.first);
      if (all.radii.data != nullptr) part.radii = rows_from(all.radii, part.first);
    } else {
      packed.resize_uninitialized(part.count);
      call.executor().for_each_block(
          part.count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
            static_cast<void>(
                points.take(part.first + begin, part.first + end, packed.data() + begin));
          });
      part.packed = {packed.data(), packed.size()};
    }
    ask(device, part, query);
    query.explain = false;
  }
}

class QueriesOnDevice final : public SceneQueries {
 public:
  void closest_hit(QueryCall& call, const QueryRays& rays, std::span<Hit> hits) const override {
    with_rays(call, rays,
              [&](DeviceQueries& device, View<const Ray> all, const DeviceQuery& query) {
                device.closest_hit(all, query, View<Hit>(hits));
              });
  }
  void any_hit(QueryCall& call, const QueryRays& rays,
               std::span<std::uint8_t> occluded) const override {
    with_rays(call, rays,
              [&](DeviceQueries& device, View<const Ray> all, const DeviceQuery& query) {
                device.any_hit(all, query, occluded);
              });
  }
  void hit_counts(QueryCall& call, const QueryRays& rays,
                  std::span<std::uint32_t> counts) const override {
    with_rays(call, rays,
              [&](DeviceQueries& device, View<const Ray> all, const DeviceQuery& query) {
                device.count_hits(all, query, counts);
              });
  }
  void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                HitRows* rows) const override {
    with_rays(
        call, rays, [&](DeviceQueries& device, View<const Ray> all, const DeviceQuery& query) {
          if (query.enters)
            return name_rows(
                call.executor(), device.all_entered_hits(all, query), most,
                [](View<const Hit> hits, Hit* out) { std::copy(hits.begin(), hits.end(), out); },
                rows);
          name_rows(
              call.executor(), device.all_hits(all, query), most,
              [&](View<const IndexedHit> hits, Hit* out) { call.view().name_hits(hits, out); },
              rows);
        });
  }

  void nearest(QueryCall& call, const QueryPoints& points,
               std::span<ClosestPoint> found) const override {
    const std::size_t k = found.size() / points.size();
    for_each_part(call, points, k, nullptr,
                  [&](DeviceQueries& device, const DevicePoints& part, const DeviceQuery& query) {
                    device.nearest(part, static_cast<std::uint32_t>(k), query,
                                   found.subspan(part.first * k, part.count * k));
                  });
  }
  void signed_distance(QueryCall& call, const QueryPoints& points, InsideRule rule,
                       std::span<double> distances) const override {
    for_each_part(call, points, 1, &rule,
                  [&](DeviceQueries& device, const DevicePoints& part, const DeviceQuery& query) {
                    device.signed_distance(part, query, distances.subspan(part.first, part.count));
                  });
  }
  void contains(QueryCall& call, const QueryPoints& points, InsideRule rule,
                std::span<std::uint8_t> inside) const override {
    for_each_part(call, points, 1, &rule,
                  [&](DeviceQueries& device, const DevicePoints& part, const DeviceQuery& query) {
                    device.contains(part, query, inside.subspan(part.first, part.count));
                  });
  }
};

}  // namespace

const SceneQueries& on_device() {
  static const QueriesOnDevice queries;
  return queries;
}

}  // namespace raysheaf
