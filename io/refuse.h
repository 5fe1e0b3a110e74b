// Whatever is wrong with a file ends here.
#pragma once

#include <cstddef>
#include <new>
#include <string>

#include "raysheaf/error.h"

namespace raysheaf::io {

/// Throws `Error`. The place is added by a caller who knows it better, where it is left out.
[[noreturn]] inline void refuse(const std::string& sentence, const std::string& place = {},
                                ErrorCode code = ErrorCode::kInvalidData) {
  throw Error(code, sentence, place);
}

/// What `work` gives. A lack of memory becomes an `Error` whose place is the file's name.
template <class Work>
auto within_memory(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kOutOfMemory, "there is not enough memory for it", path);
  }
}

/// `nodes[3]`.
[[nodiscard]] inline std::string element(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

}  // namespace raysheaf::io
