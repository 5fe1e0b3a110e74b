// The name, the sentence and the number of rounds of each promise.
#pragma once

#include <cstdint>

#include "raysheaf/verify.h"

namespace raysheaf::checks {

struct PromiseWords {
  const char* name;
  const char* sentence;
  const char* unit;      ///< of `PromiseReport::cases`
  std::uint64_t rounds;  ///< by default
};

[[nodiscard]] const PromiseWords& words_of(Promise promise);

}  // namespace raysheaf::checks
