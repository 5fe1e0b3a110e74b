// Builds the nodes of the tree along a curve by a loop over its triangles, each of which is a run
// at first.
//
//   runs    [. . . .][. . .]   two neighbours are joined if the keys at their border share more
//                              bits than those at their far ends (C. Apetrei, "Fast and Simple
//                              Agglomerative LBVH Construction", CGVC 2014). The second thread that
//                              arrives at a border continues.
//   lists   a b c d  e f       a run of more than kLinearLeaf triangles has at most kListed
//            \_|__|_/          clusters. The lists of two runs become one list, in which the pair
//              |  |            with the smallest common box becomes a node, until kListed are left.
//           a be  d cf         Finally a single cluster is left, the root.
//
// C. Benthin et al., "H-PLOC: Hierarchical Parallel Locally-Ordered Clustering for Bounding Volume
// Hierarchy Construction", HPG 2024, by single threads instead of warps, with shorter lists. A
// run's clusters depend only on its triangles, so the tree is the same for any order in which runs
// are joined.
#pragma once

#include "base/lesser.h"
#include "object_tree/linear_tree_body.h"

namespace raysheaf {

inline constexpr std::uint32_t kListed = 4, kJoined = 2 * kListed;
static_assert(kListed <= kLinearLeaf + 1, "a run that has a list has as many places");
/// Number of halvings in which kListed clusters become the root.
inline constexpr std::uint32_t kRootLevels = 2;
static_assert(1u << kRootLevels == kListed);

/// Data shared by the threads of the loop. A node's number is the first place of one of its leaves.
struct LinearBuild {
  const std::uint64_t* keys;
  std::uint32_t count;
  LinearTriangle* triangles;
  LinearNode* nodes;
  LinearParents parents;
  /// Indexed by the last place before a border: the far end of the run that arrived first;
  /// initially all bits set.
  std::uint32_t* far_ends;
  std::uint64_t* lists;  ///< by the run's first place: `cluster_word`, kListed of them
};

struct alignas(16) LinearCluster {
  Box box;
  std::uint32_t child = 0;   ///< as in LinearNode
  std::uint32_t first = 0;   ///< the first of its places, which is not the number of any of its
                             ///< nodes
  std::uint32_t height = 0;  ///< 0: a leaf
};

/// Clusters to be joined, and for each pair half the surface of their common box; infinite if the
/// node would be too high.
struct LinearClusters {
  LinearCluster at[kJoined];
  float joint[kJoined][kJoined];
  std::uint32_t count = 0;
};

inline constexpr std::uint64_t kNoCluster = ~std::uint64_t{0};
RAYSHEAF_HD inline std::uint64_t cluster_word(const LinearCluster& cluster) {
  return std::uint64_t{cluster.first} << 32 | cluster.child;
}
RAYSHEAF_HD inline LinearCluster cluster_of_word(const LinearBuild& build, std::uint64_t word) {
  const auto child = static_cast<std::uint32_t>(word),
             first = static_cast<std::uint32_t>(word >> 32);
  if ((child & kLeafBit) != 0) return {leaf_box(build.triangles, first), child, first, 0};
  const LinearNode node = build.nodes[child];
  return {box_union(node.box[0], node.box[1]), child, first, node.height};
}

/// Adds the clusters of the run [first, last]: a leaf, or its list.
RAYSHEAF_HD inline void add_clusters(const LinearBuild& build, std::uint32_t first,
                                     std::uint32_t last, LinearClusters* all) {
  if (last - first < kLinearLeaf) {
    build.triangles[last].ends_leaf = 1;
    all->at[all->count++] = {leaf_box(build.triangles, first), first | kLeafBit, first, 0};
    return;
  }
  for (std::uint32_t i = 0; i < kListed && build.lists[first + i] != kNoCluster; ++i)
    all->at[all->count++] = cluster_of_word(build, build.lists[first + i]);
}

/// Half the surface of the common box.
RAYSHEAF_HD inline float surface_about(const Box& a, const Box& b) {
  const float x = greater(a.max.x, b.max.x) - lesser(a.min.x, b.min.x);
  const float y = greater(a.max.y, b.max.y) - lesser(a.min.y, b.min.y);
  const float z = greater(a.max.z, b.max.z) - lesser(a.min.z, b.min.z);
  return x * y + y * z + z * x;
}

/// Fills `joint` for the pairs of cluster `i` with those before it, up to `count`. Nodes are at
/// most `limit` high.
RAYSHEAF_HD inline void measure_pairs(std::uint32_t i, std::uint32_t count, std::uint32_t limit,
                                      LinearClusters* all) {
  const LinearCluster a = all->at[i];  // copied as a whole, in words of 16 bytes
  for (std::uint32_t j = 0; j < count; ++j) {
    const LinearCluster b = all->at[j];
    const bool fits = a.height < limit && b.height < limit;
    all->joint[i][j] = all->joint[j][i] =
        fits ? surface_about(a.box, b.box) : std::numeric_limits<float>::infinity();
  }
}

struct ClusterPair {
  std::uint32_t a = 0, b = 1;  ///< a < b
};

/// The first of the pairs with the least surface.
RAYSHEAF_HD inline ClusterPair closest_pair(const LinearClusters& all) {
  ClusterPair best;
  float least = std::numeric_limits<float>::infinity();
  for (std::uint32_t a = 0; a + 1 < all.count; ++a)
    for (std::uint32_t b = a + 1; b < all.count; ++b)
      if (all.joint[a][b] < least) {
        least = all.joint[a][b];
        best = {a, b};
      }
  return best;
}

/// Makes node `number` of two clusters; it replaces the first, and the last cluster replaces the
/// second.
RAYSHEAF_HD inline void join_pair(const LinearBuild& build, ClusterPair pair, std::uint32_t number,
                                  LinearClusters* all) {
  const LinearCluster a = all->at[pair.a], b = all->at[pair.b];
  const std::uint32_t height = 1 + (a.height > b.height ? a.height : b.height);
  build.nodes[number] = {{a.box, b.box}, {a.child, b.child}, height};
  set_parent(build.parents, a.child, 2 * number);
  set_parent(build.parents, b.child, 2 * number + 1);
  all->at[pair.a] = {box_union(a.box, b.box), number, a.first < b.first ? a.first : b.first,
                     height};
  const std::uint32_t last = --all->count;
  all->at[pair.b] = all->at[last];
  for (std::uint32_t j = 0; j < last; ++j)
    all->joint[pair.b][j] = all->joint[j][pair.b] = all->joint[last][j];
}

/// Joins clusters until `kept` are left; 1 makes the root. Returns the sum of `surface_parts` of
/// the clusters that got a parent.
RAYSHEAF_HD inline std::uint64_t join_closest(const LinearBuild& build, std::uint32_t kept,
                                              std::uint32_t limit, const Box& scene,
                                              LinearClusters* all) {
  std::uint64_t surface = 0;
  if (all->count > kept)
    for (std::uint32_t i = 1; i < all->count; ++i) measure_pairs(i, i, limit, all);
  while (all->count > kept) {
    const ClusterPair pair = closest_pair(*all);
    const LinearCluster &a = all->at[pair.a], &b = all->at[pair.b];
    surface += surface_parts(a.box, scene) + surface_parts(b.box, scene);
    // The other number stays unused.
    const std::uint32_t number = a.first > b.first ? a.first : b.first;
    join_pair(build, pair, kept == 1 ? 0 : number, all);
    measure_pairs(pair.a, all->count, limit, all);
  }
  return surface;
}

/// Joins the runs [first, cut] and [cut + 1, last], which have more than kLinearLeaf triangles.
///
/// Heights: a run whose keys share b bits has clusters with a height of at most kLinearDepth -
/// kRootLevels - b, which is at least 1, because five keys differ in three bits. The keys of its
/// parts share more bits, so their heights are smaller, and two of them can be joined. This is
/// always possible while more than kListed are left: each cluster of maximum height consists of two
/// or more of the up to 2 kListed clusters, so two others are lower.
RAYSHEAF_HD inline std::uint64_t join_runs(const LinearBuild& build, std::uint32_t first,
                                           std::uint32_t cut, std::uint32_t last,
                                           const Box& scene) {
  LinearClusters all;
  add_clusters(build, first, cut, &all);
  add_clusters(build, cut + 1, last, &all);
  const int prefix = shared_prefix(build.keys, build.count, first, last);
  std::uint32_t limit = kLinearDepth - kRootLevels - static_cast<std::uint32_t>(prefix);
  std::uint64_t surface = join_closest(build, kListed, limit, scene, &all);
  if (last - first + 1 == build.count) {
    for (std::uint32_t kept = kListed / 2; kept > 0; kept /= 2)
      surface += join_closest(build, kept, ++limit, scene, &all);
    return surface;
  }
  for (std::uint32_t i = 0; i < kListed; ++i)
    build.lists[first + i] = i < all.count ? cluster_word(all.at[i]) : kNoCluster;
  return surface;
}

/// Joins runs from the triangle at `place` upwards, until a run waits for its neighbour; for more
/// than kLinearLeaf triangles. Returns the sum of `surface_parts` of the computed boxes.
RAYSHEAF_HD inline std::uint64_t grow_run(const LinearBuild& build, std::uint32_t place,
                                          const Box& scene) {
  std::uint64_t surface = 0;
  for (std::uint32_t first = place, last = place;;) {
    const std::int64_t before = first, after = last;
    const bool goes_on = shared_prefix(build.keys, build.count, after, after + 1) >
                         shared_prefix(build.keys, build.count, before, before - 1);
    const std::uint32_t cut = goes_on ? last : first - 1;
    const std::uint32_t other = exchange_at(&build.far_ends[cut], goes_on ? first : last);
    if (other == kInvalidId) return surface;
    (goes_on ? last : first) = other;
    if (last - first >= kLinearLeaf) surface += join_runs(build, first, cut, last, scene);
    if (last - first + 1 == build.count) return surface;
  }
}

}  // namespace raysheaf
