// Stage 7: radiance into pixels.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "exec/executor.h"
#include "rays/fragment.h"
#include "rays/light_body.h"
#include "rays/sample_body.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"
#include "surface/environment_body.h"

namespace raysheaf {

/// What a shadow ray's slot found.
enum class Visibility : std::uint8_t { kNoRay = 0, kVisible, kOccluded };

/// Which parts of a fragment's light arrive by rays that will be traced; the sky stands in for the
/// others.
struct TracedParts {
  bool reflection = true, refraction = true;
};

/// Emission and the sky's light, as it leaves each fragment towards where it was seen from. Where
/// nothing was met, the environment, or the sky itself where there is none (`environment` null).
/// `going_on`, which may be empty, takes the rays that are to be traced from each fragment, bits of
/// `GoingOn` (rays/scatter_body.h).
[[nodiscard]] LargeVector<Vec3> shade_glow(const Executor& executor, View<const Fragment> fragments,
                                           Vec3 sky, TracedParts traced,
                                           const EnvironmentView* environment = nullptr,
                                           View<std::uint8_t> going_on = {});

/// Some of the scene's lights, and the sample that looks at them.
struct LightGroup {
  View<const PlacedLight> lights;
  std::uint32_t first = 0;  ///< the number in the scene of the first
  SampleOf sample;
};

/// Adds what the lights give. `visibility`: one entry a (light, fragment) slot, light first.
void shade_lights(const Executor& executor, View<const Fragment> fragments, const LightGroup& group,
                  View<const Visibility> visibility, View<Vec3> radiance);

/// Adds what an environment gives. `visibility`: one entry a slot of `make_sky_rays`.
void shade_sky(const Executor& executor, View<const Fragment> fragments,
               const EnvironmentView& environment, SampleOf sample,
               View<const Visibility> visibility, View<Vec3> radiance);

/// Adds weight * radiance to the fragments' pixels. `fragments` are sorted by pixel; one pixel's
/// are added in their order, whatever the number of threads.
void accumulate(const Executor& executor, View<const Fragment> fragments, View<const Vec3> radiance,
                View<Vec3> pixels);

/// Fragments whose light is summed one after the other, on every machine.
inline constexpr std::size_t kSkyPart = 64;
struct SkyPart {
  double sum = 0;  ///< of `unoccluded` (shade_body.h), over fragments and lights
  std::uint32_t covered = 0;
};

/// Shows what is there where no light does.
inline constexpr Vec3 kWhiteSky{1, 1, 1};

[[nodiscard]] std::vector<SkyPart> sky_parts(const Executor& executor,
                                             View<const Fragment> fragments,
                                             View<const PlacedLight> lights);
/// A little light from everywhere: a seventh of the mean radiance that the lights would give to
/// white surfaces at the fragments, so that shadows are dark but not black whatever the lights'
/// units; white where no light faces any of them.
[[nodiscard]] Vec3 sky_of_parts(View<const SkyPart> parts);

/// The factor that brings the mean logarithm of the covered pixels' luminance to middle grey (E.
/// Reinhard et al., "Photographic Tone Reproduction", 2002, equation 1), or less where that would
/// burn out more than a twentieth of them.
[[nodiscard]] float automatic_exposure(View<const Vec3> pixels, View<const PixelIds> ids);

}  // namespace raysheaf
