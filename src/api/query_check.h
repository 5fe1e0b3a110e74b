// What may be wrong with the rays of a query, or with answering them.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/error.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Whether none is wrong.
[[nodiscard]] bool are_right(View<const Ray> rays);
/// Throws `Error` (kInvalidData) that names the first wrong one of `rays`, if there is one, and its
/// field; `first` is the number of rays[0].
void throw_fault(View<const Ray> rays, std::size_t first);

/// Throws as `throw_fault` does.
void check_rays(const Executor& executor, View<const Ray> rays);

/// Memory that runs out while rays are answered is the caller's to handle, as all else is.
template <class Body>
decltype(auto) answered(const Body& body) {
  return within_memory("there is not enough memory to answer them", "rays", body);
}

}  // namespace raysheaf
