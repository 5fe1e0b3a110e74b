// Batches that are pictures: rays row after row, each beside those of its row and above and below
// others.
#pragma once

#include <cstddef>

#include "rays/ray_source.h"

namespace raysheaf {

/// The longest rows that are looked for.
inline constexpr std::size_t kLongestRow = 8192;

/// The rays of a row where the batch begins with rows, of at least eight, that lie beside each
/// other; or else 0. A guess from a few rows: what is built on it must be right for any rays.
/// O(the first row). Rays that are wrong do no harm.
[[nodiscard]] std::size_t find_picture_row(const RaySource& rays);

}  // namespace raysheaf
