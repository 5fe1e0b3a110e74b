// Sums of a frame's samples for each pixel.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/render.h"
#include "render/device/frame_stages.h"
#include "render/rays/fragment.h"

namespace raysheaf {

/// Sums in binary32 in the order of samples, so that they do not depend on the number of threads.
class Film {
 public:
  Film(std::uint32_t width, std::uint32_t height, bool count_tests);

  /// Begins the next sample.
  void begin_sample() { ++sums_.samples; }
  /// Adds primary hits of the sample, at most one for each pixel: keeps position and ids of the
  /// first sample, and sums the rest. `ids(triangle)` returns a triangle's ids, or invalid ones.
  template <class Ids>
  void see(const Executor& executor, View<const Fragment> first_hits, const Ids& ids) {
    const bool first = sums_.samples == 1;
    executor.for_each(first_hits.size, kCopyGrain, [&](std::size_t i) {
      const Fragment& f = first_hits[i];
      if (first) sums_.ids[f.pixel] = ids(f.triangle);
      if (f.triangle != kInvalidId) add(f.pixel, f.surface, first);
    });
  }

  [[nodiscard]] View<Vec3> beauty() { return sums_.beauty; }  ///< radiance is added here
  [[nodiscard]] View<float> tests() { return sums_.tests; }   ///< empty if no tests are counted
  /// Number of lights that the primary hits face, and of those that reach them.
  [[nodiscard]] View<std::uint32_t> lights_faced() { return faced_; }
  [[nodiscard]] View<std::uint32_t> lights_arrived() { return arrived_; }

  /// The sums of the samples so far.
  [[nodiscard]] FilmSums sums() const { return {sums_, faced_, arrived_}; }
  /// The same without a copy; the film is empty afterwards.
  [[nodiscard]] FilmSums taken() {
    return {std::exchange(sums_, {}), std::exchange(faced_, {}), std::exchange(arrived_, {})};
  }

 private:
  void add(std::size_t pixel, const Surface& surface, bool first) {
    if (first) sums_.position[pixel] = surface.position;
    sums_.normal[pixel] += surface.normal;
    sums_.albedo[pixel] += surface.diffuse + surface.specular;
    sums_.specular[pixel] += surface.specular;
  }
  RenderResult sums_;
  std::vector<std::uint32_t> faced_, arrived_;
};

/// Computes the image of the sums, without statistics. `exposure`: none means automatic.
[[nodiscard]] RenderResult develop(const Executor& executor, FilmSums film,
                                   std::optional<float> exposure);

}  // namespace raysheaf
