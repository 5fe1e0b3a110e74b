// Transforms of instances, and where they place corners, by the operations that the library states.
#pragma once

#include <span>
#include <vector>

#include "base/vec.h"
#include "lab/verify/random.h"

namespace raysheaf::checks {

/// Without a translation: the identity, whole numbers, mirrors, 10^-6 to 10^6 times as large,
/// rotations, similarities, shears, squeezed by up to 10^6, and flat, a segment or a point.
[[nodiscard]] Affine some_map(Random* random);

/// From 0 to 1: either end and numbers next to it, fractions, or any.
[[nodiscard]] float some_time(Random* random);

/// `transform_at` of raysheaf/scene.h.
[[nodiscard]] Affine mixed_at(std::span<const Affine> transforms, float time);

/// p itself under the identity. Else a row gives ((m0 x + m1 y) + m2 z) + m3, each operation
/// rounded to binary32.
[[nodiscard]] Vec3 placed(const Affine& transform, Vec3 p);

/// Whether no point with coordinates up to `reach` gets one beyond 9e17, by any of the transforms.
[[nodiscard]] bool surely_stays(std::span<const Affine> transforms, float reach);

/// Exactly.
[[nodiscard]] bool is_mirrored(const Affine& transform);

}  // namespace raysheaf::checks
