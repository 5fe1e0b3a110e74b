// The properties of a bound that the walk needs: its node test, the fields of a triangle that the
// test reads, and the test of a whole mesh. Tests that read spheres use a mesh's sphere, tests that
// read corners the box of its vertices.
#pragma once

#include "paper/base/triangle_view.h"
#include "paper/bounds/shaft_cone.h"
#include "paper/ray_hierarchy/node_filter.h"
#include "scene/flat_scene.h"

namespace raysheaf {

RAYSHEAF_HD inline ConeSphereTest make_node_test(const RayBound& bound) {
  return make_cone_sphere_test(bound);
}
RAYSHEAF_HD inline ShaftConeTest make_node_test(const ShaftCone& bound) {
  return {make_node_test(bound.shaft), make_node_test(bound.cone)};
}

template <class Bound>
using NodeTest = decltype(make_node_test(Bound()));

inline bool meets_mesh(const ConeSphereTest& test, const FlatMesh& mesh) {
  return meets(test, mesh.bound.center, mesh.bound.radius);
}
inline bool meets_mesh(const FiniteConeTest& test, const FlatMesh& mesh) {
  return meets(test, mesh.bound.center, mesh.bound.radius);
}
inline bool meets_mesh(const BeamTest& test, const FlatMesh& mesh) {
  return meets(test, mesh.box);
}
inline bool meets_mesh(const FrustumTest& test, const FlatMesh& mesh) {
  return meets(test, mesh.box);
}
inline bool meets_mesh(const ShaftConeTest& test, const FlatMesh& mesh) {
  return meets_mesh(test.shaft, mesh) && meets_mesh(test.cone, mesh);
}

inline FieldPointers<kBallFields> ball_fields(const TriangleView& t) {
  return {t.sphere[0], t.sphere[1], t.sphere[2], t.sphere[3]};
}
inline FieldPointers<kCornerFields> corner_fields(const TriangleView& t) {
  return {t.vertex[0][0], t.vertex[0][1], t.vertex[0][2], t.vertex[1][0], t.vertex[1][1],
          t.vertex[1][2], t.vertex[2][0], t.vertex[2][1], t.vertex[2][2]};
}

inline auto fields_for(const ConeSphereTest* /*type*/, const TriangleView& t) {
  return ball_fields(t);
}
inline auto fields_for(const FiniteConeTest* /*type*/, const TriangleView& t) {
  return ball_fields(t);
}
inline auto fields_for(const BeamTest* /*type*/, const TriangleView& t) {
  return corner_fields(t);
}
inline auto fields_for(const FrustumTest* /*type*/, const TriangleView& t) {
  return corner_fields(t);
}
inline auto fields_for(const ShaftConeTest* /*type*/, const TriangleView& t) {
  FieldPointers<kCornerFields + kBallFields> both{};
  const auto corners = corner_fields(t);
  for (std::size_t i = 0; i < kCornerFields; ++i) both[i] = corners[i];
  for (std::size_t i = 0; i < kBallFields; ++i) both[kCornerFields + i] = t.sphere[i];
  return both;
}

/// The arrays of all triangles that `Test` reads.
template <class Test>
auto fields_of(const TriangleView& triangles) {
  return fields_for(static_cast<const Test*>(nullptr), triangles);
}

/// The same arrays from triangle `first` on.
template <std::size_t kFields>
FieldPointers<kFields> from(FieldPointers<kFields> fields, std::uint32_t first) {
  for (const float*& field : fields) field += first;
  return fields;
}

}  // namespace raysheaf
