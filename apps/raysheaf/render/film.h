// Pictures into a film, by ffmpeg.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// Where ffmpeg is. Throws `Error` (kUnsupported, place `output`) where it is not installed.
[[nodiscard]] std::string find_ffmpeg(const std::string& output);

/// A film under construction, written beside its name and renamed at the end: whoever destroys it
/// before leaves nothing behind.
class Film {
 public:
  /// `width` and `height` are those of the pictures.
  Film(const std::string& ffmpeg, std::string path, std::uint32_t width, std::uint32_t height,
       double fps);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// The next picture. Throws `Error` (kIo) where ffmpeg has gone.
  void add(const Image& picture);
  /// The film is whole. Throws `Error` (kIo) where ffmpeg failed.
  void finish();

 private:
  [[noreturn]] void fail(const std::string& sentence);
  int wait();

  std::string path_, unfinished_;
  int pipe_ = -1;
  int process_ = -1;
};

}  // namespace raysheaf::app
