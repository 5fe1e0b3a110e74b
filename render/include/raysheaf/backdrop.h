// The background of a picture, and the ground that catches the shadow of its scene.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "raysheaf/cameras.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

class Animation;  // raysheaf/animation.h

/// The ground below everything that the animation shows, sampled at a few times, so that it does
/// not move with the scene: seeks.
[[nodiscard]] Ground ground_under(Animation& animation, UpAxis up);

/// sRGB and alpha, not premultiplied.
using Rgba = std::array<std::uint8_t, 4>;

/// A neutral light grey, for scenes without an environment: the background of `raysheaf render` and
/// of Python's `render`.
inline constexpr Rgba kNeutralBackground{226, 226, 226, 255};

/// Samples per pixel of `raysheaf render` and of Python's `render`, except for built-in scenes;
/// with an environment or a lens there are more (`RenderOptions::samples`).
inline constexpr std::uint32_t kPictureSamples = 4;

/// "white", "black", "transparent" or "#RRGGBB". Throws `Error` (kInvalidArgument) for other text.
[[nodiscard]] Rgba background_from_string(std::string_view text);

/// Puts a background behind the scene instead of the sky that the camera sees. Mirrors and glass
/// still show the sky.
class Backdrop {
 public:
  explicit Backdrop(Rgba color);

  /// Observes each sample of an image that is rendered with these options: replaces
  /// `RenderOptions::on_sample`. This object must outlive the rendering.
  void watch(RenderOptions* options);

  /// `tone_mapped` of the observed image, over the background: in pixels where some samples see
  /// nothing, it shows through in proportion, darker where the shadow on a ground lies; with a
  /// transparent background, that shadow is black and partly opaque. In such pixels an environment
  /// remains slightly visible; a uniform sky does not.
  [[nodiscard]] Image picture(const RenderResult& result) const;

 private:
  /// Adds 1 where the newest sample of `so_far` sees a surface.
  static void count(const RenderResult& so_far, std::vector<Vec3>* normal_sums,
                    std::vector<float>* covered);

  Rgba color_;
  std::vector<Vec3> normal_sums_;  ///< of the previous samples
  std::vector<float> covered_;     ///< number of samples that see a surface, for each pixel
};

}  // namespace raysheaf
