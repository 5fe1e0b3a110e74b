// Compiles the bounds of ray bundles for the device.
#include "cuda/bound_cases.h"
#include "cuda/compile_case.h"

namespace raysheaf::test {

std::vector<CompiledCase> compiled_bound_cases() {
  return {compiled<BoundCase<RayBound>>("SphereConeBound"),
          compiled<BoundCase<FiniteCone>>("FiniteConeBound"),
          compiled<BoundCase<Shaft>>("ShaftBound"),
          compiled<BoundCase<Frustum>>("FrustumBound"),
          compiled<BoundCase<ShaftCone>>("ShaftConeBound"),
          compiled<BoundPartsCase>("BoundParts")};
}

}  // namespace raysheaf::test
