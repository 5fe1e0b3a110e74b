// An engine on a given type of device; for the sources that create one.
#pragma once

#include <chrono>

#include "device/device_queries.h"
#include "device/landing_device.h"
#include "device/points_device.h"
#include "device/ray_check_device.h"
#include "device/report_times.h"
#include "device/tree_device.h"
#include "device/triangles_device.h"
#include "device/walks_device.h"

namespace raysheaf {

template <class Device>
class DeviceQueriesOn : public DeviceQueries {
 public:
  /// The arguments construct the device.
  template <class... Args>
  explicit DeviceQueriesOn(Args&&... args) : device_(std::forward<Args>(args)...) {}

  void set_triangles(const Executor& executor, const TriangleSource& source,
                     bool same_triangles) override {
    tree_.forget(same_triangles);
    triangles_.set(executor, source);
  }
  /// As `DeviceTriangles::set`.
  template <class Put>
  void set_triangles(const Executor& executor, std::uint32_t count, const std::uint8_t* flags,
                     bool same_triangles, const Put& put) {
    tree_.forget(same_triangles);
    triangles_.set(executor, count, flags, put);
  }

  void set_names(View<const RunName> names) override {
    upload(device_, "copy: names", names, &names_);
  }

  void closest_hit(View<const Ray> rays, const DeviceQuery& query, View<IndexedHit> hits) override {
    if (rays.empty()) return;
    DeviceBatch batch = begin(rays, query, device_.is_device_memory(hits.data, "hits"));
    IndexedHit* const out = landing_on(device_, "trace: closest hits", hits, &hits_);
    find_closest(query, out, &batch);
    deliver("copy: hits", query, hits, out);
    finish(batch, query);
  }

  void closest_hit(View<const Ray> rays, const DeviceQuery& query, View<Hit> hits) override {
    if (rays.empty()) return;
    DeviceBatch batch = begin(rays, query, device_.is_device_memory(hits.data, "hits"));
    hits_.resize_uninitialized("trace: closest hits", rays.size);
    Hit* const out = landing_on(device_, "trace: names", hits, &named_);
    find_closest(query, hits_.data(), &batch);
    name_hits_on(device_, names_.view_const(), hits_.view_const(), out);
    deliver("copy: hits", query, hits, out);
    finish(batch, query);
  }

  void any_hit(View<const Ray> rays, const DeviceQuery& query,
               View<std::uint8_t> occluded) override {
    if (rays.empty()) return;
    DeviceBatch batch = begin(rays, query, device_.is_device_memory(occluded.data, "occluded"));
    std::uint8_t* const out = landing_on(device_, "trace: any hits", occluded, &occluded_);
    find_any(query, out, &batch);
    deliver("copy: hits", query, occluded, out);
    finish(batch, query);
  }

  void count_hits(View<const Ray> rays, const DeviceQuery& query,
                  View<std::uint32_t> counts) override {
    if (rays.empty()) return;
    DeviceBatch batch = begin(rays, query, device_.is_device_memory(counts.data, "counts"));
    std::uint32_t* const out = landing_on(device_, "trace: number of hits", counts, &counts_);
    if (!query.brute && !query.in_order) order_rays_on(device_, &columns_, &batch);
    hit_counts_on(device_, batch, out);
    deliver("copy: hits", query, counts, out);
    finish(batch, query);
  }

  [[nodiscard]] DeviceHitRows all_hits(View<const Ray> rays, const DeviceQuery& query) override {
    DeviceHitRows rows;
    rows.offsets.assign(rays.size + 1, 0);
    if (rays.empty()) return rows;
    DeviceBatch batch = begin(rays, query, false);
    if (!query.brute && !query.in_order) order_rays_on(device_, &columns_, &batch);
    counts_.resize_uninitialized("trace: number of hits", rays.size);
    hit_counts_on(device_, batch, counts_.data());
    TestSums* const sums = std::exchange(batch.sums, nullptr);  // do not count the second pass
    offsets_.resize_uninitialized("trace: offsets", rays.size + 1);
    device_.exclusive_scan("trace: offsets", counts_.view_const(), offsets_.view());
    device_.copy("copy: offsets", rows.offsets.data(), offsets_.data(),
                 rows.offsets.size() * sizeof rows.offsets[0]);
    device_.synchronize("copy: offsets");
    rows.hits.resize(rows.offsets.back());
    hits_.resize_uninitialized("trace: all hits", rows.hits.size());
    hit_rows_on(device_, batch, offsets_.data(), hits_.data());
    deliver("copy: hits", query, View<IndexedHit>(rows.hits), hits_.data());
    batch.sums = sums;
    finish(batch, query);
    return rows;
  }

  void nearest(const DevicePoints& points, std::uint32_t k, const DeviceQuery& query,
               View<ClosestPoint> found) override {
    if (points.count == 0) return;
    begin(points, query, device_.is_device_memory(found.data, "found"));
    points_.nearest(query.executor, names_.view_const(), k, found);
    finish(query);
  }
  void signed_distance(const DevicePoints& points, const DeviceQuery& query,
                       View<double> distances) override {
    if (points.count == 0) return;
    begin(points, query, device_.is_device_memory(distances.data, "distances"));
    points_.signed_distance(query.executor, query.rule, query.closed, distances);
    finish(query);
  }
  void contains(const DevicePoints& points, const DeviceQuery& query,
                View<std::uint8_t> inside) override {
    if (points.count == 0) return;
    begin(points, query, device_.is_device_memory(inside.data, "inside"));
    points_.contains(query.executor, query.rule, query.closed, inside);
    finish(query);
  }

  [[nodiscard]] double keys_to_hits_ms(View<const Ray> rays, const DeviceQuery& asked,
                                       bool any) override {
    if (rays.empty()) return 0;
    DeviceQuery query = asked;
    query.report = nullptr;
    DeviceBatch batch = begin(rays, query, false);
    hits_.resize_uninitialized("trace: closest hits", any ? 0 : rays.size);
    occluded_.resize_uninitialized("trace: any hits", any ? rays.size : 0);
    device_.start_clock("keys to hits");
    any ? find_any(query, occluded_.data(), &batch) : find_closest(query, hits_.data(), &batch);
    const double ms = device_.stop_clock("keys to hits");
    finish(batch, query);
    return ms;
  }

  /// For callers that use the device and its triangles for other work.
  [[nodiscard]] Device& device() { return device_; }
  [[nodiscard]] TriangleList triangles() const { return triangles_.list(); }
  /// The same ones, which are to be moved.
  [[nodiscard]] DeviceTriangles<Device>& moving_triangles() {
    tree_.forget(true);
    return triangles_;
  }

  [[nodiscard]] const std::vector<StageTime>& stage_times() const override { return times_; }

  [[nodiscard]] std::size_t memory_bytes() const override {
    return triangles_.memory_bytes() + tree_.memory_bytes() + rays_.capacity_bytes() +
           columns_.capacity_bytes() + words_.capacity_bytes() + hits_.capacity_bytes() +
           occluded_.capacity_bytes() + counts_.capacity_bytes() + offsets_.capacity_bytes() +
           points_.memory_bytes() + names_.capacity_bytes() + named_.capacity_bytes() +
           ray_tests_.capacity_bytes() + sums_.capacity_bytes() + first_wrong_.capacity_bytes();
  }

  /// Public only because nvcc requires it for device loops.
  void mark_found(View<const std::uint64_t> words, std::uint8_t* occluded) {
    device_.for_each("trace: found", words.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
      occluded[i] = words.data[i] != kNoHitWord ? 1 : 0;
    });
  }

 private:
  using Clock = std::chrono::steady_clock;

  void find_closest(const DeviceQuery& query, IndexedHit* out, DeviceBatch* batch) {
    if (query.brute) {
      words_.resize_uninitialized("trace: brute force", batch->rays.size);
      brute_force_on(device_, *batch, words_.view());
      hits_of_words_on(device_, *batch, words_.view_const(), out);
    } else {
      if (!query.in_order) order_rays_on(device_, &columns_, batch);
      closest_hits_on(device_, *batch, out);
    }
  }

  void find_any(const DeviceQuery& query, std::uint8_t* out, DeviceBatch* batch) {
    if (query.brute) {
      words_.resize_uninitialized("trace: brute force", batch->rays.size);
      brute_force_on(device_, *batch, words_.view());
      mark_found(words_.view_const(), out);
    } else {
      if (!query.in_order) order_rays_on(device_, &columns_, batch);
      words_.resize_uninitialized("trace: any hits", batch->rays.size);
      any_hits_on(device_, *batch, words_.data(), out);
    }
  }

  /// The beginning of every query. `is_there`: items or answers are in the device's memory.
  void begin(const char* items, std::size_t count, const DeviceQuery& query, bool is_there) {
    check_item_count(items, count);
    start_ = Clock::now();
    device_.keep_times(query.report != nullptr);
    if (is_there || query.stream != nullptr || query.results_stream != nullptr)
      wait_for_streams(device_, query);
  }
  /// Sets the triangles, and the tree if the query needs one.
  template <class Batch>
  void set_scene(const DeviceQuery& query, Batch* batch) {
    batch->brute = query.brute;
    batch->list = triangles_.list();
    work_ = query.brute ? TreeWork::kKeep : tree_.prepare(batch->list);
    batch->tree = tree_.view();
    batch->scene = tree_.scene();
  }

  DeviceBatch begin(View<const Ray> rays, const DeviceQuery& query, bool out_is_there) {
    const bool rays_are_there = device_.is_device_memory(rays.data, "rays");
    begin("rays", rays.size, query, rays_are_there || out_is_there);
    if (!rays_are_there) {
      rays_.resize_uninitialized("copy: rays", rays.size);
      uplink_.copy("copy: rays", query.executor, rays, rays_.view());
      rays = rays_.view_const();
    }
    if (query.check) check_rays_on(device_, rays, &first_wrong_);
    DeviceBatch batch;
    batch.rays = rays;
    batch.facing = query.facing;
    set_scene(query, &batch);
    if (query.count && query.report != nullptr && !query.brute) {
      sums_.resize_uninitialized("count", 1);
      device_.fill("count", sums_.view(), 0);
      batch.sums = sums_.data();
    }
    if (!query.ray_tests.empty() && !query.brute)
      batch.ray_tests = landing_on(device_, "count", query.ray_tests, &ray_tests_);
    return batch;
  }
  void begin(const DevicePoints& points, const DeviceQuery& query, bool out_is_there) {
    begin("points", points.count, query, points.rows.data != nullptr || out_is_there);
    PointBatch batch;
    set_scene(query, &batch);
    points_.begin(query.executor, points, batch);
  }

  template <class T>
  void deliver(const char* stage, const DeviceQuery& query, View<T> out, const T* from) {
    if (out.data != from) downlink_.copy(stage, query.executor, from, out);
  }

  void finish(const DeviceBatch& batch, const DeviceQuery& query) {
    if (batch.ray_tests != nullptr) {
      deliver("copy: tests of rays", query, query.ray_tests, batch.ray_tests);
    } else {
      std::fill(query.ray_tests.begin(), query.ray_tests.end(),
                static_cast<float>(batch.list.count()));
    }
    device_.synchronize("hits");
    if (batch.sums != nullptr) {
      const TestSums sums = device_.read("count", batch.sums);
      query.report->ray_bound_tests += sums.box_tests;
      query.report->triangle_tests += sums.triangle_tests;
    }
    if (query.count && query.brute && query.report != nullptr)
      query.report->triangle_tests += std::uint64_t{batch.rays.size} * batch.list.count();
    finish(query, "rays", batch.order != nullptr, "one thread per ray");
  }
  void finish(const DeviceQuery& query) {
    device_.synchronize("points");
    finish(query, "points", points_.is_sorted(), "one thread a point");
  }
  /// The end of every query.
  void finish(const DeviceQuery& query, const std::string& items, bool sorted,
              const char* threads) {
    if (!query.brute) tree_.learn_cost();
    if (query.report == nullptr) return;
    QueryReport& report = *query.report;
    report.used_tree = !query.brute;
    report.tree = work_;
    times_ = device_.times();
    device_.keep_times(false);
    add_times(times_, &report);
    report.total_ms += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    if (!query.explain) return;
    report.plan.push_back(query.brute ? kByBruteForce : sentence_of(work_));
    if (query.brute) return;
    std::string order = "sorted along a curve";
    if (!sorted)
      order = query.in_order ? "pixel by pixel, as they come"
                             : "as they come, fewer than " + std::to_string(kFewestSorted);
    report.plan.push_back(items + ": " + order + "; " + threads);
  }

  Device device_;
  DeviceAllocator& memory_ = device_.allocator();
  DeviceTriangles<Device> triangles_{device_};
  BulkUplink<Device> uplink_{device_};  ///< for rays
  BulkDownlink<Device> downlink_{device_};
  DeviceBuffer<RunName> names_{memory_};
  DeviceTree<Device> tree_{device_};
  PointsOn<Device> points_{device_};
  DeviceBuffer<Ray> rays_{memory_};
  SortColumns<std::uint32_t> columns_{memory_};
  DeviceBuffer<std::uint64_t> words_{memory_}, offsets_{memory_};
  DeviceBuffer<IndexedHit> hits_{memory_};
  DeviceBuffer<Hit> named_{memory_};
  DeviceBuffer<float> ray_tests_{memory_};
  DeviceBuffer<std::uint8_t> occluded_{memory_};
  DeviceBuffer<std::uint32_t> counts_{memory_}, first_wrong_{memory_};
  DeviceBuffer<TestSums> sums_{memory_};
  TreeWork work_ = TreeWork::kKeep;  ///< of the last query
  std::vector<StageTime> times_;
  Clock::time_point start_;
};

}  // namespace raysheaf
