// What `raysheaf verify` found, for people and for programs.
#pragma once

#include <string>

#include "raysheaf/verify.h"

namespace raysheaf::app {

/// A table of promises, one of errors where there are any, and a sentence for each failure that is
/// named, with the command that shows it again.
[[nodiscard]] std::string verify_text(const VerifyReport& report);
[[nodiscard]] std::string verify_json(const VerifyReport& report);

}  // namespace raysheaf::app
