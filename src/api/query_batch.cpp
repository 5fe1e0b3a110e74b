#include "api/query_batch.h"

#include <algorithm>
#include <limits>

#include "nearest/point_rows_body.h"

namespace raysheaf {
namespace {

/// Calls `take(i, row)` for rows [begin, end), counted from `begin`.
template <class Number, class Take>
void for_each_row(const NumberRows& rows, std::size_t begin, std::size_t end, const Take& take) {
  const auto* from =
      static_cast<const Number*>(rows.data) + static_cast<std::ptrdiff_t>(begin) * rows.row_stride;
  for (std::size_t i = begin; i < end; ++i, from += rows.row_stride) take(i - begin, from);
}
template <class Take>
void for_each_row(const NumberRows& rows, std::size_t begin, std::size_t end, const Take& take) {
  if (rows.is_double)
    for_each_row<double>(rows, begin, end, take);
  else
    for_each_row<float>(rows, begin, end, take);
}

}  // namespace

QueryRays::QueryRays(const RayParts& parts, bool check)
    : QueryBatch(parts.count, "rays", check), parts_(parts) {
  const auto require = [&](const NumberRows& rows, const char* place) {
    if (rows.data == nullptr && parts.count != 0)
      throw Error(ErrorCode::kInvalidArgument,
                  "there is no array for " + std::to_string(parts.count) + " rays", place);
  };
  require(parts.origins, "rays.origins");
  require(parts.directions, "rays.directions");
}

View<const Ray> QueryRays::peek(std::size_t begin, std::size_t end, Ray* room) const {
  if (rays_.data != nullptr) return rays_.slice(begin, end - begin);
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
  const std::ptrdiff_t apart = parts_.points.column_stride;
  for_each_row(parts_.points, begin, end, [&](std::size_t i, const auto* from) {
    room[i].at = {point_coordinate(from[0]), point_coordinate(from[apart]),
                  point_coordinate(from[2 * apart])};
    room[i].radius = std::numeric_limits<double>::infinity();
  });
  if (parts_.radii.data != nullptr)
    for_each_row(parts_.radii, begin, end,
                 [&](std::size_t i, const auto* from) { room[i].radius = double{*from}; });
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
