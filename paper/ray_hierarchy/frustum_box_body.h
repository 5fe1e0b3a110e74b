// Tests whether a frustum intersects a box, as geom/beam_box_body.h does for shafts.
#pragma once

#include "geom/beam_box_body.h"
#include "paper/bounds/frustum.h"

namespace raysheaf {

struct FrustumTest {
  BeamTest beam;
  Box hull;
};

RAYSHEAF_HD inline FrustumTest make_node_test(const Frustum& frustum) {
  return {make_beam_test(frustum.origins, frustum.directions.min * frustum.reach,
                         frustum.directions.max * frustum.reach),
          frustum.hull};
}

RAYSHEAF_HD inline bool meets(const FrustumTest& node, const Box& box) {
  const float slack = beam_slack(box.max - node.beam.origins.min, node.beam.origins.max - box.min);
  const Vec3 below = node.hull.max - box.min, above = box.max - node.hull.min;
  return min_component(min(below, above)) + slack >= 0 && meets(node.beam, box);
}

}  // namespace raysheaf
