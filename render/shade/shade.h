// Stage 7: computes radiance and adds it to pixels.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"
#include "render/rays/fragment.h"
#include "render/rays/light_body.h"
#include "render/rays/sample_body.h"
#include "render/surface/environment_body.h"
#include "render/surface/studio_room.h"

namespace raysheaf {

/// The result of a shadow ray's slot.
enum class Visibility : std::uint8_t { kNoRay = 0, kVisible, kOccluded };

/// The light that comes from outside the scene.
struct Surroundings {
  Vec3 sky;                                      ///< radiance of a uniform sky
  const EnvironmentView* environment = nullptr;  ///< in place of the sky; null: there is none
  StudioRoom room = {};  ///< what reflections and refractions show in place of the sky
  bool behind = false;   ///< the fragments are the camera's: misses show the sky behind the scene,
                         ///< not the room
};

/// Emission and the surroundings' light that leave each fragment towards the eye. Misses get the
/// surroundings. `traced`: bits (`bit_of`, render/rays/scatter_body.h) of the rays that will add
/// their part; for the others, the surroundings are used. `going_on`, which may be empty, receives
/// those of the rays to trace from each fragment.
[[nodiscard]] LargeVector<Vec3> shade_glow(const Executor& executor, View<const Fragment> fragments,
                                           const Surroundings& around, std::uint8_t traced,
                                           View<std::uint8_t> going_on = {});

/// Some of the scene's lights, and the current sample.
struct LightGroup {
  View<const PlacedLight> lights;
  std::uint32_t first = 0;  ///< number of the first light in the scene
  SampleOf sample;
};

/// Adds the lights' contributions. `visibility`: one entry for each (light, fragment) slot, sorted
/// by light.
void shade_lights(const Executor& executor, View<const Fragment> fragments, const LightGroup& group,
                  View<const Visibility> visibility, View<Vec3> radiance);

/// Adds an environment's contribution. `visibility`: one entry for each slot of `make_sky_rays`.
void shade_sky(const Executor& executor, View<const Fragment> fragments,
               const EnvironmentView& environment, SampleOf sample,
               View<const Visibility> visibility, View<Vec3> radiance);

/// Adds weight * radiance to the fragments' pixels. `fragments` are sorted by pixel; those of one
/// pixel are added in order, with any number of threads.
void accumulate(const Executor& executor, View<const Fragment> fragments, View<const Vec3> radiance,
                View<Vec3> pixels);

/// Number of fragments whose light is summed in order, on every machine.
inline constexpr std::size_t kSkyPart = 64;
struct SkyPart {
  double sum = 0;  ///< of `unoccluded` (shade_body.h), over fragments and lights
  std::uint32_t covered = 0;
};

/// The sky that makes surfaces visible without lights.
inline constexpr Vec3 kWhiteSky{1, 1, 1};

[[nodiscard]] std::vector<SkyPart> sky_parts(const Executor& executor,
                                             View<const Fragment> fragments,
                                             View<const PlacedLight> lights);
/// A dim uniform sky: a seventh of the mean radiance that the lights would give to white surfaces
/// at the fragments, so that shadows are dark but not black for any units of the lights; white if
/// no light faces any of them.
[[nodiscard]] Vec3 sky_of_parts(View<const SkyPart> parts);

/// The factor that maps the mean logarithm of the covered pixels' luminance to middle grey (E.
/// Reinhard et al., "Photographic Tone Reproduction", 2002, equation 1), or less if that would
/// overexpose more than a twentieth of them.
[[nodiscard]] float automatic_exposure(View<const Vec3> pixels, View<const PixelIds> ids);

}  // namespace raysheaf
