// The result of `raysheaf verify`, as text and as JSON.
#pragma once

#include <string>

#include "raysheaf/verify.h"

namespace raysheaf::app {

/// A table of promises, one of errors if there are any, and a sentence for each named failure, with
/// the command that reproduces it.
[[nodiscard]] std::string verify_text(const VerifyReport& report);
[[nodiscard]] std::string verify_json(const VerifyReport& report);

}  // namespace raysheaf::app
