#include "paper/ray_hierarchy/traverse.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "base/bits.h"
#include "paper/ray_hierarchy/node_test.h"
#include "paper/ray_hierarchy/work_list.h"

namespace raysheaf {

namespace {

using Clock = std::chrono::steady_clock;

/// Number of triangles of a mesh that are tested with a top node at once.
constexpr std::uint32_t kRun = 1024;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A thread's memory: a list for each level, room for survivors and for the corners of the final
/// tests.
template <std::size_t kFields>
struct Scratch {
  explicit Scratch(std::uint32_t levels) : survivors(kListCapacity + kTriangleBlock) {
    for (std::uint32_t l = 0; l < levels; ++l) lists.emplace_back(kListCapacity, l > 0);
    for (auto& corner : corners)
      for (auto& axis : corner) axis.resize(kListCapacity + kTriangleBlock);
    counts.tests.resize(levels);
    counts.hits.resize(levels);
  }

  std::vector<WorkList<kFields>> lists;  ///< [l - 1]: the triangles that a node of level l
                                         ///< intersects
  AlignedVector<std::uint32_t> survivors;
  AlignedVector<float> corners[3][3];
  TraverseCounts counts;
};

/// The walk of one thread, top node by top node.
template <class Bound>
class Walk {
 public:
  using Test = NodeTest<Bound>;
  using Fields = decltype(fields_of<Test>(TriangleView()));
  static constexpr std::size_t kFields = std::tuple_size_v<Fields>;

  Walk(const TriangleView& triangles, View<const FlatMesh> meshes, const RayHierarchy<Bound>& tree,
       View<const Ray> rays, const TraverseOptions& options, View<RayHit> best,
       View<float> ray_tests, Scratch<kFields>* scratch)
      : meshes_(meshes),
        triangles_(triangles),
        fields_(fields_of<Test>(triangles_)),
        tree_(tree),
        rays_(rays),
        options_(options),
        best_(best),
        ray_tests_(ray_tests),
        scratch_(*scratch),
        capacity_(options.early_out ? 2 * kRun : kListCapacity) {}

  void top_node(std::uint32_t node) {
    const Clock::time_point start = Clock::now();
    const double final_before = scratch_.counts.final_seconds;
    const Test test = make_node_test(tree_.level(tree_.top())[node]);
    if (options_.mesh_culling) {
      meet_meshes(node, test);
    } else {
      meet_run(node, test, 0, triangles_.count);
    }
    descend_and_clear(node);
    scratch_.counts.node_seconds +=
        seconds_since(start) - (scratch_.counts.final_seconds - final_before);
  }

 private:
  using List = WorkList<kFields>;

  void meet_meshes(std::uint32_t node, const Test& test) {
    scratch_.counts.mesh_sphere_tests += meshes_.size;
    for (const FlatMesh& mesh : meshes_) {
      if (meets_mesh(test, mesh)) meet_run(node, test, mesh.first_triangle, mesh.triangle_count);
    }
  }

  /// Tests a top node with contiguous triangles.
  void meet_run(std::uint32_t node, const Test& test, std::uint32_t first, std::uint32_t count) {
    List& list = scratch_.lists[tree_.top() - 1];
    for (std::uint32_t end = first + count; first < end; first += kRun) {
      if (is_done(node, tree_.top())) return;
      const std::uint32_t run = std::min(kRun, end - first);
      if (list.size() + run > capacity_) descend_and_clear(node);
      const Fields fields = from(fields_, first);
      const std::uint32_t met = filter(test, fields, run, scratch_.survivors.data());
      count_node(node, tree_.top(), run, run, met);
      list.append(fields, nullptr, first, scratch_.survivors.data(), met);
    }
  }

  void descend_and_clear(std::uint32_t node) {
    descend(node, tree_.top());
    scratch_.lists[tree_.top() - 1].clear();
  }

  /// Tests the node's list with its children or its rays.
  void descend(std::uint32_t node, std::uint32_t level) {
    const List& list = scratch_.lists[level - 1];
    if (list.size() == 0) return;
    if (level == 1) return final_tests(node, list);
    const std::uint32_t first = node * tree_.branching;
    const auto nodes = static_cast<std::uint32_t>(tree_.level(level - 1).size());
    const std::uint32_t end = std::min(first + tree_.branching, nodes);
    for (std::uint32_t child = first; child < end; ++child) {
      if (is_done(child, level - 1)) continue;
      meet_list(child, level - 1, list, child + 1 == end ? first + tree_.branching - child : 1);
      descend(child, level - 1);
    }
  }

  /// `times`: the factor of the counts, for missing children after the last one.
  void meet_list(std::uint32_t node, std::uint32_t level, const List& parent, std::uint32_t times) {
    List& list = scratch_.lists[level - 1];
    const Test test = make_node_test(tree_.level(level)[node]);
    const Fields fields = parent.fields();
    const std::uint32_t met = filter(test, fields, parent.size(), scratch_.survivors.data());
    count_node(node, level, parent.size(), std::uint64_t{parent.size()} * times, met);
    list.clear();
    list.append(fields, parent.ids(), 0, scratch_.survivors.data(), met);
  }

  void final_tests(std::uint32_t leaf, const List& list) {
    const Clock::time_point start = Clock::now();
    const TriangleArrays candidates = gather_corners(list);
    const std::size_t first = std::size_t{leaf} * tree_.branching;
    const std::size_t end = std::min<std::size_t>(first + tree_.branching, rays_.size);
    std::size_t tested = options_.early_out ? 0 : tree_.branching;
    for (std::size_t i = first; i < end; ++i) {
      if (stops(i)) continue;
      tested += options_.early_out ? 1 : 0;
      intersect_list(make_ray_setup(rays_[i]), candidates, options_.facing, &best_[i]);
      if (!ray_tests_.empty()) ray_tests_[i] += static_cast<float>(list.size());
    }
    scratch_.counts.final_tests += std::uint64_t{tested} * list.size();
    scratch_.counts.final_seconds += seconds_since(start);
  }

  TriangleArrays gather_corners(const List& list) {
    TriangleArrays arrays;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        float* to = scratch_.corners[k][axis].data();
        gather_floats(triangles_.vertex[k][axis], list.ids(), list.size(), to);
        arrays.vertex[k][axis] = to;
      }
    }
    arrays.ids = list.ids();
    arrays.count = list.size();
    arrays.flags = triangles_.flags;
    return arrays;
  }

  [[nodiscard]] bool stops(std::size_t ray) const {
    return options_.early_out && best_[ray].found();
  }

  /// Whether every ray under the node is done.
  [[nodiscard]] bool is_done(std::uint32_t node, std::uint32_t level) const {
    if (!options_.early_out) return false;
    const auto [first, end] = rays_under(node, level);
    for (std::size_t i = first; i < end; ++i)
      if (!stops(i)) return false;
    return true;
  }

  [[nodiscard]] std::pair<std::size_t, std::size_t> rays_under(std::uint32_t node,
                                                               std::uint32_t level) const {
    std::size_t width = 1;
    for (std::uint32_t l = 0; l < level; ++l) width *= tree_.branching;
    return {node * width, std::min(node * width + width, rays_.size)};
  }

  void count_node(std::uint32_t node, std::uint32_t level, std::uint64_t tests,
                  std::uint64_t padded, std::uint32_t hits) {
    scratch_.counts.tests[level - 1] += padded;
    scratch_.counts.hits[level - 1] += hits;
    if (ray_tests_.empty()) return;
    const auto [first, end] = rays_under(node, level);
    const float share = static_cast<float>(tests) / static_cast<float>(end - first);
    for (std::size_t i = first; i < end; ++i) ray_tests_[i] += share;
  }

  const View<const FlatMesh> meshes_;
  const TriangleView triangles_;
  const Fields fields_;
  const RayHierarchy<Bound>& tree_;
  const View<const Ray> rays_;
  const TraverseOptions& options_;
  const View<RayHit> best_;
  const View<float> ray_tests_;
  Scratch<kFields>& scratch_;
  const std::uint32_t capacity_;  // smaller if rays may be done between two descents
};

void add(const TraverseCounts& part, TraverseCounts* sum) {
  sum->mesh_sphere_tests += part.mesh_sphere_tests;
  for (std::size_t l = 0; l < sum->tests.size(); ++l) {
    sum->tests[l] += part.tests[l];
    sum->hits[l] += part.hits[l];
  }
  sum->final_tests += part.final_tests;
  sum->node_seconds += part.node_seconds;
  sum->final_seconds += part.final_seconds;
}

}  // namespace

template <class Bound>
TraverseCounts traverse(const Executor& executor, const TriangleView& triangles,
                        View<const FlatMesh> meshes, const RayHierarchy<Bound>& tree,
                        View<const Ray> rays, const TraverseOptions& options, View<RayHit> best,
                        View<float> ray_tests, ProgressMeter* meter) {
  using ThreadScratch = Scratch<Walk<Bound>::kFields>;
  oneapi::tbb::enumerable_thread_specific<std::unique_ptr<ThreadScratch>> scratches;
  executor.for_each_block(
      tree.level(tree.top()).size(), 1, [&](std::size_t begin, std::size_t end) {
        std::unique_ptr<ThreadScratch>& scratch = scratches.local();
        if (!scratch) scratch = std::make_unique<ThreadScratch>(tree.top());
        Walk<Bound> walk(triangles, meshes, tree, rays, options, best, ray_tests, scratch.get());
        for (std::size_t node = begin; node < end; ++node) {
          walk.top_node(static_cast<std::uint32_t>(node));
          meter->advance(1);
        }
      });
  TraverseCounts sum;
  sum.tests.resize(tree.top());
  sum.hits.resize(tree.top());
  for (const auto& scratch : scratches) add(scratch->counts, &sum);
  return sum;
}

#define RAYSHEAF_TRAVERSE(Bound)                                                              \
  template TraverseCounts traverse(                                                           \
      const Executor&, const TriangleView&, View<const FlatMesh>, const RayHierarchy<Bound>&, \
      View<const Ray>, const TraverseOptions&, View<RayHit>, View<float>, ProgressMeter*)
RAYSHEAF_TRAVERSE(RayBound);
RAYSHEAF_TRAVERSE(FiniteCone);
RAYSHEAF_TRAVERSE(Shaft);
RAYSHEAF_TRAVERSE(Frustum);
RAYSHEAF_TRAVERSE(ShaftCone);
#undef RAYSHEAF_TRAVERSE

}  // namespace raysheaf
