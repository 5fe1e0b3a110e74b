#include <algorithm>
#include <cmath>

#include "base/bits.h"
#include "raygen/shadow_body.h"
#include "raygen/sky_body.h"
#include "shade/shade.h"
#include "shade/shade_body.h"

namespace raysheaf {
namespace {

/// The luminance that white would have where nothing stood before the light.
float unoccluded(const Fragment& f, const Light& light) {
  const LightSample sample = sample_light(light, f.surface.position);
  const float cosine = dot(f.surface.normal, sample.to_light);
  return cosine > 0 ? luminance(sample.irradiance) * cosine / kPi : 0;
}

constexpr float kMiddleGrey = 0.18f;
constexpr double kBrightPart = 0.95;  // this part of the pixels stays below kBrightest
constexpr float kBrightest = 1.3f;
constexpr float kSkyPart = 1.0f / 7;

}  // namespace

std::vector<Vec3> shade_glow(const Executor& executor, View<const Fragment> fragments, Vec3 sky,
                             TracedParts traced, const EnvironmentView* environment) {
  std::vector<Vec3> radiance(fragments.size);
  executor.for_each(fragments.size, kWorkGrain, [&](std::size_t i) {
    const Fragment& f = fragments[i];
    if (f.triangle == kInvalidId) {
      radiance[i] = environment != nullptr ? environment_radiance(*environment, f.incoming) : sky;
      return;
    }
    const Scattering s = scatter(f);
    const bool reflects =
        traced.reflection && s.mirror && worth_tracing(f.weight * s.reflected_part);
    const bool refracts = traced.refraction && worth_tracing(f.weight * s.refracted_part);
    radiance[i] = glow(f, s, sky, reflects, refracts);
    if (environment != nullptr)
      radiance[i] += environment_glow(f, s, *environment, reflects, refracts);
  });
  return radiance;
}

void shade_lights(const Executor& executor, View<const Fragment> fragments, const LightGroup& group,
                  View<const Visibility> visibility, View<Vec3> radiance) {
  executor.for_each(fragments.size, kWorkGrain, [&](std::size_t i) {
    for (std::uint32_t l = 0; l < group.lights.size; ++l) {
      if (visibility[l * fragments.size + i] != Visibility::kVisible) continue;
      const LightSample light =
          choose_on_light(fragments[i], group.lights[l], group.first + l, group.sample);
      radiance[i] += lit_by(fragments[i], light);
    }
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
    if (i > 0 && fragments[i - 1].pixel == pixel) return;  // the first of a pixel adds them all
    for (std::size_t j = i; j < fragments.size && fragments[j].pixel == pixel; ++j)
      pixels[pixel] += fragments[j].weight * radiance[j];
  });
}

Vec3 automatic_sky(const Executor& executor, View<const Fragment> fragments,
                   View<const Light> lights) {
  if (lights.empty()) return {1, 1, 1};  // a white sky shows what is there
  struct Part {
    double sum = 0;
    std::size_t covered = 0;
  };
  std::vector<Part> parts(div_ceil(fragments.size, kWorkGrain));
  executor.for_each(parts.size(), 1, [&](std::size_t p) {
    const std::size_t end = std::min((p + 1) * kWorkGrain, fragments.size);
    for (std::size_t i = p * kWorkGrain; i < end; ++i) {
      if (fragments[i].triangle == kInvalidId) continue;
      ++parts[p].covered;
      for (const Light& light : lights) parts[p].sum += double{unoccluded(fragments[i], light)};
    }
  });
  Part whole;
  for (const Part& part : parts) {
    whole.sum += part.sum;
    whole.covered += part.covered;
  }
  const double mean = whole.covered > 0 ? whole.sum / static_cast<double>(whole.covered) : 0;
  const float radiance = kSkyPart * static_cast<float>(mean);
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
