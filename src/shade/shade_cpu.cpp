#include <cmath>

#include "shade/shade.h"
#include "shade/shade_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr float kMiddleGrey = 0.18f;
constexpr float kSkyPart = 1.0f / 12;

}  // namespace

std::vector<Vec3> shade_glow(const Executor& executor, View<const Fragment> fragments, Vec3 sky,
                             TracedParts traced) {
  std::vector<Vec3> radiance(fragments.size);
  executor.for_each(fragments.size, kGrain, [&](std::size_t i) {
    const Fragment& f = fragments[i];
    if (f.triangle == kInvalidId) {
      radiance[i] = sky;
      return;
    }
    const Scattering s = scatter(f);
    const bool reflects =
        traced.reflection && s.mirror && worth_tracing(f.weight * s.reflected_part);
    const bool refracts = traced.refraction && worth_tracing(f.weight * s.refracted_part);
    radiance[i] = glow(f, s, sky, reflects, refracts);
  });
  return radiance;
}

void shade_lights(const Executor& executor, View<const Fragment> fragments,
                  View<const Light> lights, View<const Visibility> visibility,
                  View<Vec3> radiance) {
  executor.for_each(fragments.size, kGrain, [&](std::size_t i) {
    for (std::size_t l = 0; l < lights.size; ++l) {
      if (visibility[l * fragments.size + i] == Visibility::kVisible)
        radiance[i] += lit_by(fragments[i], lights[l]);
    }
  });
}

void accumulate(const Executor& executor, View<const Fragment> fragments, View<const Vec3> radiance,
                View<Vec3> pixels) {
  executor.for_each(fragments.size, kGrain, [&](std::size_t i) {
    const std::uint32_t pixel = fragments[i].pixel;
    if (i > 0 && fragments[i - 1].pixel == pixel) return;  // the first of a pixel adds them all
    for (std::size_t j = i; j < fragments.size && fragments[j].pixel == pixel; ++j)
      pixels[pixel] += fragments[j].weight * radiance[j];
  });
}

Vec3 automatic_sky(View<const Fragment> fragments, View<const Light> lights) {
  double sum = 0;
  std::size_t covered = 0;
  for (const Fragment& f : fragments) {
    if (f.triangle == kInvalidId) continue;
    ++covered;
    for (const Light& light : lights) {
      const LightSample sample = sample_light(light, f.surface.position);
      const float cosine = dot(f.surface.normal, sample.to_light);
      if (cosine > 0) sum += static_cast<double>(luminance(sample.irradiance) * cosine / kPi);
    }
  }
  const float mean = covered > 0 ? static_cast<float>(sum / static_cast<double>(covered)) : 0;
  // Without any light at all a white sky shows what is there.
  const float radiance = lights.empty() ? 1.0f : kSkyPart * mean;
  return {radiance, radiance, radiance};
}

float automatic_exposure(View<const Vec3> pixels, View<const PixelIds> ids) {
  double sum = 0;
  std::size_t covered = 0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const float value = luminance(pixels[i]);
    if (ids[i].geom_id == kInvalidId || !(value > 0) || !std::isfinite(value)) continue;
    sum += std::log(static_cast<double>(value));
    ++covered;
  }
  if (covered == 0) return 1;
  return kMiddleGrey / static_cast<float>(std::exp(sum / static_cast<double>(covered)));
}

}  // namespace raysheaf
