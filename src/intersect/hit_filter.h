// Which hits of a ray count, besides those in its interval: by side, by the masks of instances, and
// all but those of one triangle. A hit is taken or not whatever else the ray meets, so that every
// order of tests gives the same answer.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// By the names of triangles, as the caller gives them. Rays by the caller's numbers.
struct HitChoice {
  std::uint32_t mask = 0xffffffff;  ///< rays see an instance if this and its own mask share a bit
  Sides sides = Sides::kBoth;
  const std::uint32_t* masks = nullptr;  ///< a ray's; null: rays see all that `mask` shows
  const TriangleId* skips = nullptr;     ///< a ray's triangle that it does not meet; null: none

  /// By which a ray sees instances.
  [[nodiscard]] std::uint32_t mask_of(std::uint32_t ray) const {
    return masks != nullptr ? mask & masks[ray] : mask;
  }
  /// The instance is one that the ray sees. `front`: the ray comes from where the corners run
  /// counter-clockwise in the world; `mirrored`: the transform turns the winding.
  [[nodiscard]] bool takes(std::uint32_t ray, TriangleId triangle, bool mirrored,
                           bool front) const {
    if (skips != nullptr && skips[ray].inst_id == triangle.inst_id &&
        skips[ray].prim_id == triangle.prim_id)
      return false;
    return sides == Sides::kBoth || (front != mirrored) == (sides == Sides::kFront);
  }
};

/// The triangles of one instance, as a filter by numbers sees them.
struct FilteredRun {
  std::uint32_t first = 0, count = 0;  ///< the numbers that they have
  std::uint32_t inst_id = 0, mask = 0;
  bool mirrored = false;  ///< the transform turns the winding
};

/// The same by the numbers of triangles in their source.
struct HitFilter {
  Sides sides = Sides::kBoth;
  const std::uint32_t* masks = nullptr;  ///< a ray's; null: rays see everything
  const std::uint32_t* skips = nullptr;  ///< a ray's triangle that it does not meet, or kInvalidId
  View<const FilteredRun> runs;          ///< ascending and without gaps
  const std::uint32_t* first_runs = nullptr;  ///< where in `runs` to look for a block of numbers
  std::uint32_t block_bits = 0;               ///< of the numbers in a block

  /// `front`: the ray comes from where the corners run counter-clockwise in the world.
  [[nodiscard]] bool takes(std::uint32_t ray, std::uint32_t triangle, bool front) const {
    if (skips != nullptr && skips[ray] == triangle) return false;
    if (sides == Sides::kBoth && masks == nullptr) return true;
    const FilteredRun& run = run_of(triangle);
    if (masks != nullptr && (masks[ray] & run.mask) == 0) return false;
    return sides == Sides::kBoth || (front != run.mirrored) == (sides == Sides::kFront);
  }

 private:
  [[nodiscard]] const FilteredRun& run_of(std::uint32_t triangle) const {
    std::uint32_t run = first_runs[triangle >> block_bits];
    while (run + 1 < runs.size && runs[run + 1].first <= triangle) ++run;
    return runs[run];
  }
};

}  // namespace raysheaf
