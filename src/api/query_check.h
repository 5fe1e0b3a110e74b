// Packing and validation of a query's rays and points, and translation of its errors.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "nearest/point.h"
#include "raysheaf/query.h"

namespace raysheaf {

/// The most rays or points of a query.
inline constexpr std::size_t kMostItems = 0x7fffffff;

/// Writes rays [begin, end) of `parts` to `out`. Numbers outside float's range become infinite.
void pack_rays(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out);

/// Whether all are valid.
[[nodiscard]] bool are_right(View<const Ray> rays);
[[nodiscard]] bool are_right(View<const QueryPoint> points);
/// Throws `Error` (kInvalidData) naming the first invalid one, if any, and its field; `first` is
/// the number of rays[0] or points[0].
void throw_fault(View<const Ray> rays, std::size_t first);
void throw_fault(View<const QueryPoint> points, std::size_t first);

/// Throws as `throw_fault` does.
void check_rays(const Executor& executor, View<const Ray> rays);

/// The error where memory runs out.
inline constexpr const char* kNoMemory = "there is not enough memory to answer them";

/// Reports exhausted memory during a query of `items` as `Error`.
template <class Body>
decltype(auto) answered(const Body& body, const char* items = "rays") {
  return within_memory(kNoMemory, items, body);
}

}  // namespace raysheaf
