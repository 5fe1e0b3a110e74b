// The family of bounds of ray bundles, and the one place that chooses among them.
//
// A bound is a plain struct with two functions:
//   bound_rays(rays, scene, &bound)      round rays, none of which meets anything outside `scene`
//   bound_children(children, &bound)     round bounds of the same kind
// and, in methods/ray_hierarchy/node_test.h, the test of a triangle with it.
#pragma once

#include <type_traits>

#include "geom/frustum.h"
#include "geom/ray_bound.h"
#include "geom/shaft_cone.h"
#include "raysheaf/method.h"

namespace raysheaf {

/// Unbounded: the scene does not matter.
RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& /*scene*/, RayBound* bound) {
  *bound = bound_rays(rays);
}
RAYSHEAF_HD inline void bound_children(View<const RayBound> children, RayBound* bound) {
  *bound = bound_children(children);
}

/// Calls `body(std::type_identity<Bound>())` with the type of bound that is asked for.
template <class Body>
decltype(auto) with_bound(BundleBound bound, const Body& body) {
  switch (bound) {
    case BundleBound::kFiniteCone:
      return body(std::type_identity<FiniteCone>());
    case BundleBound::kShaft:
      return body(std::type_identity<Shaft>());
    case BundleBound::kFrustum:
      return body(std::type_identity<Frustum>());
    case BundleBound::kShaftAndCone:
      return body(std::type_identity<ShaftCone>());
    case BundleBound::kSphereCone:
      break;
  }
  return body(std::type_identity<RayBound>());
}

}  // namespace raysheaf
