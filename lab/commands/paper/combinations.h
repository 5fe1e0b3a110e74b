// The combinations of the published program's switches that are tried.
#pragma once

#include <string>
#include <vector>

#include "raysheaf/lab.h"

namespace raysheaf::app {

/// The defaults first. Then cone tests with rows from below and above (`rah`) or with each key
/// (`crsh`), and every other switch by itself.
[[nodiscard]] std::vector<Quirks> combinations_of(Method method);

/// The defaults without the first 0, 1, 2, 4 ... 32 rays.
[[nodiscard]] std::vector<Quirks> phases();

/// The cone test, and the differences from the defaults: "signed", "exact, undersized triangles".
[[nodiscard]] std::string name_of(const Quirks& quirks);

}  // namespace raysheaf::app
