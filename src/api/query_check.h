// Rays looked over at the door.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Whether none is wrong.
[[nodiscard]] bool are_right(View<const Ray> rays);
/// Throws `Error` (kInvalidData) that names the first wrong one of `rays`, if there is one, and its
/// field; `first` is the number of rays[0].
void throw_fault(View<const Ray> rays, std::size_t first);

/// Throws as `throw_fault` does.
void check_rays(const Executor& executor, View<const Ray> rays);

}  // namespace raysheaf
