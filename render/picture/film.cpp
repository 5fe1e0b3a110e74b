#include "render/picture/film.h"

#include <utility>

#include "render/shade/shade.h"

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
  sums_.ids.resize(pixels);
  if (count_tests) sums_.tests.resize(pixels);
  faced_.resize(pixels);
  arrived_.resize(pixels);
}

RenderResult develop(const Executor& executor, FilmSums film, std::optional<float> exposure) {
  RenderResult result = std::move(film.result);
  const auto samples = static_cast<float>(result.samples);
  result.shadow.resize(film.faced.size());
  executor.for_each(film.faced.size(), kCopyGrain, [&](std::size_t i) {
    const auto faced = static_cast<float>(film.faced[i]);
    result.shadow[i] = faced > 0 ? static_cast<float>(film.arrived[i]) / faced : 1;
    if (result.samples == 1) return;
    result.beauty[i] = result.beauty[i] / samples;
    result.normal[i] = result.normal[i] / samples;
    result.albedo[i] = result.albedo[i] / samples;
    result.specular[i] = result.specular[i] / samples;
  });
  result.exposure = exposure ? *exposure : automatic_exposure(result.beauty, result.ids);
  return result;
}

}  // namespace raysheaf
