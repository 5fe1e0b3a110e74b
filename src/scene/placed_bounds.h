// The box of the corners of all instances, without placing all of them.
//
// The box of a mesh, placed with a pad (scene/placing.h), contains the corners of its instance. For
// each of the six sides, the instances whose boxes reach farthest are looked at, corner by corner,
// until no other reaches farther than a corner that was found.
#pragma once

#include "exec/executor.h"
#include "scene/placed_runs.h"

namespace raysheaf {

/// Whether or not they wait to be placed; ascending by geom_id. No coordinate is -0. Mostly
/// O(instances), and the triangles of the meshes and of few instances: many reach equally far only
/// if the same row of numbers places them on that axis, and then one of them is looked at.
[[nodiscard]] Box placed_bounds(const Executor& executor, View<const PlacedInstance> instances);

}  // namespace raysheaf
