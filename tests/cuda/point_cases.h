// Every device function of point queries, on random input.
#pragma once

#include "cuda/tree_cases.h"
#include "device/points_device.h"

namespace raysheaf::test {

/// A point anywhere, at a corner, or in the plane of a triangle.
RAYSHEAF_HD inline Point random_point(Draws& draws, const Vec3* corners, std::uint32_t count) {
  const Vec3* const corner = corners + 3 * draws.below(count);
  const std::uint32_t kind = draws.below(4);
  if (kind == 0) return to_point(corner[0]);
  if (kind == 1) return 0.5 * (to_point(corner[1]) + to_point(corner[2]));
  const Vec3 at = draws.in_box(5);
  const double more = double{draws.unit()} * 1e-9;
  return {at.x + more, at.y - more, double{at.z}};
}

RAYSHEAF_HD inline void put_point(Words& out, Point p) {
  out.put(p.x, p.y, p.z);
}

struct PointRowsCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    float floats[6];
    double doubles[6];
    for (int i = 0; i < 6; ++i) {
      floats[i] = (draws.unit() - 0.5f) * draws.scale();
      doubles[i] = double{floats[i]} * (draws.below(3) == 0 ? 1e-60 : 3);
    }
    NumberRows rows;
    rows.is_double = draws.below(2) == 0;
    rows.data = rows.is_double ? static_cast<const void*>(doubles) : floats;
    rows.row_stride = 3;
    const std::size_t row = draws.below(2);
    const QueryPoint point{{point_coordinate(number_at(rows, row, 0)),
                            point_coordinate(number_at(rows, row, 1)), number_at(rows, row, 2)},
                           number_at(rows, row, 1)};
    put_point(out, point.at);
    out.put(point.radius, is_right(point), is_near_enough(point.at.x * 1e18));
  }
};

struct PointTriangleCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    Vec3 corner[3];
    for (Vec3& c : corner) c = draws.in_box(3) * scale;
    if (draws.below(6) == 0) corner[2] = corner[1];
    const Point a = to_point(corner[0]), b = to_point(corner[1]), c = to_point(corner[2]);
    const double along = draws.unit();
    const Point p = double{scale} * random_point(draws, corner, 1) + along * (b - a);
    const TriangleDistance found = distance_to_triangle(p, a, b, c);
    out.put(found.squared, found.u, found.v);
    put_point(out, point_of_weights(found.u, found.v, a, b, c));
    double tau = 0;
    put_point(out, from_edge(p - a, p - b, b - a, &tau));
    put_point(out, cross(b - a, c - a));
    out.put(tau, dot(p - a, p - b), component(p, 1), clamped(tau, -0.5, 0.5));
    out.put(lesser_of(p.x, p.y), larger_of(p.x, p.y), sign_of(p.z));
    out.put(side_of_plane(p, a, b, c), exact_side_of_plane(p, a, b, c));
    out.put(side_of_line(p.x, p.y, a.x, a.y, b.x, b.y),
            exact_side_of_line(p.x, p.y, a.x, a.y, b.x, b.y),
            side_of_moved(p.x, p.y, a.x, a.y, b.x, b.y));
    out.put(sign_of_area(a.x, a.y, b.x, b.y, c.x, c.y), crossing(p, a, b, c, draws.below(2) * 3));
    ExactSum sum;
    sum.add(p.x);
    sum.add_product(p.y, b.z);
    out.put(sum.sign());
    const ClosestPoint closest = closest_point_on(p, 7, corner[0], corner[1], corner[2]);
    out.put(closest.distance, closest.point[1], closest.u, closest.v, closest.prim_id,
            closest.side);
  }
};

struct PointWalkCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const TinyTree tree(draws);
    const SharedBox scene = shared_box(tree.scene);
    PointBatch batch;
    batch.brute = draws.below(2) == 0;
    batch.list.corners = View<const Vec3>(tree.corners, 3 * TinyTree::kCount);
    batch.tree = {tree.nodes, tree.triangles, TinyTree::kCount};
    batch.scene = &scene;
    const Point p = random_point(draws, tree.corners, TinyTree::kCount);
    auto one = NearestOne(draws.between(0, 9));
    offer_triangles(batch, p, &one);
    NearTriangle room[4];
    auto some = NearestSome(1e9, room, 4);
    nearest_in_tree(batch.tree, p, &some);
    sink_near(room, 0, 2);
    some.sort();
    out.put(one.best.distance, one.best.triangle, comes_before(room[0], one.best));
    for (const NearTriangle& near : room) out.put(near.distance, near.triangle);
    const RunName names[2] = {{0, 4, 1}, {3, 4, 2}};
    const ClosestPoint named = named_point(View<const RunName>(names, 2), batch, p, room[0]);
    out.put(named.distance, named.prim_id, named.inst_id, device_point_key(p, tree.scene));
    const PointFloats floats(p);
    const int ray = shortest_ray(floats, tree.scene);
    const Crossings all = crossings_of_all(batch, p, ray), same = crossings_of(batch.tree, p, 2);
    out.put(ray, static_cast<std::uint64_t>(all.winding), static_cast<std::uint64_t>(same.number));
    out.put(may_cross(floats, tree.nodes[0].box[0], ray), box_distance(floats, tree.scene));
    out.put(point_is_inside(batch, p, InsideRule::kEvenOdd, draws.below(2) == 0),
            is_inside(all.winding, 1), static_cast<std::uint64_t>(batch.point_at(3)));
    auto limit = NearestLimit(draws.unit());
    limit.set(limit.distance * draws.scale());
    out.put(limit.most_squared, limit.reach);
    Crossings sum;
    sum.add(-1);
    NearestOne last(5);
    meet_triangle(p, 3, tree.corners[0], tree.corners[1], tree.corners[2], &last);
    last.offer({1, 2});
    out.put(last.best.distance, static_cast<std::uint64_t>(sum.number));
  }
};

}  // namespace raysheaf::test
