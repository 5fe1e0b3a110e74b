// The only exception class that raysheaf throws.
#pragma once

#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raysheaf {

enum class ErrorCode {
  kInvalidArgument,  ///< an invalid option or value from the caller
  kInvalidData,      ///< a file or a scene with invalid content
  kUnsupported,      ///< valid, but not supported by this build or this machine
  kNotFound,         ///< no such file, camera or scene
  kIo,               ///< reading or writing failed
  kOutOfMemory,      ///< an allocation failed, or would exceed a stated limit
  kNoGraphics,       ///< no OpenGL context is available
  kWrongState,       ///< not allowed now: before commit(), or while a query runs
  kCancelled,        ///< the caller requested to stop
  kInternal,         ///< a defect of raysheaf
};

/// A code, one sentence, and the place: a file, a field (`meshes[3].triangles[17]`), an option.
/// `what()` is "place: sentence", or only the sentence if the place is empty.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, std::string sentence, std::string place = {})
      : std::runtime_error(place.empty() ? sentence : place + ": " + sentence),
        code_(code),
        sentence_(std::move(sentence)),
        place_(std::move(place)) {}

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  [[nodiscard]] const std::string& sentence() const noexcept { return sentence_; }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }

 private:
  ErrorCode code_;
  std::string sentence_;
  std::string place_;
};

/// Returns the result of `work`. Turns std::bad_alloc and std::length_error, which a vector throws
/// if it would exceed its maximum size, into an `Error` (kOutOfMemory) of this sentence and place.
template <class Work>
decltype(auto) within_memory(std::string_view sentence, std::string_view place, const Work& work) {
  const auto error = [&] {
    return Error(ErrorCode::kOutOfMemory, std::string(sentence), std::string(place));
  };
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw error();
  } catch (const std::length_error&) {
    throw error();
  }
}

}  // namespace raysheaf
