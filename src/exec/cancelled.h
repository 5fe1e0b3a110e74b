// The exception that ends long work that its caller cancelled.
#pragma once

#include "raysheaf/error.h"

namespace raysheaf {

[[nodiscard]] inline Error cancelled() {
  return {ErrorCode::kCancelled, "the caller asked to stop"};
}

}  // namespace raysheaf
