// The largest image sizes that are ready in time: of traced images, and of the preview by OpenGL.
#pragma once

#include <cstdint>
#include <utility>

namespace raysheaf::viewer {

struct Size {
  std::uint32_t width = 0, height = 0;

  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  bool operator==(const Size&) const = default;
};

/// Learns the cost of an image, as a fixed part and a part for each pixel, and returns the scale of
/// the window that meets a goal. The scale grows in steps of a quarter, so that images do not
/// change their size with every hiccup, and shrinks at once.
class Resolution {
 public:
  /// Records that an image of this number of pixels took this time, or longer if it was given up.
  void took(std::uint64_t pixels, double ms);
  /// Forgets the costs, which do not apply to other settings or another scene.
  void forget() { *this = Resolution(); }
  /// The size for a window: never larger than the window, and at least a quarter of each side and
  /// 32 pixels.
  [[nodiscard]] Size size_for(Size window, double goal_ms);
  /// The predicted time of an image with this number of pixels; 0 while no cost is known.
  [[nodiscard]] double expected_ms(std::uint64_t pixels) const;

 private:
  double fixed_ms_ = 0, pixel_ms_ = 0;
  double last_pixels_ = 0, last_ms_ = 0;
  double scale_ = 0.25;
  bool known_ = false;
};

/// The part of the window's width and height at which OpenGL draws the preview: 1, or less if a
/// frame takes too long, at least a quarter.
class PreviewResolution {
 public:
  /// Records the time of a frame that was drawn at `part()`.
  void took(double ms);
  [[nodiscard]] float part() const;
  /// Even the smallest preview takes too long.
  [[nodiscard]] bool too_slow() const { return slow_frames_ > kMostSlowFrames; }

 private:
  static constexpr int kMostSlowFrames = 12;
  std::size_t step_ = 0;
  double mean_ms_ = 0;
  int frames_ = 0, slow_frames_ = 0;  ///< since the last change of the step
};

}  // namespace raysheaf::viewer
