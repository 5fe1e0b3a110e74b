// Compiles the device functions of the tree along a curve, of points and of streamed blocks.
#include "cuda/block_cases.h"
#include "cuda/compile_case.h"
#include "cuda/point_cases.h"
#include "cuda/tree_cases.h"

namespace raysheaf::test {

std::vector<CompiledCase> compiled_tree_cases() {
  return {compiled<TreeCase>("Tree"),
          compiled<RayBoxCase>("RayBox"),
          compiled<MeetCase>("Meet"),
          compiled<JoinCase>("Join"),
          compiled<LevelCase>("Level"),
          compiled<BlockHitCase>("BlockHit"),
          compiled<BlockRayCase>("BlockRay"),
          compiled<PointRowsCase>("PointRows"),
          compiled<PointTriangleCase>("PointTriangle"),
          compiled<PointWalkCase>("PointWalk")};
}

}  // namespace raysheaf::test
