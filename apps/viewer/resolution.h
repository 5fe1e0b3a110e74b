// The largest image size that is ready in time.
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
  /// The size for a window: never larger than the window, and at least a twentieth of each side and
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

}  // namespace raysheaf::viewer
