// The queries of a device as loops over rays. For sources that include a device.
#pragma once

#include <type_traits>

#include "base/bits.h"
#include "device/brute_force_body.h"
#include "device/device_queries.h"
#include "device/level_walk_body.h"
#include "device/tree_walk_body.h"
#include "exec/device.h"
#include "object_tree/linear_tree.h"
#include "rays/ray_place_body.h"

namespace raysheaf {

/// Triangles per item of brute force: those that the threads of a block read at the same time.
inline constexpr std::uint32_t kBruteChunk = 256;
/// Fewer rays are processed in the caller's order.
inline constexpr std::size_t kFewestSorted = 4096;

/// Sums of a query's tests.
struct TestSums {
  std::uint64_t box_tests, triangle_tests;
};
/// A batch on the device, and the scene that it is tested with.
struct DeviceBatch {
  View<const Ray> rays;
  const std::uint32_t* order = nullptr;  ///< the ray of each thread; null: its own number
  Facing facing = Facing::kBoth;
  bool brute = false;
  TriangleList list;
  LinearTreeView tree;  ///< of triangles, or of `instances`
  const SharedBox* scene = nullptr;
  const DeviceInstance* instances = nullptr;
  HitFilter filter;            ///< its arrays are on the device
  TestSums* sums = nullptr;    ///< null: nothing is counted
  float* ray_tests = nullptr;  ///< receives the tests of each ray, or null

  [[nodiscard]] RAYSHEAF_HD std::size_t ray_at(std::size_t i) const {
    return order != nullptr ? order[i] : i;
  }
};

/// The trees that a ray meets.
template <class Trees>
RAYSHEAF_HD Trees trees_of(const DeviceBatch& batch, std::size_t ray) {
  const auto number = static_cast<std::uint32_t>(ray);
  const Box scene = box_of(*batch.scene);
  if constexpr (std::is_same_v<Trees, InstanceTrees>)
    return {batch.tree, scene, batch.instances, batch.filter.choice, number};
  else
    return {batch.tree, scene, batch.facing, batch.filter, number};
}

[[nodiscard]] RAYSHEAF_HD inline ListFilter filter_of(const DeviceBatch& batch, std::size_t ray) {
  return {batch.facing, batch.filter, static_cast<std::uint32_t>(ray)};
}

/// Stores the counts of a ray's traversal.
RAYSHEAF_HD inline void keep_counts(const DeviceBatch& batch, std::size_t ray,
                                    const WalkCounts& counts) {
  if (batch.ray_tests != nullptr)
    batch.ray_tests[ray] = static_cast<float>(counts.box_tests + counts.triangle_tests);
  if (batch.sums == nullptr) return;
  add_to_common(&batch.sums->box_tests, counts.box_tests);
  add_to_common(&batch.sums->triangle_tests, counts.triangle_tests);
}

/// Calls `take(hit)` for every hit of a ray.
template <class Trees, class Take>
RAYSHEAF_HD void meet_all(const DeviceBatch& batch, std::size_t number, const Take& take) {
  WalkCounts counts;
  const Ray ray = batch.rays.data[number];
  if constexpr (std::is_same_v<Trees, TriangleTree>) {
    if (batch.brute) {
      const auto end = static_cast<std::uint32_t>(batch.list.corners.size / 3);
      meet_list(batch.list, 0, end, filter_of(batch, number), make_ray_setup(ray), take);
      return keep_counts(batch, number, counts);
    }
  }
  all_in_tree(trees_of<Trees>(batch, number), ray, &counts, take);
  keep_counts(batch, number, counts);
}

/// Bits per axis of the sort keys of a batch's rays, so that a key fits into a word.
inline constexpr std::uint32_t kBatchKeyAxisBits = 6;
inline constexpr std::uint32_t kBatchKeyBits = 5 * kBatchKeyAxisBits;

/// Sorts the batch's rays along the curve; `columns` holds the order.
template <class Device>
void order_rays_on(Device& device, SortColumns<std::uint32_t>* columns, DeviceBatch* batch) {
  const View<const Ray> rays = batch->rays;
  if (rays.size < kFewestSorted || batch->scene == nullptr) return;
  columns->resize_uninitialized("order: keys", rays.size, true);
  std::uint32_t* const keys = columns->keys.data();
  std::uint32_t* const numbers = columns->values.data();
  const SharedBox* const scene = batch->scene;
  device.for_each("order: keys", rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    keys[i] =
        static_cast<std::uint32_t>(ray_place(rays.data[i], box_of(*scene), kBatchKeyAxisBits));
    numbers[i] = static_cast<std::uint32_t>(i);
  });
  device.sort_pairs("order: sort", columns, {0, kBatchKeyBits});
  batch->order = columns->values.data();
}

/// Adds the counts of a second traversal of a ray.
RAYSHEAF_HD inline void keep_more_counts(const DeviceBatch& batch, std::size_t ray,
                                         const WalkCounts& counts) {
  const float before = batch.ray_tests != nullptr ? batch.ray_tests[ray] : 0;
  keep_counts(batch, ray, counts);
  if (batch.ray_tests != nullptr) batch.ray_tests[ray] += before;
}

// First all rays are traced in binary32 only. Then binary64 decides the remaining candidates,
// triangle by triangle. The few rays that are still unsettled are traced again with the complete
// test. Intermediate results are stored where the answer will be.

/// In place of a hit's triangle: the ray is unsettled.
inline constexpr std::uint32_t kUnsettledPlace = kInvalidId - 1;
RAYSHEAF_HD inline std::uint32_t& triangle_of(IndexedHit& hit) {
  return hit.triangle;
}
RAYSHEAF_HD inline std::uint32_t& triangle_of(Hit& hit) {
  return hit.prim_id;
}

/// The places that a walk leaves to binary64, where the ray's hit will be.
RAYSHEAF_HD inline IndexedHit packed(const FloatWalk<TriangleTree::Place>& walk) {
  return {bits_float(walk.first.triangle), bits_float(walk.second.triangle), 0,
          walk.place.triangle};
}
RAYSHEAF_HD inline Hit packed(const FloatWalk<InstanceTrees::Place>& walk) {
  return {bits_float(walk.first.instance),
          bits_float(walk.first.triangle),
          bits_float(walk.second.instance),
          walk.place.triangle,
          walk.place.instance,
          walk.second.triangle};
}
/// The one with number `k`, of three.
RAYSHEAF_HD inline TriangleTree::Place unpacked(const IndexedHit& left, int k) {
  return {k == 0 ? float_bits(left.t) : k == 1 ? float_bits(left.u) : left.triangle};
}
RAYSHEAF_HD inline InstanceTrees::Place unpacked(const Hit& left, int k) {
  if (k == 0) return {float_bits(left.t), float_bits(left.u)};
  if (k == 1) return {float_bits(left.v), left.inst_id};
  return {left.geom_id, left.prim_id};
}
/// The places for which binary32 could not tell whether there is any hit.
template <class Trees>
struct AnyCandidates {
  typename Trees::Place first, second;
};

/// In place of a flag: the ray is unsettled, or has candidates.
inline constexpr std::uint8_t kUnsettledFlag = 2, kCandidatesFlag = 3;

template <class Trees, class Device>
void closest_hits_on(Device& device, const DeviceBatch& batch, typename Trees::Found* hits) {
  device.for_each("trace: closest hits", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t ray = batch.ray_at(i);
    WalkCounts counts;
    const auto walk = closest_in_floats(trees_of<Trees>(batch, ray), batch.rays.data[ray], &counts);
    typename Trees::Found left = packed(walk);
    if (walk.unsure) triangle_of(left) = kUnsettledPlace;
    hits[ray] = left;
    keep_counts(batch, ray, counts);
  });
  device.for_each("trace: values", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    typename Trees::Found left = hits[i], best;
    if (triangle_of(left) == kUnsettledPlace) return;
    const Ray ray = batch.rays.data[i];
    const Trees trees = trees_of<Trees>(batch, i);
    bool sure = true;
    RAYSHEAF_ROLLED
    for (int k = 0; k < 3; ++k)
      sure = meet_in_doubles(trees, unpacked(left, k), ray, &best) && sure;
    if (!sure) triangle_of(best) = kUnsettledPlace;
    hits[i] = best;
  });
  device.for_each("trace: unsettled", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (triangle_of(hits[i]) != kUnsettledPlace) return;
    WalkCounts counts;
    hits[i] = closest_in_tree(trees_of<Trees>(batch, i), batch.rays.data[i], &counts);
    keep_more_counts(batch, i, counts);
  });
}

/// `candidates` has room for those of each ray.
template <class Trees, class Device>
void any_hits_on(Device& device, const DeviceBatch& batch, AnyCandidates<Trees>* candidates,
                 std::uint8_t* occluded) {
  device.for_each("trace: any hits", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t ray = batch.ray_at(i);
    WalkCounts counts;
    const auto walk = any_in_floats(trees_of<Trees>(batch, ray), batch.rays.data[ray], &counts);
    std::uint8_t flag = walk.place.triangle != kInvalidId ? 1 : 0;
    if (flag == 0 && walk.first.triangle != kInvalidId) {
      flag = walk.unsure ? kUnsettledFlag : kCandidatesFlag;
      candidates[ray] = {walk.first, walk.second};
    }
    occluded[ray] = flag;
    keep_counts(batch, ray, counts);
  });
  device.for_each("trace: candidates", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (occluded[i] != kCandidatesFlag) return;
    const Ray ray = batch.rays.data[i];
    const AnyCandidates<Trees> places = candidates[i];
    const Trees trees = trees_of<Trees>(batch, i);
    typename Trees::Found best;
    bool sure = true;
    RAYSHEAF_ROLLED
    for (int k = 0; k < 2; ++k)
      sure = meet_in_doubles(trees, k == 0 ? places.first : places.second, ray, &best) && sure;
    const bool met = triangle_of(best) != kInvalidId;
    occluded[i] = met ? 1 : sure ? 0 : kUnsettledFlag;
  });
  device.for_each("trace: unsettled", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (occluded[i] != kUnsettledFlag) return;
    WalkCounts counts;
    const bool met = any_in_tree(trees_of<Trees>(batch, i), batch.rays.data[i], &counts);
    occluded[i] = met ? 1 : 0;
    keep_more_counts(batch, i, counts);
  });
}

template <class Trees, class Device>
void hit_counts_on(Device& device, const DeviceBatch& batch, std::uint32_t* hits) {
  device.for_each("trace: number of hits", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t ray = batch.ray_at(i);
    std::uint32_t found = 0;
    meet_all<Trees>(batch, ray, [&](const typename Trees::Found&) { ++found; });
    hits[ray] = found;
  });
}

/// Row i goes to hits[offsets[i]] and following, sorted.
template <class Trees, class Device>
void hit_rows_on(Device& device, const DeviceBatch& batch, const std::uint64_t* offsets,
                 typename Trees::Found* hits) {
  device.for_each("trace: all hits", batch.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t ray = batch.ray_at(i);
    typename Trees::Found* const row = hits + offsets[ray];
    std::uint64_t found = 0;
    meet_all<Trees>(batch, ray, [&](const typename Trees::Found& hit) { row[found++] = hit; });
    sort_row(row, found);
  });
}

/// The best hits among all triangles as words. An item is a ray and a chunk of the triangles;
/// neighbouring threads have neighbouring rays.
template <class Device>
void brute_force_on(Device& device, const DeviceBatch& batch, View<std::uint64_t> words) {
  device.fill("trace: brute force", words, 0xff);
  const std::size_t rays = batch.rays.size;
  const std::uint32_t triangles = batch.list.count();
  const std::size_t chunks = div_ceil(triangles, kBruteChunk);
  device.for_each("trace: brute force", rays * chunks, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t ray = i % rays;
    const auto first = static_cast<std::uint32_t>(i / rays) * kBruteChunk;
    const std::uint32_t end = triangles - first < kBruteChunk ? triangles : first + kBruteChunk;
    const std::uint64_t best =
        best_of_list(batch.list, first, end, filter_of(batch, ray), batch.rays.data[ray]);
    lower_to(&words.data[ray], best);
  });
}

template <class Device>
void hits_of_words_on(Device& device, const DeviceBatch& batch, View<const std::uint64_t> words,
                      IndexedHit* hits) {
  device.for_each("trace: hits of words", words.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    hits[i] = hit_of_word(batch.list, words.data[i], batch.rays.data[i]);
  });
}

/// The run of a triangle: the last that begins at or before it.
RAYSHEAF_HD inline std::uint32_t run_of_triangle(const RunName* names, std::uint32_t count,
                                                 std::uint32_t triangle) {
  std::uint32_t first = 0;
  while (count > 1) {
    const std::uint32_t half = count / 2;
    if (names[first + half].first <= triangle) first += half;
    count -= half;
  }
  return first;
}

RAYSHEAF_HD inline Hit named_hit(View<const RunName> names, const IndexedHit& hit) {
  if (hit.triangle == kInvalidId) return {};
  const auto count = static_cast<std::uint32_t>(names.size);
  const RunName run = names.data[run_of_triangle(names.data, count, hit.triangle)];
  return {hit.t, hit.u, hit.v, hit.triangle - run.first, run.geom_id, run.inst_id};
}

template <class Device>
void name_hits_on(Device& device, View<const RunName> names, View<const IndexedHit> hits,
                  Hit* out) {
  device.for_each("trace: names", hits.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { out[i] = named_hit(names, hits.data[i]); });
}

}  // namespace raysheaf
