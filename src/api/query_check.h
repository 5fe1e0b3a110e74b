// Validation of a query's rays, and translation of its errors.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/error.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Whether all rays are valid.
[[nodiscard]] bool are_right(View<const Ray> rays);
/// Throws `Error` (kInvalidData) naming the first invalid one of `rays`, if any, and its field;
/// `first` is the number of rays[0].
void throw_fault(View<const Ray> rays, std::size_t first);

/// Throws as `throw_fault` does.
void check_rays(const Executor& executor, View<const Ray> rays);

/// Reports exhausted memory during a query as `Error`.
template <class Body>
decltype(auto) answered(const Body& body) {
  return within_memory("there is not enough memory to answer them", "rays", body);
}

}  // namespace raysheaf
