// The one exception that leaves raysheaf.
#pragma once

#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raysheaf {

enum class ErrorCode {
  kInvalidArgument,  ///< an option or a value handed in by the caller
  kInvalidData,      ///< a file or a scene whose content is wrong
  kUnsupported,      ///< right, but not something that this build can do
  kNotFound,         ///< no such file, camera, scene
  kIo,               ///< reading or writing failed
  kOutOfMemory,      ///< an allocation failed, or would exceed a stated limit
  kNoGraphics,       ///< no OpenGL context can be had
  kWrongState,       ///< right at another time: before commit(), or while a query runs
  kCancelled,        ///< the caller asked to stop
  kInternal,         ///< a defect of raysheaf
};

/// A code, one sentence, and the place: a file, a field (`meshes[3].triangles[17]`), an option.
/// `what()` is "place: sentence", or the sentence alone where there is no place.
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

/// What `work` gives. Throws an `Error` (kOutOfMemory) of this sentence and place where memory runs
/// out, or a vector would get more elements than any can have: std::bad_alloc, std::length_error.
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
