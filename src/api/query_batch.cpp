#include "api/query_batch.h"

#include <algorithm>
#include <limits>

#include "nearest/point_rows_body.h"

namespace raysheaf {

QueryRays::QueryRays(const RayParts& parts, bool check)
    : QueryBatch(parts.count, "rays", check), parts_(parts) {
  const auto require = [&](const NumberRows& rows, const char* place) {
    if (rows.data == nullptr && parts.list == nullptr && parts.count != 0)
      throw Error(ErrorCode::kInvalidArgument,
                  "there is no array for " + std::to_string(parts.count) + " rays", place);
  };
  require(parts.origins, "rays.origins");
  require(parts.directions, "rays.directions");
}

View<const Ray> QueryRays::peek(std::size_t begin, std::size_t end, Ray* room) const {
  if (parts_.list != nullptr) return {parts_.list + begin, end - begin};
  pack_rays(parts_, begin, end, room);
  return {room, end - begin};
}

QueryPoints::QueryPoints(const PointParts& parts, bool check)
    : QueryBatch(parts.count, "points", check), parts_(parts) {
  if (parts.points.data == nullptr && parts.count != 0)
    throw Error(ErrorCode::kInvalidArgument,
                "there are no coordinates for " + std::to_string(parts.count) + " points",
                "points");
}

View<const QueryPoint> QueryPoints::peek(std::size_t begin, std::size_t end,
                                         QueryPoint* room) const {
  for (std::size_t i = begin; i < end; ++i)
    room[i - begin] =
        packed_point(parts_.points, parts_.radii, std::numeric_limits<double>::infinity(), i);
  return {room, end - begin};
}

bool are_right(View<const QueryPoint> points) {
  return std::all_of(points.begin(), points.end(),
                     [](const QueryPoint& point) { return is_right(point); });
}

void throw_fault(View<const QueryPoint> points, std::size_t first) {
  for (std::size_t i = 0; i < points.size; ++i) {
    const PointFault fault = fault_of(points[i]);
    if (fault.field != nullptr)
      throw Error(ErrorCode::kInvalidData, fault.sentence,
                  fault.field + ("[" + std::to_string(first + i) + "]"));
  }
}

}  // namespace raysheaf
