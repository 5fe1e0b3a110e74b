// An engine on a given type of device; for the sources that create one.
#pragma once

#include <chrono>

#include "device/device_queries.h"
#include "device/landing_device.h"
#include "device/levels_device.h"
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

  InstanceId set_instances(const Executor& executor, View<const PlacedInstance> instances,
                           View<const LevelMark> marks) override {
    return levels_.set(executor, instances, marks);
  }
  [[nodiscard]] std::uint64_t missing_triangles(
      View<const PlacedInstance> instances) const override {
    return levels_.missing_triangles(instances);
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
    Hit* const out = landing_on(device_, "trace: names", hits, &named_);
    if (query.enters) {
      order(query, &batch);
      closest_hits_on<InstanceTrees>(device_, batch, out);
    } else {
      hits_.resize_uninitialized("trace: closest hits", rays.size);
      find_closest(query, hits_.data(), &batch);
      name_hits_on(device_, names_.view_const(), hits_.view_const(), out);
    }
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
    order(query, &batch);
    query.enters ? hit_counts_on<InstanceTrees>(device_, batch, out)
                 : hit_counts_on<TriangleTree>(device_, batch, out);
    deliver("copy: hits", query, counts, out);
    finish(batch, query);
  }

  [[nodiscard]] DeviceHitRows all_hits(View<const Ray> rays, const DeviceQuery& query) override {
    return find_rows<TriangleTree>(rays, query, &hits_);
  }
  [[nodiscard]] DeviceRows<Hit> all_entered_hits(View<const Ray> rays,
                                                 const DeviceQuery& query) override {
    return find_rows<InstanceTrees>(rays, query, &named_);
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
    return triangles_.memory_bytes() + tree_.memory_bytes() + levels_.memory_bytes() +
           masks_.capacity_bytes() + skips_.capacity_bytes() + first_runs_.capacity_bytes() +
           runs_.capacity_bytes() + rays_.capacity_bytes() + columns_.capacity_bytes() +
           words_.capacity_bytes() + hits_.capacity_bytes() + occluded_.capacity_bytes() +
           counts_.capacity_bytes() + offsets_.capacity_bytes() + points_.memory_bytes() +
           names_.capacity_bytes() + named_.capacity_bytes() + ray_tests_.capacity_bytes() +
           sums_.capacity_bytes() + first_wrong_.capacity_bytes();
  }

  /// Public only because nvcc requires it for device loops.
  void mark_found(View<const std::uint64_t> words, std::uint8_t* occluded) {
    device_.for_each("trace: found", words.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
      occluded[i] = words.data[i] != kNoHitWord ? 1 : 0;
    });
  }

 private:
  using Clock = std::chrono::steady_clock;

  void order(const DeviceQuery& query, DeviceBatch* batch) {
    if (!query.brute && !query.in_order) order_rays_on(device_, &columns_, batch);
  }

  template <class Trees>
  DeviceRows<typename Trees::Found> find_rows(View<const Ray> rays, const DeviceQuery& query,
                                              DeviceBuffer<typename Trees::Found>* room) {
    DeviceRows<typename Trees::Found> rows;
    rows.offsets.assign(rays.size + 1, 0);
    if (rays.empty()) return rows;
    DeviceBatch batch = begin(rays, query, false);
    order(query, &batch);
    counts_.resize_uninitialized("trace: number of hits", rays.size);
    hit_counts_on<Trees>(device_, batch, counts_.data());
    TestSums* const sums = std::exchange(batch.sums, nullptr);  // do not count the second pass
    offsets_.resize_uninitialized("trace: offsets", rays.size + 1);
    device_.exclusive_scan("trace: offsets", counts_.view_const(), offsets_.view());
    device_.copy("copy: offsets", rows.offsets.data(), offsets_.data(),
                 rows.offsets.size() * sizeof rows.offsets[0]);
    device_.synchronize("copy: offsets");
    rows.hits.resize(rows.offsets.back());
    room->resize_uninitialized("trace: all hits", rows.hits.size());
    hit_rows_on<Trees>(device_, batch, offsets_.data(), room->data());
    deliver("copy: hits", query, View<typename Trees::Found>(rows.hits), room->data());
    batch.sums = sums;
    finish(batch, query);
    return rows;
  }

  void find_closest(const DeviceQuery& query, IndexedHit* out, DeviceBatch* batch) {
    if (query.brute) {
      words_.resize_uninitialized("trace: brute force", batch->rays.size);
      brute_force_on(device_, *batch, words_.view());
      hits_of_words_on(device_, *batch, words_.view_const(), out);
    } else {
      order(query, batch);
      closest_hits_on<TriangleTree>(device_, *batch, out);
    }
  }

  void find_any(const DeviceQuery& query, std::uint8_t* out, DeviceBatch* batch) {
    if (query.brute) {
      words_.resize_uninitialized("trace: brute force", batch->rays.size);
      brute_force_on(device_, *batch, words_.view());
      mark_found(words_.view_const(), out);
    } else {
      order(query, batch);
      query.enters ? find_any_by<InstanceTrees>(*batch, out)
                   : find_any_by<TriangleTree>(*batch, out);
    }
  }
  template <class Trees>
  void find_any_by(const DeviceBatch& batch, std::uint8_t* out) {
    using Candidates = AnyCandidates<Trees>;
    constexpr std::size_t kWords = sizeof(Candidates) / sizeof(std::uint64_t);
    words_.resize_uninitialized("trace: any hits", kWords * batch.rays.size);
    any_hits_on<Trees>(device_, batch, reinterpret_cast<Candidates*>(words_.data()), out);
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

  void set_levels(DeviceBatch* batch) {
    work_ = levels_.prepare();
    batch->tree = levels_.top().view();
    batch->scene = levels_.top().scene();
    batch->instances = levels_.instances();
  }
  /// Sends what chooses hits.
  void set_filter(const HitFilter& given, DeviceBatch* batch) {
    batch->filter = given;
    HitFilter& filter = batch->filter;
    const auto send = [&](auto* array, std::size_t count, auto* room) {
      if (*array == nullptr) return;
      upload(device_, "copy: choices", {*array, count}, room);
      *array = room->data();
    };
    send(&filter.choice.masks, batch->rays.size, &masks_);
    send(&filter.choice.skips, batch->rays.size, &skips_);
    if (filter.runs.empty()) return;
    send(&filter.first_runs, ((batch->list.count() - 1) >> filter.block_bits) + 1, &first_runs_);
    upload(device_, "copy: choices", filter.runs, &runs_);
    filter.runs = runs_.view_const();
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
    if (query.enters)
      set_levels(&batch);
    else
      set_scene(query, &batch);
    set_filter(query.filter, &batch);
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
    if (query.enters)
      levels_.learn_cost();
    else if (!query.brute)
      tree_.learn_cost();
    if (query.report == nullptr) return;
    QueryReport& report = *query.report;
    report.used_tree = !query.brute;
    report.tree = work_;
    times_ = device_.times();
    device_.keep_times(false);
    add_times(times_, &report);
    report.total_ms += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    if (!query.explain) return;
    report.plan.push_back(query.brute    ? kByBruteForce
                          : query.enters ? sentence_of_top(work_)
                                         : sentence_of(work_));
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
  DeviceLevels<Device> levels_{device_};
  DeviceBuffer<std::uint32_t> masks_{memory_}, first_runs_{memory_};  ///< of filters
  DeviceBuffer<TriangleId> skips_{memory_};
  DeviceBuffer<FilteredRun> runs_{memory_};
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
