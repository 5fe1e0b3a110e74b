// The kinds of bounds of ray bundles, and the function that chooses among them.
//
// A bound is a plain struct with two functions:
//   bound_rays(rays, scene, &bound)      bounds rays that hit nothing outside `scene`
//   bound_children(children, &bound)     bounds the volumes of bounds of the same kind
// and with the test of a triangle in paper/ray_hierarchy/node_test.h.
#pragma once

#include <type_traits>

#include "paper/bounds/frustum.h"
#include "paper/bounds/ray_bound.h"
#include "paper/bounds/shaft_cone.h"
#include "raysheaf/method.h"

namespace raysheaf {

/// Unbounded: `scene` is not used.
RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& /*scene*/, RayBound* bound) {
  *bound = bound_rays(rays);
}
RAYSHEAF_HD inline void bound_children(View<const RayBound> children, RayBound* bound) {
  *bound = bound_children(children);
}

/// Calls `body(std::type_identity<Bound>())` with the requested type of bound.
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
