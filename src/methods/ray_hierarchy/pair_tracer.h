// The methods `rah` and `crsh` on a device: the ray hierarchy against the triangles, level by
// level, as lists of (node, triangle) pairs (Roger, Assarsson, Holzschuch 2007; Reis, Costa,
// Pereira 2017, sections 3.3 to 3.6).
//
//   tests of the top level ─► survivors ┐       one list per level, of stated capacity
//                    ┌──────────────────┘
//                    ▼ b tests per pair ─► survivors ┐
//                                                    ▼ b rays per pair: the best hits as words
//
// A slice of tests is at most as long as the free space of the list below, so that no list
// overflows; a list that is half full is processed before it is filled further. Memory is bounded
// by levels times capacity for any scene, and no pair is lost or processed twice.
#pragma once

#include <memory>

#include "geom/sphere.h"
#include "methods/ray_hierarchy/traverse.h"
#include "object_tree/triangle_list.h"
#include "queries/query_report.h"

namespace raysheaf {

/// The triangles of one instance, and the sphere that contains them.
struct PairMesh {
  Sphere bound;
  std::uint32_t first = 0, count = 0;
};

struct PairScene {
  TriangleList triangles;  ///< used in place if in the device's memory, copied if in the host's
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
  TraverseCounts counts;     ///< as the CPU counts without early out
  std::uint64_t chunks = 0;  ///< runs of equal keys
};

/// The tracer of one scene on one device. Not for two threads at once.
class PairTracer {
 public:
  virtual ~PairTracer() = default;
  virtual void set_scene(const PairScene& scene) = 0;
  /// hits[i] receives the hit of rays[i] with the least (t, triangle). `keys`: the sort keys of the
  /// rays; empty: the rays stay in their order. Each array may be in the host's or the device's
  /// memory; the work that writes it must be complete.
  virtual PairOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys,
                            const PairQuery& query, View<IndexedHit> hits) = 0;
};

/// Pairs that a level's list can hold.
inline constexpr std::uint32_t kPairListCapacity = 1u << 22;

}  // namespace raysheaf
