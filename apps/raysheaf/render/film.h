// Makes a film from images, by ffmpeg.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// The path of ffmpeg. Throws `Error` (kUnsupported, place `output`) if it is not installed.
[[nodiscard]] std::string find_ffmpeg(const std::string& output);

/// A film under construction. It is written next to its name and renamed at the end; if it is
/// destroyed earlier, it leaves no file behind.
class Film {
 public:
  /// `width` and `height` are those of the images.
  Film(const std::string& ffmpeg, std::string path, std::uint32_t width, std::uint32_t height,
       double fps);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Adds an image. Throws `Error` (kIo) if ffmpeg has ended.
  void add(const Image& picture);
  /// Completes the film. Throws `Error` (kIo) if ffmpeg failed.
  void finish();

 private:
  [[noreturn]] void fail(const std::string& sentence);
  int wait();

  std::string path_, unfinished_;
  int pipe_ = -1;
  int process_ = -1;
};

}  // namespace raysheaf::app
