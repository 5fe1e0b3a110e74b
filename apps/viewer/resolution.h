// How large a picture may be so that it is ready in time.
#pragma once

#include <cstdint>
#include <utility>

namespace raysheaf::viewer {

struct Size {
  std::uint32_t width = 0, height = 0;

  [[nodiscard]] std::uint64_t pixels() const { return std::uint64_t{width} * height; }
  bool operator==(const Size&) const = default;
};

/// Learns what a picture costs, a part for the picture and a part for each pixel, and says which
/// scale of the window meets a goal. The scale moves in steps of a quarter up, so that pictures do
/// not change their size with every hiccup, and at once down.
class Resolution {
 public:
  /// A picture of so many pixels took so long, or longer where it was given up.
  void took(std::uint64_t pixels, double ms);
  /// Costs of other settings or another scene are no guide.
  void forget() { *this = Resolution(); }
  /// Of a window; never more than it, never less than a twentieth a side or 32 pixels.
  [[nodiscard]] Size size_for(Size window, double goal_ms);
  /// What a picture of so many pixels should take; 0 while nothing is known.
  [[nodiscard]] double expected_ms(std::uint64_t pixels) const;

 private:
  double fixed_ms_ = 0, pixel_ms_ = 0;
  double last_pixels_ = 0, last_ms_ = 0;
  double scale_ = 0.25;
  bool known_ = false;
};

}  // namespace raysheaf::viewer
