// The source of a query's rays, which need not be stored as `Ray`.
#pragma once

#include "exec/source.h"
#include "raysheaf/types.h"

namespace raysheaf {

using RaySource = Source<Ray>;
using RaysInPlace = InPlace<Ray>;

}  // namespace raysheaf
