// Methods `rah` and `crsh` on a device: the ray hierarchy against the triangles, level by level, as
// lists of (node, triangle) pairs (Roger, Assarsson, Holzschuch 2007; Reis, Costa, Pereira 2017,
// sections 3.3 to 3.6).
//
//   tests of the top level ─► survivors ┐       a list a level, of stated capacity
//                    ┌──────────────────┘
//                    ▼ b tests a pair ─► survivors ┐
//                                                  ▼ b rays a pair: the best hits as words
//
// A slice of tests is no longer than the room that is left in the list below, so that no list
// overflows; a list that is half full goes down before it is filled further. Memory is bounded by
// levels times capacity, whatever the scene, and nothing is dropped or done twice.
#pragma once

#include <memory>

#include "geom/sphere.h"
#include "methods/ray_hierarchy/traverse.h"
#include "object_tree/triangle_list.h"
#include "queries/query_report.h"

namespace raysheaf {

/// The triangles of one instance, and the ball that holds them.
struct PairMesh {
  Sphere bound;
  std::uint32_t first = 0, count = 0;
};

struct PairScene {
  TriangleList triangles;  ///< in the device's memory, where they stay as they are, or the host's
  View<const PairMesh> meshes;
};

struct PairQuery {
  std::uint32_t levels = 2, branching = 8;
  bool mesh_culling = true;
  Facing facing = Facing::kBoth;
  std::uint32_t key_bits = 32;
  QueryReport* report = nullptr;
};

struct PairOutcome {
  TraverseCounts counts;     ///< as the CPU counts without an early out
  std::uint64_t chunks = 0;  ///< runs of equal keys
};

/// One scene's, on one device. Not for use by two threads at once.
class PairTracer {
 public:
  virtual ~PairTracer() = default;
  virtual void set_scene(const PairScene& scene) = 0;
  /// hits[i] takes the least (t, triangle) of rays[i]. `keys`: what the rays are sorted by; empty:
  /// they stay in their order. Each in the host's memory or the device's, where what writes it is
  /// done.
  virtual PairOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys,
                            const PairQuery& query, View<IndexedHit> hits) = 0;
};

/// Pairs that a level's list holds.
inline constexpr std::uint32_t kPairListCapacity = 1u << 22;

}  // namespace raysheaf
