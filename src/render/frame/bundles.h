// What the bundles of a method are like: how large, and how loose what bounds them.
//
//   looseness = triangles that the bundle's bound meets
//               -----------------------------------------------------------------
//               triangles whose bounding sphere at least one ray of it passes through
//
// The denominator is what the bound would meet if it were the rays themselves: no bound that is
// tested with spheres meets fewer, so 1 is the best there is. It does not depend on the bound, so
// methods compare; a test that reads corners instead of spheres may get below 1. Rays that leave a
// surface, or look for one that is there, begin or end at the sphere of its triangle: so seldom is
// the denominator 0.
//
// Bundles are taken evenly over the ordered rays. Each costs O(triangles) for its bound, and
// O(rays) for every triangle near it.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/executor.h"
#include "methods/packets/packets.h"
#include "methods/ray_hierarchy/hierarchy.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// Adds `most` bundles of each level, from the top down, or all where there are fewer; `rays` are
/// those that `tree` was built over. Defined for the bounds of the family (geom/bounds.h).
template <class Bound>
void sample_bundles(const Executor& executor, const FlatScene& scene,
                    const RayHierarchy<Bound>& tree, View<const Ray> rays, std::uint32_t most,
                    std::vector<BundleSample>* samples);

/// Adds `most` packets, by their frusta; `rays` are those that they were cut from.
void sample_bundles(const Executor& executor, const FlatScene& scene, View<const Packet> packets,
                    View<const Ray> rays, std::uint32_t most, std::vector<BundleSample>* samples);

}  // namespace raysheaf
