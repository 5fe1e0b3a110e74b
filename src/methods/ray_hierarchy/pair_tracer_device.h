// A tracer of pairs on a given type of device; for the sources that create one.
#pragma once

#include <algorithm>

#include "device/key_order_device.h"
#include "device/report_times.h"
#include "device/triangles_device.h"
#include "exec/stopwatch.h"
#include "methods/ray_hierarchy/pair_loops_device.h"

namespace raysheaf {

template <class Device>
class PairTracerOn : public PairTracer {
 public:
  /// `capacity`: of each list, at least 1; the other arguments construct the device.
  template <class... Args>
  explicit PairTracerOn(std::uint32_t capacity, Args&&... args)
      : capacity_(capacity), device_(std::forward<Args>(args)...) {}

  void set_scene(const PairScene& scene) override {
    spheres_.resize_uninitialized("hierarchy: spheres", 0);
    triangles_.set(scene.triangles);
    upload(device_, "copy: triangles", scene.meshes, &meshes_);
  }

  PairOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys, const PairQuery& query,
                    View<IndexedHit> hits) override {
    PairOutcome outcome;
    outcome.counts.tests.resize(query.levels);
    outcome.counts.hits.resize(query.levels);
    if (rays.empty()) return outcome;
    Stopwatch watch;
    check_item_count("rays", rays.size);
    device_.keep_times(query.report != nullptr);
    upload(device_, "copy: rays", rays, &given_);
    outcome.chunks = order_.sort(keys, rays.size, query.key_bits);
    rays_.resize_uninitialized("order: rays", rays.size);
    gather(device_, "order: rays", given_.view_const(), order_.order(), rays_.view());
    make_spheres();
    view_ = {rays_.view_const(),   triangles_.list(), spheres_.view_const(),
             meshes_.view_const(), query.branching,   query.facing};
    build_levels(query);
    words_.resize_uninitialized("trace: final tests", rays.size);
    device_.fill("trace: final tests", words_.view(), 0xff);
    counts_ = &outcome.counts;
    if (spheres_.size() != 0) meet_top(query);
    hits_.resize_uninitialized("trace: hits of words", rays.size);
    scatter_hits_on(device_, view_, words_.view_const(), order_.order().data, hits_.data());
    device_.copy("copy: hits", hits.data, hits_.data(), hits.size * sizeof(IndexedHit));
    device_.synchronize("hits");
    if (query.report != nullptr) {
      add_times(device_.times(), query.report);
      query.report->total_ms += watch.lap_ms();
    }
    device_.keep_times(false);
    return outcome;
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

  void build_levels(const PairQuery& query) {
    while (levels_.size() < query.levels) levels_.emplace_back(device_.allocator());
    while (lists_.size() < query.levels) lists_.emplace_back(device_.allocator());
    std::size_t count = view_.rays.size;
    for (std::uint32_t l = 0; l < query.levels; ++l) {
      count = div_ceil(count, query.branching);
      levels_[l].resize_uninitialized("hierarchy: levels", count);
      if (l == 0) {
        bound_leaves_on(device_, view_, levels_[0].view());
      } else {
        bound_level_on(device_, query.branching, levels_[l - 1].view_const(), levels_[l].view());
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

  void meet_top(const PairQuery& query) {
    const std::uint32_t top = query.levels;
    const View<const RayBound> nodes = levels_[top - 1].view_const();
    if (query.mesh_culling) {
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
  TraverseCounts* counts_ = nullptr;
};

}  // namespace raysheaf
