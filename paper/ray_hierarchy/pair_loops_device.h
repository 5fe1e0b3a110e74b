// The stages of `rah` and `crsh` as loops. For sources that include a device.
#pragma once

#include "device/brute_force_body.h"
#include "exec/atomic.h"
#include "exec/device.h"
#include "paper/order/order_body.h"
#include "paper/ray_hierarchy/node_test.h"
#include "paper/ray_hierarchy/traverse.h"
#include "scene/flatten_body.h"

namespace raysheaf {

/// The triangles of one instance, and the sphere that contains them.
struct PairMesh {
  Sphere bound;
  std::uint32_t first = 0, count = 0;
};

struct NodePair {
  std::uint32_t node = 0, triangle = 0;
};

/// The data for tests of pairs, on the device.
struct PairView {
  View<const Ray> rays;  ///< in the order of the hierarchy
  TriangleList list;
  View<const Sphere> spheres;
  View<const PairMesh> meshes;
  std::uint32_t branching = 8;
  Facing facing = Facing::kBoth;
};

RAYSHEAF_HD inline bool meets_sphere(const RayBound& node, const Sphere& sphere) {
  return meets(make_node_test(node), sphere.center, sphere.radius);
}

template <class Device>
void spheres_on(Device& device, const TriangleList& list, View<Sphere> spheres) {
  device.for_each("hierarchy: spheres", spheres.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Vec3* const corner = list.corners.data + 3 * i;
    spheres.data[i] = conservative_triangle_sphere(corner[0], corner[1], corner[2]);
  });
}

template <class Device>
void bound_leaves_on(Device& device, const PairView& view, View<RayBound> nodes) {
  device.for_each("hierarchy: leaves", nodes.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t first = i * view.branching, left = view.rays.size - first;
    const std::size_t count = left < view.branching ? left : view.branching;
    nodes.data[i] = bound_rays(View<const Ray>(view.rays.data + first, count));
  });
}

template <class Device>
void bound_level_on(Device& device, std::uint32_t branching, View<const RayBound> below,
                    View<RayBound> nodes) {
  device.for_each("hierarchy: levels", nodes.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t first = i * branching, left = below.size - first;
    const std::size_t count = left < branching ? left : branching;
    nodes.data[i] = bound_children(View<const RayBound>(below.data + first, count));
  });
}

/// Tests [0, flags.size) of nodes from `first_node` on with the meshes, node by node.
template <class Device>
void test_meshes_on(Device& device, const PairView& view, View<const RayBound> nodes,
                    std::uint32_t first_node, View<std::uint8_t> flags) {
  device.for_each("trace: meshes", flags.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const RayBound& node = nodes.data[first_node + i / view.meshes.size];
    const PairMesh& mesh = view.meshes.data[i % view.meshes.size];
    flags.data[i] = mesh.count != 0 && meets_sphere(node, mesh.bound) ? 1 : 0;
  });
}

/// The number of triangles of the surviving (node, mesh) tests.
template <class Device>
void count_triangles_on(Device& device, const PairView& view, View<const std::uint32_t> tests,
                        std::uint32_t* counts) {
  device.for_each("trace: meshes", tests.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    counts[i] = view.meshes.data[tests.data[i] % view.meshes.size].count;
  });
}

/// Runs of tests of a node with consecutive triangles: run r has the tests from starts[r] on, and
/// belongs to the (node, mesh) test tests[r].
struct TopTests {
  View<const std::uint32_t> tests;  ///< empty: node by node with all triangles
  const std::uint64_t* starts = nullptr;
  std::uint32_t first_node = 0;
};

RAYSHEAF_HD inline NodePair top_pair(const PairView& view, const TopTests& top,
                                     std::uint64_t test) {
  if (top.tests.empty()) {
    const std::uint64_t triangles = view.spheres.size;
    return {top.first_node + static_cast<std::uint32_t>(test / triangles),
            static_cast<std::uint32_t>(test % triangles)};
  }
  const std::uint32_t run = chunk_at(top.starts, static_cast<std::uint32_t>(top.tests.size), test);
  const std::uint32_t node_and_mesh = top.tests.data[run];
  const auto meshes = static_cast<std::uint32_t>(view.meshes.size);
  return {top.first_node + node_and_mesh / meshes,
          view.meshes.data[node_and_mesh % meshes].first +
              static_cast<std::uint32_t>(test - top.starts[run])};
}

/// Tests [first, first + flags.size) of the top level.
template <class Device>
void test_top_on(Device& device, const PairView& view, const TopTests& top,
                 View<const RayBound> nodes, std::uint64_t first, View<std::uint8_t> flags) {
  device.for_each("trace: top level", flags.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const NodePair pair = top_pair(view, top, first + i);
    flags.data[i] = meets_sphere(nodes.data[pair.node], view.spheres.data[pair.triangle]) ? 1 : 0;
  });
}
template <class Device>
void keep_top_on(Device& device, const PairView& view, const TopTests& top, std::uint64_t first,
                 View<const std::uint32_t> kept, NodePair* out) {
  device.for_each("trace: top level", kept.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out[i] = top_pair(view, top, first + kept.data[i]);
  });
}

/// Test t of a lower level: child t % b of the node of pair t / b.
RAYSHEAF_HD inline NodePair child_pair(const NodePair* pairs, std::uint32_t branching,
                                       std::uint64_t test) {
  const NodePair pair = pairs[test / branching];
  return {pair.node * branching + static_cast<std::uint32_t>(test % branching), pair.triangle};
}

template <class Device>
void test_children_on(Device& device, const PairView& view, const NodePair* pairs,
                      View<const RayBound> nodes, std::uint64_t first, View<std::uint8_t> flags) {
  device.for_each("trace: levels", flags.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const NodePair pair = child_pair(pairs, view.branching, first + i);
    flags.data[i] = pair.node < nodes.size &&
                            meets_sphere(nodes.data[pair.node], view.spheres.data[pair.triangle])
                        ? 1
                        : 0;
  });
}
template <class Device>
void keep_children_on(Device& device, std::uint32_t branching, const NodePair* pairs,
                      std::uint64_t first, View<const std::uint32_t> kept, NodePair* out) {
  device.for_each("trace: levels", kept.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out[i] = child_pair(pairs, branching, first + kept.data[i]);
  });
}

/// Tests the rays of each pair's leaf with its triangle.
template <class Device>
void final_tests_on(Device& device, const PairView& view, View<const NodePair> pairs,
                    View<std::uint64_t> words) {
  device.for_each(
      "trace: final tests", pairs.size * view.branching, [=] RAYSHEAF_DEVICE(std::size_t i) {
        const NodePair pair = child_pair(pairs.data, view.branching, i);
        if (pair.node >= words.size) return;
        const std::uint64_t word = best_of_list(view.list, pair.triangle, pair.triangle + 1,
                                                {view.facing}, view.rays.data[pair.node]);
        if (word != kNoHitWord) lower_to(&words.data[pair.node], word);
      });
}

/// Copies the hits of rays in the order of the hierarchy to the caller's places.
template <class Device>
void scatter_hits_on(Device& device, const PairView& view, View<const std::uint64_t> words,
                     const std::uint32_t* order, IndexedHit* hits) {
  device.for_each("trace: hits of words", words.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    hits[order[i]] = hit_of_word(view.list, words.data[i], view.rays.data[i]);
  });
}

}  // namespace raysheaf
