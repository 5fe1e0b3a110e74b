#include "api/query_points.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "api/query_call.h"
#include "raysheaf/error.h"

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

bool is_near_enough(double x) {
  return std::fabs(x) <= kFarthestPoint;
}
bool is_right_point(const QueryPoint& p) {
  return is_near_enough(p.at.x) && is_near_enough(p.at.y) && is_near_enough(p.at.z) &&
         p.radius >= 0;
}

}  // namespace

QueryPoints::QueryPoints(const PointParts& parts, bool check)
    : PointSource(parts.count), parts_(parts), check_(check) {
  if (parts.points.data == nullptr && parts.count != 0)
    throw Error(ErrorCode::kInvalidArgument,
                "there are no coordinates for " + std::to_string(parts.count) + " points",
                "points");
  if (parts.count > kMostRays)
    throw Error(ErrorCode::kUnsupported,
                std::to_string(parts.count) + " points are more than 2^31 - 1", "points");
}

void QueryPoints::pack(std::size_t begin, std::size_t end, QueryPoint* out) const {
  const auto coordinate = [](double x) { return std::fabs(x) < kLeastCoordinate ? 0 : x; };
  const std::ptrdiff_t apart = parts_.points.column_stride;
  for_each_row(parts_.points, begin, end, [&](std::size_t i, const auto* from) {
    out[i].at = {coordinate(from[0]), coordinate(from[apart]), coordinate(from[2 * apart])};
    out[i].radius = std::numeric_limits<double>::infinity();
  });
  if (parts_.radii.data != nullptr)
    for_each_row(parts_.radii, begin, end,
                 [&](std::size_t i, const auto* from) { out[i].radius = double{*from}; });
}

void QueryPoints::take(std::size_t begin, std::size_t end, QueryPoint* out) const {
  pack(begin, end, out);
  if (check_ && !std::all_of(out, out + (end - begin), is_right_point)) throw WrongPoint();
}

void QueryPoints::throw_first_fault() const {
  QueryPoint room[64];
  for (std::size_t begin = 0; begin < size(); begin += std::size(room)) {
    const std::size_t end = std::min(size(), begin + std::size(room));
    pack(begin, end, room);
    for (std::size_t i = 0; i < end - begin; ++i) {
      const Point p = room[i].at;
      const std::string place = "[" + std::to_string(begin + i) + "]";
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw Error(ErrorCode::kInvalidData, "the point is not finite", "points" + place);
      if (!is_near_enough(p.x) || !is_near_enough(p.y) || !is_near_enough(p.z))
        throw Error(ErrorCode::kInvalidData, "the point is farther out than 1e18",
                    "points" + place);
      if (std::isnan(room[i].radius))
        throw Error(ErrorCode::kInvalidData, "the radius is not a number", "radii" + place);
      if (room[i].radius < 0)
        throw Error(ErrorCode::kInvalidData, "the radius is negative", "radii" + place);
    }
  }
  throw Error(ErrorCode::kInvalidData, "the points changed while they were read", "points");
}

}  // namespace raysheaf
