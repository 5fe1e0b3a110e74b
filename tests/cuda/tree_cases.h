// One thread builds the tree along a curve and queries it.
#pragma once

#include "cuda/words.h"
#include "device/tree_walk_body.h"
#include "device/walks_device.h"
#include "geom/ray_fault.h"
#include "object_tree/linear_build_body.h"

namespace raysheaf::test {

struct TinyTree {
  static constexpr std::uint32_t kCount = 12;
  Vec3 corners[3 * kCount];
  LinearTriangle triangles[kCount];
  LinearNode nodes[kCount];
  Box scene;
  std::uint64_t surface = 0;

  RAYSHEAF_HD explicit TinyTree(Draws& draws) {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const Vec3 a = draws.in_box(4), b = draws.in_box(2), c = draws.in_box(2);
      corners[3 * i] = a;
      corners[3 * i + 1] = a + b;
      corners[3 * i + 2] = a + c;
      scene = box_union(scene, triangle_box(a, a + b, a + c));
    }
    const auto made_up = LinearKeys(kCount);
    std::uint64_t keys[kCount];
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const Vec3* const p = corners + 3 * i;
      const std::uint64_t key = linear_key(made_up, scene, triangle_box(p[0], p[1], p[2]), i);
      std::uint32_t at = i;
      for (; at > 0 && keys[at - 1] > key; --at) keys[at] = keys[at - 1];
      keys[at] = key;
    }
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const auto id = static_cast<std::uint32_t>(keys[i] & ((1u << made_up.id_bits) - 1));
      triangles[i] = {corners[3 * id], id, corners[3 * id + 1], 0, corners[3 * id + 2], 0};
    }
    std::uint32_t of_node[kCount], of_leaf[kCount], far_ends[kCount];
    std::uint64_t lists[kCount];
    for (std::uint32_t& end : far_ends) end = kInvalidId;
    const LinearBuild build{keys, kCount, triangles, nodes, {of_node, of_leaf}, far_ends, lists};
    for (std::uint32_t i = 0; i < kCount; ++i) surface += grow_run(build, i, scene);
  }
};

struct TreeCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const TinyTree tree(draws);
    DeviceBatch batch;
    batch.tree = {tree.nodes, tree.triangles, TinyTree::kCount};
    batch.list.corners = View<const Vec3>(tree.corners, 3 * TinyTree::kCount);
    batch.brute = draws.below(2) == 0;
    const SharedBox scene = shared_box(tree.scene);
    batch.scene = &scene;
    Ray ray;
    ray.origin = draws.in_box(6);
    ray.direction = lerp(tree.corners[0], tree.corners[5], draws.unit()) - ray.origin;
    batch.rays = View<const Ray>(&ray, 1);
    WalkCounts counts;
    const auto trees = trees_of<TriangleTree>(batch, 0);
    const IndexedHit hit = closest_in_tree(trees, ray, &counts);
    out.put(hit.t, hit.u, hit.v, hit.triangle, counts.box_tests, counts.triangle_tests);
    out.put(any_in_tree(trees, ray, &counts), batch.ray_at(7));
    float ends = 0;
    walk_linear_tree(
        batch.tree, [&](const Box& box, float* near) { return (*near = box.min.x) < 3; },
        [&](float near) { return near < 2; },
        [&](std::uint32_t leaf) {
          for_each_of_leaf(tree.triangles, leaf,
                           [&](const LinearTriangle& t, std::uint32_t) { ends += t.b.x; });
        });
    out.put(ends);
    IndexedHit row[TinyTree::kCount];
    std::uint32_t found = 0;
    meet_all<TriangleTree>(batch, 0, [&](const IndexedHit& one) { row[found++] = one; });
    sort_row(row, found);
    for (std::uint32_t i = 0; i < found && i < 4; ++i) out.put(row[i].t, row[i].triangle);
    keep_counts(batch, 0, counts);
    out.put(found, ray_place(ray, tree.scene, 9), box_of(scene).min, box_of(scene).max);
    const std::uint64_t word =
        best_of_list(batch.list, 0, TinyTree::kCount, filter_of(batch, 0), ray);
    const IndexedHit again = hit_of_word(batch.list, word, ray);
    out.put(word, again.t, again.triangle, stands_before(hit, row[0]), is_right(ray));
    const RunName names[3] = {{0, 4, 1}, {3, 4, 2}, {9, 5, 3}};
    const Hit named = named_hit(View<const RunName>(names, 3), hit);
    out.put(named.prim_id, named.geom_id, named.inst_id, run_of_triangle(names, 3, 8));
  }
};

/// The parts of the tree separately, at any scale.
struct RayBoxCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    Ray ray;
    ray.origin = draws.in_box(3) * scale;
    ray.direction = draws.in_box(1);
    if (draws.below(4) == 0) ray.direction.y = 0;
    if (draws.below(2) == 0) ray.t_max = draws.between(0, 3) * scale;
    const Box scene = triangle_box(draws.in_box(4) * scale, {0, 0, 0}, {scale, scale, scale});
    BoxRay boxes = make_box_ray(ray, scene);
    float near = 0;
    const bool entered = enters(boxes, scene, &near);
    out.put(entered, near + 0.0f, boxes.s_near, boxes.s_far, boxes.start);
    shorten(&boxes, draws.unit() * scale);
    Growth growth = Growth(scene);
    growth.include(boxes.along);
    const FarRay far = move_origin(long_ray(ray, scene), ray.t_min, ray.t_max, boxes.along, scene);
    const FarRay begun = far_ray(FarSpan(ray.t_min, ray.t_max, boxes.along), ray.origin, scale);
    out.put(begun.pad, begun.s_far, begun.start);
    out.put(growth.of(scale), distance_outside(ray.origin, scene), far.pad, far.s_far, far.start);
    out.put(boxes.s_far, past(1, scale), distance_per_unit(ray.direction.x / boxes.along));
    const float x = draws.between(-1, 1) * scale;
    out.put(ordered_word(x), float_of_word(ordered_word(x)), hit_word(std::fabs(x), 3));
    out.put(triangle_of_word(hit_word(std::fabs(x), draws.below(9))));
    const Box part = triangle_box(draws.in_box(1) * scale, {0, 0, 0}, {scale, 0, scale});
    out.put(surface_parts(part, box_union(part, scene)), surface_parts(scene, scene));
    const std::uint64_t keys[3] = {draws.below(9), 9, 9 + std::uint64_t{1 + draws.below(999)}};
    for (const int beyond : {-1, 2, 3}) out.put(shared_prefix(keys, 3, 0, beyond));
  }
};

/// Builds a tree bottom-up from its leaves, and a list of clusters.
struct JoinCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    TinyTree tree(draws);
    out.put(tree.surface, tree.nodes[0].height);
    for (std::uint32_t side = 0; side < 2; ++side)
      out.put(tree.nodes[0].child[side], tree.nodes[0].box[side].min, tree.nodes[0].box[side].max);
    std::uint32_t of_node[TinyTree::kCount] = {}, of_leaf[TinyTree::kCount] = {};
    std::uint64_t keys[TinyTree::kCount], lists[TinyTree::kCount] = {};
    for (std::uint32_t i = 0; i < TinyTree::kCount; ++i) keys[i] = i;
    const LinearBuild build{
        keys, TinyTree::kCount, tree.triangles, tree.nodes, {of_node, of_leaf}, nullptr, lists};
    for (LinearTriangle& triangle : tree.triangles) triangle.ends_leaf = 0;
    out.put(join_runs(build, 0, 2, 5, tree.scene), lists[0], lists[1], lists[2]);
    for (LinearTriangle& triangle : tree.triangles) triangle.ends_leaf = 1;
    LinearClusters all;
    add_clusters(build, 0, 0, &all);
    for (std::uint32_t i = 1; i < kJoined; ++i)
      all.at[all.count++] = cluster_of_word(build, cluster_word({{}, i | kLeafBit, i, 0}));
    for (std::uint32_t i = 1; i < kJoined; ++i) measure_pairs(i, i, 1, &all);
    const ClusterPair pair = closest_pair(all);
    out.put(pair.a, pair.b, all.joint[0][1], surface_about(tree.scene, all.at[2].box));
    join_pair(build, pair, pair.b, &all);
    out.put(join_closest(build, kListed, 1 + draws.below(3), tree.scene, &all));
    out.put(leaf_box(tree.triangles, kJoined).max);
    set_parent({of_node, of_leaf}, all.at[1].child, 99);
    for (std::uint32_t i = 0; i < all.count; ++i)
      out.put(all.at[i].child, all.at[i].first, all.at[i].height, all.at[i].box.max.x);
    for (std::uint32_t i = 0; i < kJoined; ++i) out.put(of_leaf[i]);
  }
};

/// Tree walks and lists with a counter.
struct MeetCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const TinyTree tree(draws);
    const TriangleTree trees{{tree.nodes, tree.triangles, TinyTree::kCount}, tree.scene};
    Ray ray;
    ray.origin = draws.in_box(6);
    ray.direction = tree.corners[draws.below(36)] - ray.origin;
    WalkCounts counts;
    std::uint32_t leaves = 0, hits = 0, all = 0, listed = 0;
    BoxRay boxes = make_box_ray(ray, tree.scene);
    const RaySetup setup = make_ray_setup(ray);
    FloatWalk<TriangleTree::Place> walk;
    for (std::uint32_t place = 0; place < TinyTree::kCount; ++place)
      if (place == 0 || tree.triangles[place - 1].ends_leaf != 0)
        meet_leaf_in_floats(trees, {place}, setup, false, &counts, &walk);
    walk.keep({draws.below(TinyTree::kCount)});
    IndexedHit decided;
    const bool sure = meet_in_doubles(trees, walk.first, ray, &decided);
    IndexedHit left = packed(walk);
    out.put(unpacked(left, 0).triangle, unpacked(left, 2).triangle, triangle_of(left));
    out.put(walk.place.triangle, walk.first.triangle, walk.unsure, walk.low, sure, decided.t,
            decided.triangle);
    out.put(lesser(walk.low, 3), greater(walk.low, 3));
    walk_tree(trees.tree, &boxes, &counts, [&](std::uint32_t place) {
      ++leaves;
      meet_leaf(trees, {place}, setup, &counts, [&](const IndexedHit&) { ++hits; });
    });
    all_in_tree(trees, ray, &counts, [&](const IndexedHit&) { ++all; });
    const TriangleList list{View<const Vec3>(tree.corners, 36), {}};
    meet_list(list, 0, TinyTree::kCount, {}, setup, [&](const IndexedHit&) { ++listed; });
    const FilteredRun runs[2] = {{0, 3, 5, kAllWorlds, false}, {7, 4, 2, 1, true}};
    const std::uint32_t first_runs[1] = {0};
    HitFilter filter{{}, View<const FilteredRun>(runs, 2), first_runs, 9};
    filter.choice.mask = 4;
    const std::uint32_t some = draws.below(TinyTree::kCount);
    out.put(filter.lets(0, some, true), filter.takes(0, some, false), filter.run_of(some).inst_id);
    out.put(filter.choice.sees(0, 2, 7), filter.choice.worlds.meet(0, 3));
    out.put(leaves, hits, all, listed, counts.box_tests, counts.triangle_tests);
    out.put(ray);
  }
};

/// Instances of one mesh under a tree over their boxes, entered and met where they stand.
struct LevelCase {
  static constexpr std::uint32_t kInstances = 3;

  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const TinyTree tree(draws);
    const SharedBox bounds = shared_box(tree.scene);
    const DeviceMesh mesh{{tree.nodes, tree.triangles, TinyTree::kCount}, &bounds};
    DeviceInstance instances[kInstances];
    LinearTriangle boxes[kInstances];
    Box scene;
    for (std::uint32_t i = 0; i < kInstances; ++i) {
      Affine map = draws.map();
      for (int axis = 0; axis < 3; ++axis) map.m[axis][axis] += 5;
      instances[i] = make_instance(map, mesh, {0, 4, i, 1 + i});
      const Box box = world_box(instances[i]);
      boxes[i] = {box.min, i, box.max, 0, box.max, i + 1 == kInstances ? 1u : 0u};
      scene = box_union(scene, box);
    }
    const LinearTreeView top{nullptr, boxes, kInstances};
    const std::uint32_t place = draws.below(TinyTree::kCount);
    Ray ray;
    ray.origin = draws.in_box(40);
    const InstanceTrees trees{top, scene, instances, {}, 0};
    const LinearTriangle aim = trees.triangle_at({draws.below(kInstances), place});
    ray.direction = lerp(aim.a, aim.b, 0.4f) - ray.origin;
    WalkCounts counts;
    const Hit hit = closest_in_tree(trees, ray, &counts);
    out.put(hit.t, hit.u, hit.v, hit.prim_id, hit.geom_id, hit.inst_id);
    out.put(any_in_tree(trees, ray, &counts), counts.box_tests, counts.triangle_tests);
    const auto walk = closest_in_floats(trees, ray, &counts);
    Hit left = packed(walk), best;
    for (int k = 0; k < 3; ++k) out.put(meet_in_doubles(trees, unpacked(left, k), ray, &best));
    out.put(best.t, triangle_of(best), stands_before(best, hit), is_before(hit, best));
    out.put(any_in_floats(trees, ray, &counts).place.triangle);
    std::uint32_t all = 0;
    all_in_tree(trees, ray, &counts, [&](const Hit&) { ++all; });
    auto way = InstanceTrees::Walk(trees, ray);
    std::uint32_t sum = 0;
    way.run(&counts, [&](InstanceTrees::Place first) {
      trees.for_each_in_leaf(first, [&](InstanceTrees::Place at, const LinearTriangle& t) {
        if (trees.counts(at, t, true)) sum += trees.named(at, t, {}).prim_id;
      });
      way.shorten_to(ray.t_max);
    });
    LinearTreeView below = top;
    out.put(sum, way.descend(0, &below), below.count);
    way.ascend();
    HitChoice choice;
    choice.sides = Sides::kFront;
    out.put(all, choice.mask_of(0), choice.takes(0, {1, 2}, true, draws.below(2) == 0));
    const Placing placing = instances[0].placing;
    const LongRay inside = in_mesh(placing, ray);
    BoxRay entered{};
    out.put(placing.to_mesh(0, 1, 2, 3), placing.ray_error(1));
    out.put(move_into(inside, 0, ray.t_max, tree.scene, &entered), entered.s_far, entered.start);
    aim_and_put(placing, tree.scene, &entered, out);
  }
  RAYSHEAF_HD static void aim_and_put(const Placing& placing, const Box& box, BoxRay* entered,
                                      Words& out) {
    aim(box.min, {1, 0.5f, -0.2f}, 0.1f, box, entered);
    out.put(entered->from_low, entered->per, placing.drift, placing.stretch);
    double a[3][3];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) a[r][c] = placing.map.m[r][c];
    const double error[3] = {placing_error(placing.map, abs(box.max), 0), 0, 0};
    Placing again = make_placing(placing.map, box);
    bound_distances(a, error, &again);
    out.put(again.least_gap, placed_box(again, box).max, root_of({nullptr, nullptr, 4}));
  }
};

}  // namespace raysheaf::test
