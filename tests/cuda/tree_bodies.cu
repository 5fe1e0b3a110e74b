// Compiles the bodies of the tree along a curve for the device.
#include "cuda/compile_case.h"
#include "cuda/tree_cases.h"

namespace raysheaf::test {

std::vector<CompiledCase> compiled_tree_cases() {
  return {compiled<TreeCase>("Tree"), compiled<RayBoxCase>("RayBox"), compiled<MeetCase>("Meet")};
}

}  // namespace raysheaf::test
