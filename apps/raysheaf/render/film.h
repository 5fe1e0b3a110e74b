// A film of images: MP4 by ffmpeg, or animated WebP.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// Whether the name stands for one film of all frames: .mp4 or .webp.
[[nodiscard]] bool is_film_name(const std::string& path);

/// A film under construction. The file appears when it is complete; if the film is destroyed
/// earlier, it leaves no file behind.
class Film {
 public:
  Film() = default;
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  virtual ~Film() = default;

  /// Adds an image. Throws `Error`, as when ffmpeg has ended.
  virtual void add(const Image& picture) = 0;
  /// Completes the film. Throws `Error`, as when ffmpeg failed.
  virtual void finish() = 0;
};

/// A film at `path`, in the format of `name`; `width` and `height` are those of the images. Throws
/// `Error` (kUnsupported, place `name`) if ffmpeg is needed and not installed, or the format does
/// not allow it.
[[nodiscard]] std::unique_ptr<Film> make_film(const std::string& name, std::string path,
                                              std::uint32_t width, std::uint32_t height,
                                              double fps);

}  // namespace raysheaf::app
