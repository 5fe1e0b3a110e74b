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
//
// For sources that include a device.
#pragma once

#include <algorithm>

#include "device/report_times.h"
#include "device/triangles_device.h"
#include "exec/stopwatch.h"
#include "paper/order/key_order_device.h"
#include "paper/ray_hierarchy/pair_loops_device.h"
#include "render/device/device_batch_tracer.h"

namespace raysheaf {

/// Pairs that a level's list can hold.
inline constexpr std::uint32_t kPairListCapacity = 1u << 22;

/// Counts as the CPU does without early out.
template <class Device>
class PairTracerOn : public DeviceBatchTracer {
 public:
  /// `capacity`: of each list, at least 1; the other arguments construct the device.
  template <class... Args>
  explicit PairTracerOn(std::uint32_t capacity, Args&&... args)
      : capacity_(capacity), device_(std::forward<Args>(args)...) {}

  void set_scene(const Executor& /*executor*/, const FlatScene& scene,
                 const TriangleList& triangles) override {
    std::vector<PairMesh> meshes;
    for (const FlatMesh& mesh : scene.meshes)
      meshes.push_back({mesh.bound, mesh.first_triangle, mesh.triangle_count});
    spheres_.resize_uninitialized("hierarchy: spheres", 0);
    triangles_.set(triangles);
    upload(device_, "copy: triangles", View<const PairMesh>(meshes), &meshes_);
    device_.synchronize("copy: triangles");
  }

  void trace(View<const Ray> rays, View<const std::uint32_t> keys, std::uint32_t key_bits,
             const BatchOptions& options, View<IndexedHit> hits, BatchStatistics* statistics,
             QueryReport* report) override {
    const MethodSettings& method = options.method;
    LevelCounts counts;
    counts.tests.resize(method.levels);
    counts.hits.resize(method.levels);
    counts_ = &counts;
    if (!rays.empty()) {
      Stopwatch watch;
      check_item_count("rays", rays.size);
      device_.keep_times(report != nullptr);
      upload(device_, "copy: rays", rays, &given_);
      statistics->chunks += order_.sort(keys, rays.size, key_bits);
      rays_.resize_uninitialized("order: rays", rays.size);
      gather(device_, "order: rays", given_.view_const(), order_.order(), rays_.view());
      make_spheres();
      view_ = {rays_.view_const(),   triangles_.list(), spheres_.view_const(),
               meshes_.view_const(), method.branching,  options.facing};
      build_levels(method);
      words_.resize_uninitialized("trace: final tests", rays.size);
      device_.fill("trace: final tests", words_.view(), 0xff);
      if (spheres_.size() != 0) meet_top(method);
      hits_.resize_uninitialized("trace: hits of words", rays.size);
      scatter_hits_on(device_, view_, words_.view_const(), order_.order().data, hits_.data());
      device_.copy("copy: hits", hits.data, hits_.data(), hits.size * sizeof(IndexedHit));
      device_.synchronize("hits");
      if (report != nullptr) {
        add_times(device_.times(), report);
        report->total_ms += watch.lap_ms();
      }
      device_.keep_times(false);
    }
    counts.add_to(statistics);
  }

 private:
  using Level = DeviceBuffer<RayBound>;
  /// The surviving pairs of a level that have not been processed yet.
  struct List {
    explicit List(DeviceAllocator& allocator) : pairs(allocator) {}
    DeviceBuffer<NodePair> pairs;
    std::uint32_t count = 0;
  };

  /// Called once for each scene, when rays come: its triangles have been copied.
  void make_spheres() {
    const TriangleList& list = triangles_.list();
    if (spheres_.size() == list.count()) return;
    spheres_.resize_uninitialized("hierarchy: spheres", list.count());
    spheres_on(device_, list, spheres_.view());
  }

  void build_levels(const MethodSettings& method) {
    while (levels_.size() < method.levels) levels_.emplace_back(device_.allocator());
    while (lists_.size() < method.levels) lists_.emplace_back(device_.allocator());
    std::size_t count = view_.rays.size;
    for (std::uint32_t l = 0; l < method.levels; ++l) {
      count = div_ceil(count, method.branching);
      levels_[l].resize_uninitialized("hierarchy: levels", count);
      if (l == 0) {
        bound_leaves_on(device_, view_, levels_[0].view());
      } else {
        bound_level_on(device_, method.branching, levels_[l - 1].view_const(), levels_[l].view());
      }
      lists_[l].pairs.resize_uninitialized("trace: lists", capacity_);
      lists_[l].count = 0;
    }
    met_.resize_uninitialized("trace: lists", capacity_);
    kept_.resize_uninitialized("trace: lists", capacity_);
  }

  /// Runs tests [0, tests) slice by slice, and appends the survivors to the list of level `level`:
  /// `test(first, flags)` sets flags, `keep(first, kept, out)` writes the surviving pairs.
  template <class Test, class Keep>
  void fill_list(std::uint32_t level, std::uint64_t tests, const Test& test, const Keep& keep) {
    List& list = lists_[level - 1];
    for (std::uint64_t first = 0; first < tests;) {
      const auto count = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(tests - first, capacity_ - list.count));
      test(first, met_.view().slice(0, count));
      const std::uint32_t kept =
          device_.select("trace: select", met_.view_const().slice(0, count), kept_.view());
      keep(first, kept_.view_const().slice(0, kept), list.pairs.data() + list.count);
      list.count += kept;
      counts_->tests[level - 1] += count;
      counts_->hits[level - 1] += kept;
      first += count;
      if (list.count > capacity_ / 2) descend(level);
    }
  }

  /// Processes all pairs of a level's list; survivors remain in the lists below.
  void descend(std::uint32_t level) {
    List& list = lists_[level - 1];
    const View<const NodePair> pairs = list.pairs.view_const().slice(0, list.count);
    list.count = 0;
    const std::uint64_t tests = pairs.size * std::uint64_t{view_.branching};
    if (level == 1) {
      final_tests_on(device_, view_, pairs, words_.view());
      counts_->final_tests += tests;
      return;
    }
    const View<const RayBound> nodes = levels_[level - 2].view_const();
    fill_list(
        level - 1, tests,
        [&](std::uint64_t first, View<std::uint8_t> flags) {
          test_children_on(device_, view_, pairs.data, nodes, first, flags);
        },
        [&](std::uint64_t first, View<const std::uint32_t> kept, NodePair* out) {
          keep_children_on(device_, view_.branching, pairs.data, first, kept, out);
        });
  }

  void meet_top(const MethodSettings& method) {
    const std::uint32_t top = method.levels;
    const View<const RayBound> nodes = levels_[top - 1].view_const();
    if (method.mesh_culling) {
      // Takes as many nodes at once that their tests with meshes fit, and that the number of their
      // tests with triangles can be counted.
      const std::uint64_t meshes = std::max<std::size_t>(1, meshes_.size());
      const auto group =
          static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kMeshTests / meshes, 1, nodes.size));
      for (std::uint32_t first = 0; first < nodes.size; first += group)
        meet_through_meshes(top, first,
                            std::min(group, static_cast<std::uint32_t>(nodes.size) - first));
    } else {
      meet_triangles(top, TopTests{}, nodes.size * std::uint64_t{spheres_.size()});
    }
    for (std::uint32_t level = top; level >= 1; --level) descend(level);
  }

  void meet_through_meshes(std::uint32_t top, std::uint32_t first, std::uint32_t nodes) {
    const std::size_t tests = nodes * meshes_.size();
    mesh_met_.resize_uninitialized("trace: meshes", tests);
    mesh_tests_.resize_uninitialized("trace: meshes", tests);
    test_meshes_on(device_, view_, levels_[top - 1].view_const(), first, mesh_met_.view());
    counts_->mesh_sphere_tests += tests;
    const std::uint32_t runs =
        device_.select("trace: meshes", mesh_met_.view_const(), mesh_tests_.view());
    if (runs == 0) return;
    lengths_.resize_uninitialized("trace: meshes", runs);
    const View<const std::uint32_t> kept = mesh_tests_.view_const().slice(0, runs);
    count_triangles_on(device_, view_, kept, lengths_.data());
    starts_.resize_uninitialized("trace: meshes", std::size_t{runs} + 1);
    device_.exclusive_scan("trace: meshes", lengths_.view_const(), starts_.view());
    const std::uint64_t all = device_.read("trace: meshes", starts_.data() + runs);
    meet_triangles(top, {kept, starts_.data(), first}, all);
  }

  void meet_triangles(std::uint32_t top, const TopTests& tests, std::uint64_t count) {
    const View<const RayBound> nodes = levels_[top - 1].view_const();
    fill_list(
        top, count,
        [&](std::uint64_t first, View<std::uint8_t> flags) {
          test_top_on(device_, view_, tests, nodes, first, flags);
        },
        [&](std::uint64_t first, View<const std::uint32_t> kept, NodePair* out) {
          keep_top_on(device_, view_, tests, first, kept, out);
        });
  }

  /// (node, mesh) tests at once.
  static constexpr std::uint64_t kMeshTests = 1u << 20;

  const std::uint32_t capacity_;
  Device device_;
  DeviceAllocator& memory_ = device_.allocator();
  GivenTriangles<Device> triangles_{device_};
  DeviceBuffer<Sphere> spheres_{memory_};
  DeviceBuffer<PairMesh> meshes_{memory_};
  DeviceBuffer<Ray> given_{memory_}, rays_{memory_};
  KeyOrderOn<Device> order_{device_};
  DeviceBuffer<std::uint32_t> lengths_{memory_};
  DeviceBuffer<std::uint64_t> starts_{memory_};
  std::vector<Level> levels_;
  std::vector<List> lists_;
  DeviceBuffer<std::uint8_t> met_{memory_}, mesh_met_{memory_};
  DeviceBuffer<std::uint32_t> kept_{memory_}, mesh_tests_{memory_};
  DeviceBuffer<std::uint64_t> words_{memory_};
  DeviceBuffer<IndexedHit> hits_{memory_};
  PairView view_;
  LevelCounts* counts_ = nullptr;
};

}  // namespace raysheaf
