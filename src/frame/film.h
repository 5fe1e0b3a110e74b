// What the samples of a frame add up to, a pixel each.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "raster/gbuffer.h"
#include "raysheaf/render.h"

namespace raysheaf {

/// Sums in binary32, sample by sample: the same whatever the number of threads.
class Film {
 public:
  Film(std::uint32_t width, std::uint32_t height, bool count_tests);

  /// The first hits of the next sample: position and ids of the first are kept, the others add up.
  void see(const Executor& executor, GBuffer first_hits);

  [[nodiscard]] View<Vec3> beauty() { return sums_.beauty; }  ///< to add radiance to
  [[nodiscard]] View<float> tests() { return sums_.tests; }   ///< empty where none are counted
  /// Lights that the first hits face, and those of them that arrive.
  [[nodiscard]] View<std::uint32_t> lights_faced() { return faced_; }
  [[nodiscard]] View<std::uint32_t> lights_arrived() { return arrived_; }

  /// The picture of the samples seen so far, but for its statistics. `exposure`: none, automatic.
  [[nodiscard]] RenderResult developed(const Executor& executor,
                                       std::optional<float> exposure) const;
  /// The same without a copy; the film is empty afterwards.
  [[nodiscard]] RenderResult taken(const Executor& executor, std::optional<float> exposure);

 private:
  void develop(const Executor& executor, std::optional<float> exposure, RenderResult* sums) const;

  RenderResult sums_;
  std::vector<std::uint32_t> faced_, arrived_;
};

}  // namespace raysheaf
