// Points of a query from rows of numbers (raysheaf/types.h), and what makes one invalid.
#pragma once

#include <cmath>
#include <cstddef>

#include "base/host_device.h"
#include "nearest/point.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A coordinate as queries use it.
RAYSHEAF_HD inline double point_coordinate(double x) {
  return std::fabs(x) < kLeastCoordinate ? 0 : x;
}

RAYSHEAF_HD inline double number_at(const NumberRows& rows, std::size_t row, int column) {
  const std::ptrdiff_t place =
      static_cast<std::ptrdiff_t>(row) * rows.row_stride + column * rows.column_stride;
  return rows.is_double ? static_cast<const double*>(rows.data)[place]
                        : double{static_cast<const float*>(rows.data)[place]};
}

/// Point `i` of rows; without radii all have `radius`.
RAYSHEAF_HD inline QueryPoint packed_point(const NumberRows& rows, const NumberRows& radii,
                                           double radius, std::size_t i) {
  QueryPoint point;
  point.at = {point_coordinate(number_at(rows, i, 0)), point_coordinate(number_at(rows, i, 1)),
              point_coordinate(number_at(rows, i, 2))};
  point.radius = radii.data != nullptr ? number_at(radii, i, 0) : radius;
  return point;
}

/// The rows from number `first` on.
inline NumberRows rows_from(NumberRows rows, std::size_t first) {
  const std::ptrdiff_t skipped = static_cast<std::ptrdiff_t>(first) * rows.row_stride;
  rows.data = rows.is_double
                  ? static_cast<const void*>(static_cast<const double*>(rows.data) + skipped)
                  : static_cast<const void*>(static_cast<const float*>(rows.data) + skipped);
  return rows;
}

RAYSHEAF_HD inline bool is_near_enough(double x) {
  return std::fabs(x) <= kFarthestPoint;
}
RAYSHEAF_HD inline bool is_right(const QueryPoint& p) {
  return is_near_enough(p.at.x) && is_near_enough(p.at.y) && is_near_enough(p.at.z) &&
         p.radius >= 0;
}

struct PointFault {
  const char* field = nullptr;  ///< null: the point is valid
  const char* sentence = nullptr;
};

inline PointFault fault_of(const QueryPoint& p) {
  if (!std::isfinite(p.at.x) || !std::isfinite(p.at.y) || !std::isfinite(p.at.z))
    return {"points", "the point is not finite"};
  if (!is_near_enough(p.at.x) || !is_near_enough(p.at.y) || !is_near_enough(p.at.z))
    return {"points", "the point is farther out than 1e18"};
  if (std::isnan(p.radius)) return {"radii", "the radius is not a number"};
  if (p.radius < 0) return {"radii", "the radius is negative"};
  return {};
}

}  // namespace raysheaf
