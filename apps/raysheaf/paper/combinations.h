// Which settings of the published program's switches are tried.
#pragma once

#include <string>
#include <vector>

#include "raysheaf/lab.h"

namespace raysheaf::app {

/// The defaults first. Cone tests with rows from below and above (`rah`) or with each key (`crsh`);
/// every other switch by itself.
[[nodiscard]] std::vector<Quirks> combinations_of(Method method);

/// The defaults with the first rays left out: 0, 1, 2, 4 ... 32.
[[nodiscard]] std::vector<Quirks> phases();

/// The cone test, and what differs from the defaults: "signed", "exact, undersized triangles".
[[nodiscard]] std::string name_of(const Quirks& quirks);

}  // namespace raysheaf::app
