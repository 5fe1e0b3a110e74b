// Light and background for scenes that do not define them: lights that show a model, a sun and its
// sky, a neutral grey.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "raysheaf/cameras.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

class Animation;  // raysheaf/animation.h

/// Three lights that show a model's shape to `camera`, wherever it stands: a key light from above
/// and the left, a weaker fill light from the right, a rim light from behind. All come from far
/// away. Mirrors, metals and glass show a soft box for each (`RenderOptions::soft_boxes`). A camera
/// inside the scene's box gets `showing_light` instead, because walls would block light from
/// outside.
[[nodiscard]] std::vector<Light> studio_lights(const SceneDescription& scene, const Camera& camera);

/// Whether the scene's only lights are those of `studio_lights`, recognized by their names.
[[nodiscard]] bool has_studio_lights(const SceneDescription& scene);

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

/// Radians. Azimuth 0 is north, and a quarter of a turn is east.
struct SunPosition {
  double elevation = 0, azimuth = 0;
};

/// The position of the sun at a place, in degrees north and east, and a time, in seconds since
/// 1970-01-01 00:00 UTC: J. Meeus, "Astronomical Algorithms" (1998), chapters 12, 13 and 25 (low
/// accuracy), which the solar calculator of NOAA uses, too. Within 0.02 degrees from 1950 to 2050;
/// without the refraction of the atmosphere, which lifts the sun by up to 0.6 degrees at the
/// horizon.
[[nodiscard]] SunPosition sun_position(double latitude, double longitude, double seconds);

/// The unit vector to the sun in a world whose `up` axis points up. Looking from the model's front
/// to its back is looking north: towards -z and with east at +x for +y up, towards +y for +z up.
[[nodiscard]] Vec3 sun_direction(const SunPosition& sun, UpAxis up);

/// Adds a directional light, the sun, and makes a clear sky around it the scene's environment:
/// A. J. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999,
/// with turbidity 3; below the horizon lies a grey ground. Radiance is in kcd/m², irradiance in
/// klx. `to_sun` need not have unit length. Throws `Error` (kInvalidArgument, place "sun") if it is
/// not finite, 0, or below the horizon.
void add_sun_and_sky(SceneDescription& scene, Vec3 to_sun, UpAxis up);

}  // namespace raysheaf
