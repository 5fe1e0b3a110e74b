// Points on a device: the queries of nearest/nearest.h and nearest/inside.h as loops over points.
// For sources that include a device.
#pragma once

#include "device/device_queries.h"
#include "device/landing_device.h"
#include "device/walks_device.h"
#include "exec/atomic.h"
#include "exec/bulk_links.h"
#include "exec/device.h"
#include "nearest/closest_body.h"
#include "nearest/point_rows_body.h"
#include "nearest/point_walk_body.h"
#include "object_tree/triangle_list.h"

namespace raysheaf {

/// Points on the device, and the triangles that they are compared with.
struct PointBatch {
  View<const QueryPoint> points;
  const std::uint32_t* order = nullptr;  ///< the point of each thread; null: its own number
  bool brute = false;
  TriangleList list;
  LinearTreeView tree;
  const SharedBox* scene = nullptr;

  [[nodiscard]] RAYSHEAF_HD std::size_t point_at(std::size_t i) const {
    return order != nullptr ? order[i] : i;
  }
};

/// Packs the rows of `given`.
template <class Device>
void pack_points_on(Device& device, const DevicePoints& given, View<QueryPoint> points) {
  const NumberRows rows = given.rows, radii = given.radii;
  const double radius = given.radius;
  QueryPoint* const out = points.data;
  device.for_each("copy: points", points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out[i] = packed_point(rows, radii, radius, i);
  });
}

/// Throws for the first invalid point, which has this number among those from `first_number` on.
/// `first_wrong` is scratch memory.
template <class Device>
void check_points_on(Device& device, View<const QueryPoint> points, std::size_t first_number,
                     DeviceBuffer<std::uint32_t>* first_wrong) {
  first_wrong->resize_uninitialized("check: points", 1);
  device.fill("check: points", first_wrong->view(), 0xff);
  std::uint32_t* const first = first_wrong->data();
  device.for_each("check: points", points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    if (!is_right(points.data[i])) lower_to(first, static_cast<std::uint32_t>(i));
  });
  const std::uint32_t wrong = device.read("check: points", first);
  if (wrong == kInvalidId) return;
  const PointFault fault = fault_of(device.read("check: points", points.data + wrong));
  throw Error(ErrorCode::kInvalidData, fault.sentence,
              fault.field + ("[" + std::to_string(first_number + wrong) + "]"));
}

/// Bits of an axis of the keys by which points are sorted.
inline constexpr std::uint32_t kPointKeyAxisBits = 10;

/// A place on a Morton curve through the cube of the scene.
RAYSHEAF_HD inline std::uint32_t device_point_key(Point p, const Box& scene) {
  const Vec3 at{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  return static_cast<std::uint32_t>(
      morton_place(cube_cell(key_cube(scene), at, kPointKeyAxisBits)));
}

/// Sorts the points along the curve; `columns` holds the order.
template <class Device>
void order_points_on(Device& device, SortColumns<std::uint32_t>* columns, PointBatch* batch) {
  const View<const QueryPoint> points = batch->points;
  if (points.size < kFewestSorted) return;
  columns->resize_uninitialized("order: keys", points.size, true);
  std::uint32_t* const keys = columns->keys.data();
  std::uint32_t* const numbers = columns->values.data();
  const SharedBox* const scene = batch->scene;
  device.for_each("order: keys", points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    keys[i] = device_point_key(points.data[i].at, box_of(*scene));
    numbers[i] = static_cast<std::uint32_t>(i);
  });
  device.sort_pairs("order: sort", columns, {0, 3 * kPointKeyAxisBits});
  batch->order = columns->values.data();
}

/// Offers the triangles that may be among the nearest.
template <class Nearest>
RAYSHEAF_HD void offer_triangles(const PointBatch& batch, Point p, Nearest* nearest) {
  if (!batch.brute) return nearest_in_tree(batch.tree, p, nearest);
  const Vec3* corner = batch.list.corners.data;
  const auto count = static_cast<std::uint32_t>(batch.list.corners.size / 3);
  for (std::uint32_t t = 0; t < count; ++t, corner += 3)
    meet_triangle(p, t, corner[0], corner[1], corner[2], nearest);
}

/// The nearest triangle of each point.
template <class Device>
void nearest_on(Device& device, const PointBatch& batch, NearTriangle* found) {
  device.for_each("trace: nearest", batch.points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t number = batch.point_at(i);
    const QueryPoint point = batch.points.data[number];
    NearestOne nearest(point.radius);
    offer_triangles(batch, point.at, &nearest);
    found[number] = nearest.best;
  });
}

/// The k nearest triangles of each point, the nearest first.
template <class Device>
void some_nearest_on(Device& device, const PointBatch& batch, std::uint32_t k,
                     NearTriangle* found) {
  device.for_each("trace: nearest", batch.points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t number = batch.point_at(i);
    const QueryPoint point = batch.points.data[number];
    NearestSome nearest(point.radius, found + number * k, k);
    offer_triangles(batch, point.at, &nearest);
    nearest.sort();
  });
}

RAYSHEAF_HD inline ClosestPoint named_point(View<const RunName> names, const PointBatch& batch,
                                            Point p, const NearTriangle& found) {
  if (found.triangle == kInvalidId) return {};
  const auto count = static_cast<std::uint32_t>(names.size);
  const Vec3* const corner = batch.list.corners.data + std::size_t{3} * found.triangle;
  const RunName run = names.data[run_of_triangle(names.data, count, found.triangle)];
  ClosestPoint one =
      closest_point_on(p, found.triangle - run.first, corner[0], corner[1], corner[2]);
  one.geom_id = run.geom_id;
  one.inst_id = run.inst_id;
  return one;
}

/// `k` found for each point.
template <class Device>
void name_points_on(Device& device, const PointBatch& batch, View<const RunName> names,
                    std::uint32_t k, const NearTriangle* found, ClosestPoint* out) {
  device.for_each("trace: names", batch.points.size * k, [=] RAYSHEAF_DEVICE(std::size_t i) {
    out[i] = named_point(names, batch, batch.points.data[i / k].at, found[i]);
  });
}

RAYSHEAF_HD inline Crossings crossings_of_all(const PointBatch& batch, Point p, int ray) {
  if (!batch.brute) return crossings_of(batch.tree, p, ray);
  Crossings sum;
  const Vec3* corner = batch.list.corners.data;
  const auto count = static_cast<std::uint32_t>(batch.list.corners.size / 3);
  for (std::uint32_t t = 0; t < count; ++t, corner += 3)
    sum.add(crossing(p, to_point(corner[0]), to_point(corner[1]), to_point(corner[2]), ray));
  return sum;
}

/// `closed`: all rays from a point agree. Brute force asks all the same.
RAYSHEAF_HD inline bool point_is_inside(const PointBatch& batch, Point p, InsideRule rule,
                                        bool closed) {
  const auto count = [&](int ray) {
    const Crossings sum = crossings_of_all(batch, p, ray);
    return rule == InsideRule::kNonZero ? sum.winding : sum.number % 2;
  };
  if (closed && !batch.brute)
    return is_inside(count(shortest_ray(PointFloats(p), box_of(*batch.scene))), 1);
  std::int64_t all = 0;
  RAYSHEAF_ROLLED
  for (int ray = 0; ray < kAxisRays; ++ray) all += count(ray);
  return is_inside(all, kAxisRays);
}

template <class Device>
void inside_on(Device& device, const PointBatch& batch, InsideRule rule, bool closed,
               std::uint8_t* inside) {
  device.for_each("trace: inside", batch.points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t number = batch.point_at(i);
    inside[number] = point_is_inside(batch, batch.points.data[number].at, rule, closed) ? 1 : 0;
  });
}

/// The distances of what was found, negative inside.
template <class Device>
void sign_distances_on(Device& device, const PointBatch& batch, const NearTriangle* found,
                       const std::uint8_t* inside, double* distances) {
  device.for_each("trace: signs", batch.points.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const double distance = found[i].distance;
    distances[i] = inside[i] != 0 && distance > 0 ? -distance : distance;
  });
}

/// The memory of point queries, and their stages.
template <class Device>
class PointsOn {
 public:
  explicit PointsOn(Device& device) : device_(device) {}

  /// `batch`: without points, which are copied or packed.
  void begin(const Executor* executor, const DevicePoints& given, const PointBatch& batch) {
    batch_ = batch;
    points_.resize_uninitialized("copy: points", given.count);
    if (given.rows.data == nullptr) {
      uplink_.copy("copy: points", executor, given.packed, points_.view());
    } else {
      pack_points_on(device_, given, points_.view());
      if (given.check) check_points_on(device_, points_.view_const(), given.first, &first_wrong_);
    }
    batch_.points = points_.view_const();
    if (!batch_.brute) order_points_on(device_, &columns_, &batch_);
  }

  void nearest(const Executor* executor, View<const RunName> names, std::uint32_t k,
               View<ClosestPoint> out) {
    find(k);
    ClosestPoint* const to = landing_on(device_, "trace: names", out, &named_);
    name_points_on(device_, batch_, names, k, found_.data(), to);
    deliver(executor, to, out);
  }
  void signed_distance(const Executor* executor, InsideRule rule, bool closed, View<double> out) {
    find(1);
    inside_.resize_uninitialized("trace: inside", batch_.points.size);
    inside_on(device_, batch_, rule, closed, inside_.data());
    double* const to = landing_on(device_, "trace: signs", out, &distances_);
    sign_distances_on(device_, batch_, found_.data(), inside_.data(), to);
    deliver(executor, to, out);
  }
  void contains(const Executor* executor, InsideRule rule, bool closed, View<std::uint8_t> out) {
    std::uint8_t* const to = landing_on(device_, "trace: inside", out, &inside_);
    inside_on(device_, batch_, rule, closed, to);
    deliver(executor, to, out);
  }

  [[nodiscard]] bool is_sorted() const { return batch_.order != nullptr; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return points_.capacity_bytes() + columns_.capacity_bytes() + found_.capacity_bytes() +
           named_.capacity_bytes() + distances_.capacity_bytes() + inside_.capacity_bytes() +
           first_wrong_.capacity_bytes();
  }

 private:
  void find(std::uint32_t k) {
    found_.resize_uninitialized("trace: nearest", batch_.points.size * k);
    k == 1 ? nearest_on(device_, batch_, found_.data())
           : some_nearest_on(device_, batch_, k, found_.data());
  }
  template <class T>
  void deliver(const Executor* executor, const T* from, View<T> out) {
    if (out.data != from) downlink_.copy("copy: points", executor, from, out);
  }

  Device& device_;
  DeviceAllocator& memory_ = device_.allocator();
  BulkUplink<Device> uplink_{device_};
  BulkDownlink<Device> downlink_{device_};
  PointBatch batch_;
  DeviceBuffer<QueryPoint> points_{memory_};
  SortColumns<std::uint32_t> columns_{memory_};
  DeviceBuffer<NearTriangle> found_{memory_};
  DeviceBuffer<ClosestPoint> named_{memory_};
  DeviceBuffer<double> distances_{memory_};
  DeviceBuffer<std::uint8_t> inside_{memory_};
  DeviceBuffer<std::uint32_t> first_wrong_{memory_};
};

}  // namespace raysheaf
