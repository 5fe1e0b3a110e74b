// Detects batches that are images: rays row after row, each next to its neighbours in the row,
// above and below.
#pragma once

#include <cstddef>

#include "rays/ray_source.h"

namespace raysheaf {

/// The longest rows that are detected.
inline constexpr std::size_t kLongestRow = 8192;

/// The length of a row if the batch consists of at least eight rows and most rays of a sample lie
/// next to the ray a row further; otherwise 0. This is a guess from a few rays: code that uses it
/// must be correct for any rays. Reads at most the first kLongestRow rays and some thousand others.
/// Invalid rays do no harm.
[[nodiscard]] std::size_t find_picture_row(const RaySource& rays);

}  // namespace raysheaf
