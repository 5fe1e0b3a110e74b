#include "api/query_points.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "api/query_call.h"
#include "nearest/point_rows_body.h"
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
  const std::ptrdiff_t apart = parts_.points.column_stride;
  for_each_row(parts_.points, begin, end, [&](std::size_t i, const auto* from) {
    out[i].at = {point_coordinate(from[0]), point_coordinate(from[apart]),
                 point_coordinate(from[2 * apart])};
    out[i].radius = std::numeric_limits<double>::infinity();
  });
  if (parts_.radii.data != nullptr)
    for_each_row(parts_.radii, begin, end,
                 [&](std::size_t i, const auto* from) { out[i].radius = double{*from}; });
}

void QueryPoints::take(std::size_t begin, std::size_t end, QueryPoint* out) const {
  pack(begin, end, out);
  if (check_ && !std::all_of(out, out + (end - begin),
                             [](const QueryPoint& point) { return is_right(point); }))
    throw WrongPoint();
}

void QueryPoints::throw_first_fault() const {
  QueryPoint room[64];
  for (std::size_t begin = 0; begin < size(); begin += std::size(room)) {
    const std::size_t end = std::min(size(), begin + std::size(room));
    pack(begin, end, room);
    for (std::size_t i = 0; i < end - begin; ++i) {
      const PointFault fault = fault_of(room[i]);
      if (fault.field == nullptr) continue;
      throw Error(ErrorCode::kInvalidData, fault.sentence,
                  fault.field + ("[" + std::to_string(begin + i) + "]"));
    }
  }
  throw Error(ErrorCode::kInvalidData, "the points changed while they were read", "points");
}

}  // namespace raysheaf
