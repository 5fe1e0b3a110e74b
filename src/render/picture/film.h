// What the samples of a frame add up to, a pixel each.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"
#include "rays/fragment.h"
#include "raysheaf/render.h"
#include "render/device/frame_stages.h"

namespace raysheaf {

/// Sums in binary32, sample by sample: the same whatever the number of threads.
class Film {
 public:
  Film(std::uint32_t width, std::uint32_t height, bool count_tests);

  /// What follows is of the next sample.
  void begin_sample() { ++sums_.samples; }
  /// First hits of the sample, at most one a pixel: position and ids of the first sample are kept,
  /// the others add up. `ids(triangle)` names a triangle, or none.
  template <class Ids>
  void see(const Executor& executor, View<const Fragment> first_hits, const Ids& ids) {
    const bool first = sums_.samples == 1;
    executor.for_each(first_hits.size, kCopyGrain, [&](std::size_t i) {
      const Fragment& f = first_hits[i];
      if (first) sums_.ids[f.pixel] = ids(f.triangle);
      if (f.triangle != kInvalidId) add(f.pixel, f.surface, first);
    });
  }

  [[nodiscard]] View<Vec3> beauty() { return sums_.beauty; }  ///< to add radiance to
  [[nodiscard]] View<float> tests() { return sums_.tests; }   ///< empty where none are counted
  /// Lights that the first hits face, and those of them that arrive.
  [[nodiscard]] View<std::uint32_t> lights_faced() { return faced_; }
  [[nodiscard]] View<std::uint32_t> lights_arrived() { return arrived_; }

  /// Of the samples seen so far.
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

/// The picture that they show, but for its statistics. `exposure`: none, automatic.
[[nodiscard]] RenderResult develop(const Executor& executor, FilmSums film,
                                   std::optional<float> exposure);

}  // namespace raysheaf
