// Meshes that change their shape: morph targets, then skins (glTF 2.0, sections 3.7.2.2 and 3.7.3).
#pragma once

#include <span>

#include "exec/executor.h"
#include "raysheaf/rig.h"

namespace raysheaf {

/// Writes the positions and normals of `mesh`: those of the shape at rest, moved by its targets
/// times `weights` and pulled by `joints`, one map a joint of its skin, from the mesh at rest to
/// where its instances take it up. Each vertex by itself, O(vertices (targets + joints)).
void deform(const Executor& executor, const RigShape& shape, std::span<const float> weights,
            std::span<const Affine> joints, Mesh* mesh);

}  // namespace raysheaf
