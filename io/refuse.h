// Throws and completes the errors of loaders.
#pragma once

#include <cstddef>
#include <string>

#include "io/utf8.h"
#include "raysheaf/error.h"

namespace raysheaf::io {

/// Throws `Error`. If `place` is empty, a caller that knows the place adds it.
[[noreturn]] inline void refuse(const std::string& sentence, const std::string& place = {},
                                ErrorCode code = ErrorCode::kInvalidData) {
  throw Error(code, sentence, place);
}

/// Returns the result of `work`. Running out of memory becomes an `Error` whose place is the file's
/// name.
template <class Work>
auto within_memory(const std::string& path, const Work& work) {
  return raysheaf::within_memory("there is not enough memory for it", path, work);
}

/// Returns the result of `load`. Adds the file's name to the place of its errors. The message is
/// valid UTF-8, whatever the file and its name contain.
template <class Load>
auto naming(const std::string& path, const Load& load) {
  try {
    return raysheaf::within_memory("there is not enough memory for this scene", path, load);
  } catch (const Error& error) {
    const bool named = error.place() == path || error.place().starts_with(path + ": ");
    const std::string place = named                   ? error.place()
                              : error.place().empty() ? path
                                                      : path + ": " + error.place();
    throw Error(error.code(), whole_utf8(error.sentence()), whole_utf8(place));
  } catch (const std::exception& error) {
    throw Error(ErrorCode::kInvalidData, whole_utf8(std::string("cannot be read: ") + error.what()),
                whole_utf8(path));
  }
}

/// For example `nodes[3]`.
[[nodiscard]] inline std::string element(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

}  // namespace raysheaf::io
