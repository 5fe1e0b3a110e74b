// What ends long work that its caller gave up.
#pragma once

#include "raysheaf/error.h"

namespace raysheaf {

[[nodiscard]] inline Error cancelled() {
  return {ErrorCode::kCancelled, "the caller asked to stop"};
}

}  // namespace raysheaf
