#include "frame/film.h"

#include <utility>

#include "shade/shade.h"

namespace raysheaf {
Film::Film(std::uint32_t width, std::uint32_t height, bool count_tests) {
  const std::size_t pixels = std::size_t{width} * height;
  sums_.width = width;
  sums_.height = height;
  sums_.beauty.resize(pixels);
  sums_.position.resize(pixels);
  sums_.normal.resize(pixels);
  sums_.albedo.resize(pixels);
  sums_.specular.resize(pixels);
  if (count_tests) sums_.tests.resize(pixels);
  faced_.resize(pixels);
  arrived_.resize(pixels);
}

void Film::develop(const Executor& executor, std::optional<float> exposure,
                   RenderResult* sums) const {
  const auto samples = static_cast<float>(sums->samples);
  sums->shadow.resize(faced_.size());
  executor.for_each(faced_.size(), kCopyGrain, [&](std::size_t i) {
    const auto faced = static_cast<float>(faced_[i]);
    sums->shadow[i] = faced > 0 ? static_cast<float>(arrived_[i]) / faced : 1;
    if (sums->samples == 1) return;
    sums->beauty[i] = sums->beauty[i] / samples;
    sums->normal[i] = sums->normal[i] / samples;
    sums->albedo[i] = sums->albedo[i] / samples;
    sums->specular[i] = sums->specular[i] / samples;
  });
  sums->exposure = exposure ? *exposure : automatic_exposure(sums->beauty, sums->ids);
}

RenderResult Film::developed(const Executor& executor, std::optional<float> exposure) const {
  RenderResult result = sums_;
  develop(executor, exposure, &result);
  return result;
}

RenderResult Film::taken(const Executor& executor, std::optional<float> exposure) {
  RenderResult result = std::exchange(sums_, {});
  develop(executor, exposure, &result);
  return result;
}

}  // namespace raysheaf
