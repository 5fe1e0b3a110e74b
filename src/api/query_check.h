// Rays looked over at the door.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Throws `Error` (kInvalidData) that names the first wrong ray and its field.
void check_rays(const Executor& executor, View<const Ray> rays);

}  // namespace raysheaf
