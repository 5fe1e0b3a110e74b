// Whatever is wrong with a file ends here.
#pragma once

#include <cstddef>
#include <string>

#include "raysheaf/error.h"

namespace raysheaf::io {

/// Throws `Error`. The place is added by a caller who knows it better, where it is left out.
[[noreturn]] inline void refuse(const std::string& sentence, const std::string& place = {},
                                ErrorCode code = ErrorCode::kInvalidData) {
  throw Error(code, sentence, place);
}

/// `nodes[3]`.
[[nodiscard]] inline std::string element(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

}  // namespace raysheaf::io
