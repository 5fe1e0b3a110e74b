// The interface of the three ways in which the queries of a scene's view are answered. All give the
// same answers, bit for bit.
//
//   QueryCall ─┬─► by_plan         queries/planned_queries.h, nearest/nearest.h
//              ├─► by_brute_force  every ray and every point with every triangle
//              └─► on_device       device/device_queries.h
#pragma once

#include <span>

#include "api/query_batch.h"
#include "raysheaf/query.h"

namespace raysheaf {

class QueryCall;

/// Stateless: what is kept for later queries belongs to the view. `call` is not empty, and the
/// spans have an element for each ray or point, unless stated. Answers are those of
/// raysheaf/query.h and raysheaf/points.h.
class SceneQueries {
 public:
  virtual ~SceneQueries() = default;

  virtual void closest_hit(QueryCall& call, const QueryRays& rays, std::span<Hit> hits) const = 0;
  virtual void any_hit(QueryCall& call, const QueryRays& rays,
                       std::span<std::uint8_t> occluded) const = 0;
  virtual void hit_counts(QueryCall& call, const QueryRays& rays,
                          std::span<std::uint32_t> counts) const = 0;
  /// The first `most` hits of each ray; `rows->offsets` has its length, and is zero.
  virtual void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                        HitRows* rows) const = 0;

  /// As many for each point as `found` has room for.
  virtual void nearest(QueryCall& call, const QueryPoints& points,
                       std::span<ClosestPoint> found) const = 0;
  virtual void signed_distance(QueryCall& call, const QueryPoints& points, InsideRule rule,
                               std::span<double> distances) const = 0;
  virtual void contains(QueryCall& call, const QueryPoints& points, InsideRule rule,
                        std::span<std::uint8_t> inside) const = 0;
};

[[nodiscard]] const SceneQueries& by_plan();
[[nodiscard]] const SceneQueries& by_brute_force();
/// Only for calls of a context with a device. Rays, points and answers may be in its memory.
[[nodiscard]] const SceneQueries& on_device();

}  // namespace raysheaf
