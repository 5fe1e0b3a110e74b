#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/bits.h"
#include "render/rays/point_light.h"
#include "render/rays/shadow_body.h"
#include "render/rays/sky_body.h"
#include "render/shade/glow.h"
#include "render/shade/point_shading.h"
#include "render/shade/shade.h"
#include "render/shade/shade_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kBlockGrain = 4;

/// Fragments that are shaded together.
struct ShadedBlock {
  View<const Fragment> fragments;
  const LightGroup& group;
  const Visibility* visibility;  ///< of the first fragment and the first light
  std::size_t light_stride;      ///< distance between the visibilities of two lights
  View<Vec3> radiance;
};

/// Adds the lights one after the other, so that a fragment sums them in order.
void shade_block(const ShadedBlock& block) {
  const LightGroup& group = block.group;
  const std::size_t count = block.fragments.size;
  ShadingColumns columns;
  std::uint8_t visible[kLightBlock] = {};
  bool gathered = false;
  for (std::uint32_t l = 0; l < group.lights.size; ++l) {
    const PlacedLight& light = group.lights[l];
    std::memcpy(visible, block.visibility + l * block.light_stride, count);
    constexpr int kShown = static_cast<int>(Visibility::kVisible);
    if (std::memchr(visible, kShown, count) == nullptr) continue;
    if (!gathered) {
      gather_shading(block.fragments, block.radiance.data, &columns);
      gathered = true;
    }
    if (shines_from_point(light, group.sample)) {
      add_point_light(light, block.fragments, visible, &columns);
      continue;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (visible[i] != kShown) continue;
      const Fragment& f = block.fragments[i];
      const Vec3 given = lit_by(f, choose_on_light(f, light, group.first + l, group.sample));
      for (int k = 0; k < 3; ++k) columns.radiance[k][i] += component(given, k);
    }
  }
  if (gathered) give_radiance(columns, {block.radiance.data, count});
}

/// Puts the studio's room where `find_glow` has put the sky.
void show_room(View<const Fragment> fragments, const Surroundings& around, std::uint8_t traced,
               Vec3* radiance) {
  for (std::size_t i = 0; i < fragments.size; ++i) {
    const Fragment& f = fragments[i];
    if (f.triangle == kInvalidId) {
      if (!around.behind) radiance[i] = studio_radiance(around.room, f.incoming, 0);
      continue;
    }
    const bool is_matte = !(max_component(f.surface.specular) > 0 || f.surface.transmission > 0);
    if (is_matte || f.surface.unlit) continue;
    const Scattering s = scatter(f);
    radiance[i] += room_glow(f, s, around.sky, around.room, rays_of(f, s) & traced);
  }
}

constexpr float kMiddleGrey = 0.18f;
constexpr double kBrightPart = 0.95;  // this fraction of the pixels stays below kBrightest
constexpr float kBrightest = 1.3f;
constexpr float kSkyShare = 1.0f / 7;

}  // namespace

LargeVector<Vec3> shade_glow(const Executor& executor, View<const Fragment> fragments,
                             const Surroundings& around, std::uint8_t traced,
                             View<std::uint8_t> going_on) {
  const Vec3 sky = around.sky;
  const EnvironmentView* const environment = around.environment;
  LargeVector<Vec3> radiance(fragments.size);
  const auto glow_alone = [&](std::size_t i) {
    const Fragment& f = fragments[i];
    if (f.triangle == kInvalidId) {
      radiance[i] = environment != nullptr ? environment_radiance(*environment, f.incoming) : sky;
      if (!going_on.empty()) going_on[i] = 0;
      return;
    }
    const Scattering s = environment != nullptr ? scatter(f) : scattered_parts(f);
    const auto rays = static_cast<std::uint8_t>(rays_of(f, s) & traced);
    if (!going_on.empty()) going_on[i] = rays;
    radiance[i] = glow(f, s, sky, rays);
    if (environment != nullptr) radiance[i] += environment_glow(f, s, *environment, rays);
  };
  if (environment != nullptr) {
    executor.for_each(fragments.size, kWorkGrain, glow_alone);
    return radiance;
  }
  executor.for_each(div_ceil(fragments.size, kLightBlock), kBlockGrain, [&](std::size_t block) {
    const std::size_t first = block * kLightBlock;
    const std::size_t count = std::min(kLightBlock, fragments.size - first);
    std::uint16_t odd[kLightGroups];
    find_glow(fragments.slice(first, count), {sky, traced}, radiance.data() + first,
              going_on.empty() ? nullptr : going_on.data + first, odd);
    for (std::size_t group = 0; group < div_ceil(count, kLightLanes); ++group) {
      for (std::uint32_t rest = odd[group]; rest != 0; rest &= rest - 1)
        glow_alone(first + group * kLightLanes + static_cast<std::size_t>(std::countr_zero(rest)));
    }
    if (around.room.white > 0)
      show_room(fragments.slice(first, count), around, traced, radiance.data() + first);
  });
  return radiance;
}

void shade_lights(const Executor& executor, View<const Fragment> fragments, const LightGroup& group,
                  View<const Visibility> visibility, View<Vec3> radiance) {
  executor.for_each(div_ceil(fragments.size, kLightBlock), kBlockGrain, [&](std::size_t block) {
    const std::size_t first = block * kLightBlock;
    const std::size_t count = std::min(kLightBlock, fragments.size - first);
    shade_block({fragments.slice(first, count), group, visibility.data + first, fragments.size,
                 radiance.slice(first, count)});
  });
}

void shade_sky(const Executor& executor, View<const Fragment> fragments,
               const EnvironmentView& environment, SampleOf sample,
               View<const Visibility> visibility, View<Vec3> radiance) {
  executor.for_each(fragments.size, kWorkGrain, [&](std::size_t i) {
    for (std::uint32_t strategy = 0; strategy < kSkyStrategies; ++strategy) {
      if (visibility[strategy * fragments.size + i] != Visibility::kVisible) continue;
      radiance[i] +=
          lit_by_sky(fragments[i], choose_in_sky(fragments[i], environment, strategy, sample));
    }
  });
}

void accumulate(const Executor& executor, View<const Fragment> fragments, View<const Vec3> radiance,
                View<Vec3> pixels) {
  executor.for_each(fragments.size, kWorkGrain, [&](std::size_t i) {
    const std::uint32_t pixel = fragments[i].pixel;
    if (i > 0 && fragments[i - 1].pixel == pixel)
      return;  // the first fragment of a pixel adds
               // them all
    for (std::size_t j = i; j < fragments.size && fragments[j].pixel == pixel; ++j)
      pixels[pixel] += fragments[j].weight * radiance[j];
  });
}

std::vector<SkyPart> sky_parts(const Executor& executor, View<const Fragment> fragments,
                               View<const PlacedLight> lights) {
  std::vector<SkyPart> parts(div_ceil(fragments.size, kSkyPart));
  executor.for_each(parts.size(), kWorkGrain / kSkyPart, [&](std::size_t p) {
    const std::size_t end = std::min((p + 1) * kSkyPart, fragments.size);
    for (std::size_t i = p * kSkyPart; i < end; ++i) {
      const Fragment& f = fragments[i];
      if (f.triangle == kInvalidId) continue;
      ++parts[p].covered;
      for (const PlacedLight& light : lights)
        parts[p].sum += double{unoccluded(f, sample_light(light, f.surface.position))};
    }
  });
  return parts;
}

Vec3 sky_of_parts(View<const SkyPart> parts) {
  double sum = 0;
  std::uint64_t covered = 0;
  for (const SkyPart& part : parts) {
    sum += part.sum;
    covered += part.covered;
  }
  if (covered > 0 && !(sum > 0)) return kWhiteSky;
  const double mean = covered > 0 ? sum / static_cast<double>(covered) : 0;
  const float radiance = kSkyShare * static_cast<float>(mean);
  return {radiance, radiance, radiance};
}

float automatic_exposure(View<const Vec3> pixels, View<const PixelIds> ids) {
  std::vector<float> values;
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const float value = luminance(pixels[i]);
    if (ids[i].geom_id == kInvalidId || !(value > 0) || !std::isfinite(value)) continue;
    sum += std::log(static_cast<double>(value));
    values.push_back(value);
  }
  if (values.empty()) return 1;
  const auto mean = static_cast<float>(std::exp(sum / static_cast<double>(values.size())));
  const auto bright = values.begin() + static_cast<std::ptrdiff_t>(
                                           static_cast<double>(values.size() - 1) * kBrightPart);
  std::nth_element(values.begin(), bright, values.end());
  return std::min(kMiddleGrey / mean, kBrightest / *bright);
}

}  // namespace raysheaf
