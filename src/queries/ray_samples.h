// What some rays of a batch show of it: how coherent neighbours are, and whether it is an image,
// with rays row after row, each next to its neighbours in the row, above and below.
#pragma once

#include <cstddef>

#include "base/vec.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// The coherence of neighbouring rays, from a sample.
struct Coherence {
  double origin = 0;     ///< median extent of sixteen rays' origins, as a fraction of the whole
                         ///< extent
  double direction = 0;  ///< fraction of groups of sixteen whose rays point towards one quarter
                         ///< with similar slopes

  [[nodiscard]] bool origins_alike() const { return origin < 0.2; }
  [[nodiscard]] bool alike() const { return origins_alike() && direction > 0.7; }
  /// With fewer coherent neighbours, more rays must be sorted into a stream for it to have some
  /// that go one way (`raysheaf bench plan`).
  [[nodiscard]] bool in_streams() const { return origins_alike() && direction > 0.33; }
};

/// `whole`: the box that contains all origins; null: the batch's own extent. O(1): samples the
/// rays. Invalid rays do no harm.
[[nodiscard]] Coherence sample_coherence(const RaySource& rays, const Box* whole = nullptr);

/// The longest rows that are detected.
inline constexpr std::size_t kLongestRow = 8192;

/// The length of a row if the batch consists of at least eight rows and most rays of a sample lie
/// next to the ray a row further; otherwise 0. This is a guess from a few rays: code that uses it
/// must be correct for any rays. Reads at most the first kLongestRow rays and some thousand others.
/// Invalid rays do no harm.
[[nodiscard]] std::size_t find_picture_row(const RaySource& rays);

}  // namespace raysheaf
