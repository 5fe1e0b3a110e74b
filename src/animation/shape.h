// Meshes that change their shape: morph targets, then skins (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <span>

#include "exec/executor.h"
#include "raysheaf/rig.h"

namespace raysheaf {

/// Computes the positions and normals of `mesh`: those of the shape at rest, displaced by its
/// targets times `weights` and transformed by `joints`. There is one map for each joint of its
/// skin, from the mesh at rest to the space of its instances. O(vertices (targets + joints)).
void deform(const Executor& executor, const RigShape& shape, std::span<const float> weights,
            std::span<const Affine> joints, Mesh* mesh);

}  // namespace raysheaf
