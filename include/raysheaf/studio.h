// Light for scenes that do not define it: lights that show a model, a sun and its sky.
#pragma once

#include <vector>

#include "raysheaf/cameras.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Three lights that show a model's shape to `camera`, wherever it stands: a key light from above
/// and the left, a weaker fill light from the right, a rim light from behind. All come from far
/// away. Mirrors, metals and glass show a soft box for each (`RenderOptions::soft_boxes`). A camera
/// inside the scene's box gets `showing_light` instead, because walls would block light from
/// outside.
[[nodiscard]] std::vector<Light> studio_lights(const SceneDescription& scene, const Camera& camera);

/// Whether the scene's only lights are those of `studio_lights`, recognized by their names.
[[nodiscard]] bool has_studio_lights(const SceneDescription& scene);

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
