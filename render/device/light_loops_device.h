// Loops over a frame's fragments for shadow rays and the light that arrives. For sources that
// include a device. Lights and sky share the loops: a template parameter chooses the samples and
// evaluates their light.
#pragma once

#include "base/view.h"
#include "render/device/stage_loops_device.h"
#include "render/rays/shadow_body.h"
#include "render/rays/sky_body.h"
#include "render/shade/shade.h"

namespace raysheaf {

/// The most slots of shadow rays that are processed together.
inline constexpr std::size_t kMostDeviceSlots = std::size_t{1} << 24;

/// Some of a scene's lights, seen by a sample: `first` is the number of the first one, `all` the
/// number of the scene's lights.
struct LightsSeen {
  View<const PlacedLight> lights;
  std::uint32_t first, all;
  SampleOf sample;

  [[nodiscard]] std::size_t size() const { return lights.size; }
  [[nodiscard]] ShadowKeyLayout layout() const { return shadow_key_layout(all); }
  RAYSHEAF_HD LightSample choose(const Fragment& f, std::size_t i) const {
    return choose_on_light(f, lights.data[i], first + static_cast<std::uint32_t>(i), sample);
  }
  [[nodiscard]] RAYSHEAF_HD std::uint32_t key(const ShadowKeyLayout& layout, std::size_t i,
                                              const Ray& ray, const LightReach& reach) const {
    return shadow_key(layout, first + static_cast<std::uint32_t>(i),
                      shadow_place(lights.data[i], ray, reach));
  }
  RAYSHEAF_HD static Vec3 lit(const Fragment& f, const LightSample& sample) {
    return lit_by(f, sample);
  }
};

/// The same for an environment, with one slot for each sampling strategy.
struct SkySeen {
  EnvironmentView sky;
  SampleOf sample;

  [[nodiscard]] static std::size_t size() { return kSkyStrategies; }
  [[nodiscard]] static ShadowKeyLayout layout() { return shadow_key_layout(kSkyStrategies); }
  RAYSHEAF_HD LightSample choose(const Fragment& f, std::size_t i) const {
    return choose_in_sky(f, sky, static_cast<std::uint32_t>(i), sample);
  }
  RAYSHEAF_HD static std::uint32_t key(const ShadowKeyLayout& layout, std::size_t i, const Ray& ray,
                                       const LightReach& /*reach*/) {
    return shadow_key(layout, static_cast<std::uint32_t>(i), octahedral(ray.direction));
  }
  RAYSHEAF_HD static Vec3 lit(const Fragment& f, const LightSample& sample) {
    return lit_by_sky(f, sample);
  }
};

/// Flags the slots, light * fragments + fragment, that have a shadow ray.
template <class Device, class Lights>
void facing_on(Device& device, View<const Fragment> fragments, Lights lights,
               std::uint8_t* facing) {
  const std::size_t count = fragments.size;
  device.for_each("raygen: shadow", count * lights.size(), [=] RAYSHEAF_DEVICE(std::size_t slot) {
    const Fragment& f = fragments.data[slot % count];
    facing[slot] = takes_light(f) && faces_light(f, lights.choose(f, slot / count)) ? 1 : 0;
  });
}

template <class Device, class Lights>
void shadow_rays_on(Device& device, View<const Fragment> fragments, Lights lights,
                    View<const std::uint32_t> slots, LightReach reach, Ray* rays,
                    std::uint32_t* keys) {
  const std::size_t count = fragments.size;
  const ShadowKeyLayout layout = lights.layout();
  device.for_each("raygen: shadow", slots.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t slot = slots.data[i];
    const Fragment& f = fragments.data[slot % count];
    const Ray ray = shadow_ray(f, lights.choose(f, slot / count), reach);
    rays[i] = ray;
    if (keys != nullptr) keys[i] = lights.key(layout, slot / count, ray, reach);
  });
}

/// `visibility`: of every slot, initially `kNoRay`.
template <class Device>
void visibility_on(Device& device, View<const std::uint32_t> slots, const std::uint8_t* occluded,
                   std::uint8_t* visibility) {
  device.for_each("shade: visibility", slots.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    visibility[slots.data[i]] =
        static_cast<std::uint8_t>(occluded[i] != 0 ? Visibility::kOccluded : Visibility::kVisible);
  });
}

/// Adds the lights' contributions, light after light. `counts`: fragments are primary hits, for
/// which the film counts lights.
template <class Device, class Lights>
void lights_on(Device& device, View<const Fragment> fragments, Lights lights,
               const std::uint8_t* visibility, Vec3* radiance, bool counts, DeviceFilm film) {
  const std::size_t count = fragments.size, light_count = lights.size();
  device.for_each("shade: lights", count, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Fragment& f = fragments.data[i];
    Vec3 sum = radiance[i];
    std::uint32_t faced = 0, arrived = 0;
    for (std::size_t l = 0; l < light_count; ++l) {
      const std::uint8_t seen = visibility[l * count + i];
      faced += seen != static_cast<std::uint8_t>(Visibility::kNoRay) ? 1 : 0;
      if (seen != static_cast<std::uint8_t>(Visibility::kVisible)) continue;
      ++arrived;
      sum += lights.lit(f, lights.choose(f, l));
    }
    radiance[i] = sum;
    if (!counts) return;
    film.faced[f.pixel] += faced;
    film.arrived[f.pixel] += arrived;
  });
}

}  // namespace raysheaf
