// Which hits of a ray count, besides those in its interval: by side, by the masks and the worlds of
// instances, and all but those of one triangle; and which triangles a point sees. A hit is taken or
// not whatever else the ray meets, so that every order of tests gives the same answer.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/view.h"
#include "intersect/facing_body.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The worlds of a query's rays or points.
struct ItemWorlds {
  const WorldId* each = nullptr;  ///< an item's
  std::size_t per_world = 0;      ///< without `each`: so many in a row are in one, from world 0 on
  std::size_t first = 0;          ///< number of the first item

  /// Otherwise all are in all worlds.
  [[nodiscard]] bool are_given() const { return each != nullptr || per_world != 0; }
  [[nodiscard]] RAYSHEAF_HD WorldId operator[](std::size_t item) const {
    if (each != nullptr) return each[first + item];
    return per_world != 0 ? static_cast<WorldId>((first + item) / per_world) : kAllWorlds;
  }
  /// The same for the items from this one on.
  [[nodiscard]] ItemWorlds from(std::size_t item) const { return {each, per_world, first + item}; }
  /// Whether an item sees the instances of a world.
  [[nodiscard]] RAYSHEAF_HD bool meet(std::size_t item, WorldId of_instance) const {
    if (of_instance == kAllWorlds) return true;
    const WorldId own = (*this)[item];
    return own == of_instance || own == kAllWorlds;
  }
};

/// By the names of triangles, as the caller gives them. Rays by the caller's numbers.
struct HitChoice {
  std::uint32_t mask = 0xffffffff;  ///< rays see an instance if this and its own mask share a bit
  Sides sides = Sides::kBoth;
  const std::uint32_t* masks = nullptr;  ///< a ray's; null: rays see all that `mask` shows
  const TriangleId* skips = nullptr;     ///< a ray's triangle that it does not meet; null: none
  ItemWorlds worlds = {};
  Facing facing = Facing::kBoth;  ///< which also depends on the triangles' flags

  /// By which a ray sees instances.
  [[nodiscard]] RAYSHEAF_HD std::uint32_t mask_of(std::uint32_t ray) const {
    return masks != nullptr ? mask & masks[ray] : mask;
  }
  /// Whether it sees an instance.
  [[nodiscard]] RAYSHEAF_HD bool sees(std::uint32_t ray, std::uint32_t of_mask,
                                      WorldId of_world) const {
    return (mask_of(ray) & of_mask) != 0 && worlds.meet(ray, of_world);
  }
  /// The instance is one that the ray sees. `front`: the ray comes from where the corners run
  /// counter-clockwise in the world; `mirrored`: the transform turns the winding.
  [[nodiscard]] RAYSHEAF_HD bool takes(std::uint32_t ray, TriangleId triangle, bool mirrored,
                                       bool front) const {
    if (skips != nullptr && skips[ray].inst_id == triangle.inst_id &&
        skips[ray].prim_id == triangle.prim_id)
      return false;
    return sides == Sides::kBoth || (front != mirrored) == (sides == Sides::kFront);
  }
  /// The same for the rays from this one on.
  [[nodiscard]] HitChoice from(std::size_t ray) const {
    HitChoice rest = *this;
    if (masks != nullptr) rest.masks += ray;
    if (skips != nullptr) rest.skips += ray;
    rest.worlds = worlds.from(ray);
    return rest;
  }
};

/// The triangles of one instance in a source that numbers those of all, from `first` on.
struct FilteredRun {
  std::uint32_t first = 0;
  std::uint32_t inst_id = 0, mask = 0;
  WorldId world = kAllWorlds;
  bool mirrored = false;  ///< the transform turns the winding
};

/// A choice by the numbers of triangles.
struct HitFilter {
  HitChoice choice;
  View<const FilteredRun> runs;               ///< ascending and without gaps
  const std::uint32_t* first_runs = nullptr;  ///< where in `runs` to look for a block of numbers
  std::uint32_t block_bits = 0;               ///< of the numbers in a block

  /// `front`: the ray comes from where the corners run counter-clockwise in the world.
  [[nodiscard]] RAYSHEAF_HD bool takes(std::uint32_t ray, std::uint32_t triangle,
                                       bool front) const {
    const FilteredRun& run = run_of(triangle);
    return choice.sees(ray, run.mask, run.world) &&
           choice.takes(ray, {run.inst_id, triangle - run.first}, run.mirrored, front);
  }
  /// The same, or true without `runs`: then there is no choice.
  [[nodiscard]] RAYSHEAF_HD bool lets(std::uint32_t ray, std::uint32_t triangle, bool front) const {
    return runs.empty() || takes(ray, triangle, front);
  }
  /// Whether a ray or a point sees the instance of a triangle.
  [[nodiscard]] bool shows(std::uint32_t item, std::uint32_t triangle) const {
    const FilteredRun& run = run_of(triangle);
    return choice.sees(item, run.mask, run.world);
  }
  /// The same for the rays from this one on.
  [[nodiscard]] HitFilter from(std::size_t ray) const {
    return {choice.from(ray), runs, first_runs, block_bits};
  }

  [[nodiscard]] RAYSHEAF_HD const FilteredRun& run_of(std::uint32_t triangle) const {
    std::uint32_t run = first_runs[triangle >> block_bits];
    while (run + 1 < runs.size && runs[run + 1].first <= triangle) ++run;
    return runs[run];
  }
};

}  // namespace raysheaf
