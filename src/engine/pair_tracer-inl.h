// A tracer of pairs on a device of a known kind; for the sources that make one.
#pragma once

#include <algorithm>
#include <chrono>
#include <string_view>

#include "engine/pair_queries-inl.h"

namespace raysheaf {

template <class Device>
class PairTracerOn : public PairTracer {
 public:
  /// `capacity` from 1, of each list; the rest is what the device is made from.
  template <class... Args>
  explicit PairTracerOn(std::uint32_t capacity, Args&&... args)
      : capacity_(capacity),
        device_(std::forward<Args>(args)...),
        corners_(device_.allocator()),
        flags_(device_.allocator()),
        spheres_(device_.allocator()),
        meshes_(device_.allocator()),
        given_(device_.allocator()),
        rays_(device_.allocator()),
        columns_(device_.allocator()),
        keys_(device_.allocator()),
        lengths_(device_.allocator()),
        sorted_lengths_(device_.allocator()),
        order_(device_.allocator()),
        bases_(device_.allocator()),
        starts_(device_.allocator()),
        met_(device_.allocator()),
        mesh_met_(device_.allocator()),
        kept_(device_.allocator()),
        mesh_tests_(device_.allocator()),
        words_(device_.allocator()),
        hits_(device_.allocator()) {}

  void set_scene(const PairScene& scene) override {
    upload("copy: triangles", scene.corners, &corners_);
    upload("copy: triangles", scene.flags, &flags_);
    upload("copy: triangles", scene.spheres, &spheres_);
    upload("copy: triangles", scene.meshes, &meshes_);
  }

  PairOutcome trace(View<const Ray> rays, View<const std::uint32_t> keys, const PairQuery& query,
                    View<EngineHit> hits) override {
    PairOutcome outcome;
    outcome.counts.tests.resize(query.levels);
    outcome.counts.hits.resize(query.levels);
    if (rays.empty()) return outcome;
    const auto start = std::chrono::steady_clock::now();
    check_item_count("rays", rays.size);
    device_.keep_times(query.report != nullptr);
    upload("copy: rays", rays, &given_);
    order_.resize_uninitialized("order: numbers", rays.size);
    number_on(device_, order_.view());
    if (!keys.empty()) outcome.chunks = order_by_key(keys, query.key_bits);
    rays_.resize_uninitialized("order: rays", rays.size);
    gather(device_, "order: rays", given_.view_const(), order_.view_const(), rays_.view());
    view_ = {rays_.view_const(),    {corners_.view_const(), flags_.view_const()},
             spheres_.view_const(), meshes_.view_const(),
             query.branching,       query.facing};
    build_levels(query);
    words_.resize_uninitialized("trace: final tests", rays.size);
    device_.fill("trace: final tests", words_.view(), 0xff);
    counts_ = &outcome.counts;
    if (spheres_.size() != 0) meet_top(query);
    hits_.resize_uninitialized("trace: hits of words", rays.size);
    scatter_hits_on(device_, view_, words_.view_const(), order_.data(), hits_.data());
    device_.copy("copy: hits", hits.data, hits_.data(), hits.size * sizeof(EngineHit));
    device_.synchronize("hits");
    if (query.report != nullptr) report(start, query.report);
    return outcome;
  }

 private:
  using Level = DeviceBuffer<RayBound>;
  /// What has been met at a level and not gone down.
  struct List {
    explicit List(DeviceAllocator& allocator) : pairs(allocator) {}
    DeviceBuffer<NodePair> pairs;
    std::uint32_t count = 0;
  };

  template <class T>
  void upload(const char* stage, View<const T> from, DeviceBuffer<T>* to) {
    to->resize_uninitialized(stage, from.size);
    device_.copy(stage, to->data(), from.data, from.size * sizeof(T));
  }

  /// Compresses, sorts and decompresses into `order_`; returns the number of runs.
  std::uint64_t order_by_key(View<const std::uint32_t> keys, std::uint32_t key_bits) {
    upload("copy: keys", keys, &keys_);
    columns_.resize_uninitialized("order: compress", keys.size, true);
    lengths_.resize_uninitialized("order: compress", keys.size);
    const std::uint32_t runs = device_.run_lengths("order: compress", keys_.view_const(),
                                                   {columns_.keys.view(), lengths_.view()});
    bases_.resize_uninitialized("order: compress", std::size_t{runs} + 1);
    device_.exclusive_scan("order: compress", lengths_.view_const().slice(0, runs), bases_.view());
    columns_.resize_uninitialized("order: sort", runs, true);
    number_on(device_, columns_.values.view());
    device_.sort_pairs("order: sort", &columns_, {0, key_bits});
    sorted_lengths_.resize_uninitialized("order: decompress", runs);
    gather(device_, "order: decompress", lengths_.view_const(), columns_.values.view_const(),
           sorted_lengths_.view());
    starts_.resize_uninitialized("order: decompress", std::size_t{runs} + 1);
    device_.exclusive_scan("order: decompress", sorted_lengths_.view_const(), starts_.view());
    decompress_on(device_, columns_.values.view_const(), starts_.data(), bases_.data(),
                  order_.view());
    return runs;
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

  /// Tests [0, tests) of something, slice by slice, into the list of level `level`: `test(first,
  /// flags)` sets flags, `keep(first, kept, out)` writes the pairs of those that are kept.
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

  /// All pairs of a level's list go down; what they leave in the lists below stays there.
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
      // So many nodes at once that their tests with meshes fit, and those with triangles are few
      // enough to be counted.
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

  void report(std::chrono::steady_clock::time_point start, EngineReport* report) {
    for (const StageTime& time : device_.times()) {
      const std::string_view stage = time.stage;
      if (stage.starts_with("order:")) report->order_ms += time.ms;
      if (stage.starts_with("hierarchy:")) report->hierarchy_ms += time.ms;
      if (stage.starts_with("trace:")) report->trace_ms += time.ms;
    }
    device_.keep_times(false);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    report->total_ms += ms.count();
  }

  /// (node, mesh) tests at once.
  static constexpr std::uint64_t kMeshTests = 1u << 20;

  const std::uint32_t capacity_;
  Device device_;
  DeviceBuffer<Vec3> corners_;
  DeviceBuffer<std::uint8_t> flags_;
  DeviceBuffer<Sphere> spheres_;
  DeviceBuffer<PairMesh> meshes_;
  DeviceBuffer<Ray> given_, rays_;
  SortColumns<std::uint32_t> columns_;
  DeviceBuffer<std::uint32_t> keys_, lengths_, sorted_lengths_, order_;
  DeviceBuffer<std::uint64_t> bases_, starts_;
  std::vector<Level> levels_;
  std::vector<List> lists_;
  DeviceBuffer<std::uint8_t> met_, mesh_met_;
  DeviceBuffer<std::uint32_t> kept_, mesh_tests_;
  DeviceBuffer<std::uint64_t> words_;
  DeviceBuffer<EngineHit> hits_;
  PairView view_;
  TraverseCounts* counts_ = nullptr;
};

}  // namespace raysheaf
