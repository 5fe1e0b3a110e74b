// Measures a method's bundles: their size, and how loose their bounds are.
//
//   looseness = triangles that the bundle's bound intersects
//               -----------------------------------------------------------------
//               triangles whose bounding sphere at least one of its rays intersects
//
// The denominator is the number for an ideal bound that consists of the rays themselves: no bound
// that is tested with spheres can accept fewer, so 1 is the best value. It does not depend on the
// bound, so methods can be compared; a test that uses corners instead of spheres may get below 1.
// The denominator is seldom 0, because rays that leave a surface, or are directed at one, begin or
// end in the sphere of its triangle.
//
// Bundles are evenly spaced over the ordered rays. Each takes O(triangles) for its bound, and
// O(rays) for every triangle near it.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/executor.h"
#include "paper/base/triangle_view.h"
#include "paper/packets/packets.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "raysheaf/statistics.h"

namespace raysheaf {

/// Adds `most` bundles of each level, from the top down, or all if there are fewer; `rays` are
/// those over which `tree` was built. Defined for the bounds of paper/bounds/bounds.h.
template <class Bound>
void sample_bundles(const Executor& executor, const TriangleView& triangles,
                    const RayHierarchy<Bound>& tree, View<const Ray> rays, std::uint32_t most,
                    std::vector<BundleSample>* samples);

/// Adds `most` packets with their frusta; `rays` are those from which they were cut.
void sample_bundles(const Executor& executor, const TriangleView& triangles,
                    View<const Packet> packets, View<const Ray> rays, std::uint32_t most,
                    std::vector<BundleSample>* samples);

}  // namespace raysheaf
