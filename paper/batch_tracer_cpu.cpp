// Stages 3 to 6 for one batch of rays on the CPU: order, hierarchy, traverse, intersect.
#include <optional>
#include <string>
#include <utility>

#include "exec/stopwatch.h"
#include "paper/base/flat_arrays.h"
#include "paper/bundle_samples.h"
#include "paper/make_tracers.h"
#include "paper/order/ray_order.h"
#include "paper/packets/packet_traverse.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "paper/ray_hierarchy/traverse.h"

namespace raysheaf {
namespace {

class CpuBatchTracer final : public BatchTracer {
 public:
  void prepare(const Executor& executor, const FlatScene& scene) override {
    if (!arrays_) arrays_.emplace(executor, scene);
  }

  void update(const Executor& executor, const FlatScene& scene, const FlatUpdate& update) override {
    bvh_.reset();
    if (!update.same_triangles) arrays_.reset();
    if (arrays_) arrays_->move(executor, scene, View<const std::uint32_t>(update.placed_meshes));
  }

  std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                            const BatchOptions& options, BatchStatistics* statistics,
                            View<float> ray_tests, ProgressMeter* meter) override {
    prepare(executor, scene);
    StageTimes& times = statistics->times_ms;
    Stopwatch watch;
    std::vector<std::uint32_t> order =
        ray_order(executor, batch, scene.bounds, options.method, statistics);
    const bool by_packets = options.method.traversal == Traversal::kPackets;
    std::vector<Packet> packets;
    if (by_packets) {  // of their own size: `levels` and `branching` are not used
      std::vector<std::uint32_t> keys;
      if (options.method.key == RayKey::kCrsh) keys = ordered(executor, batch.keys, order);
      times.order += watch.lap_ms();
      build_tree(executor);
      packets = make_packets(executor, batch.rays, keys, batch.key_bits, kPacketRays, order);
      times.hierarchy += watch.lap_ms();
    }
    const std::vector<Ray> rays = ordered(executor, batch.rays, order);
    times.order += watch.lap_ms();

    std::vector<RayHit> best(order.size());
    std::vector<float> tests(ray_tests.empty() ? 0 : order.size());
    const Batch ordered_batch{executor, scene, rays, options, statistics, best, tests, meter};
    if (by_packets) {
      trace_packets(ordered_batch, stage_name(batch.kind, batch.bounce), packets);
    } else {
      trace_hierarchy(ordered_batch, stage_name(batch.kind, batch.bounce));
    }

    watch.lap_ms();
    std::vector<RayHit> hits(order.size());
    executor.for_each(order.size(), kCopyGrain, [&](std::size_t i) {
      hits[order[i]] = best[i];
      if (!tests.empty()) ray_tests[order[i]] += tests[i];
    });
    times.order += watch.lap_ms();
    return hits;
  }

  TreeReport take_tree_report() override { return std::exchange(tree_report_, {}); }

 private:
  /// A batch in its order.
  struct Batch {
    const Executor& executor;
    const FlatScene& scene;
    const std::vector<Ray>& rays;
    const BatchOptions& options;
    BatchStatistics* statistics;
    View<RayHit> best;
    View<float> tests;
    ProgressMeter* meter;
  };

  template <class Column>
  static std::vector<typename Column::value_type> ordered(const Executor& executor,
                                                          const Column& column,
                                                          const std::vector<std::uint32_t>& order) {
    std::vector<typename Column::value_type> taken(order.size());
    executor.for_each(order.size(), kCopyGrain,
                      [&](std::size_t i) { taken[i] = column[order[i]]; });
    return taken;
  }

  void build_tree(const Executor& executor) {
    tree_report_.add({true, TreeWork::kKeep, 0});
    if (bvh_) return;
    Stopwatch build;
    bvh_ = build_bvh(executor, arrays_->view());
    tree_report_.add({true, TreeWork::kRebuild, build.lap_ms()});
  }

  void trace_hierarchy(const Batch& batch, const std::string& stage) const {
    const MethodSettings& method = batch.options.method;
    const TriangleView triangles = arrays_->view();
    StageTimes& times = batch.statistics->times_ms;
    Stopwatch watch;
    TraverseOptions traversal;
    traversal.mesh_culling = method.mesh_culling;
    traversal.early_out = batch.options.early_out;
    traversal.facing = batch.options.facing;
    const TraverseCounts counts =
        with_bound(method.bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
          const RayHierarchy<Bound> tree = build_hierarchy<Bound>(
              batch.executor, batch.rays, batch.scene.bounds, method.branching, method.levels);
          times.hierarchy += watch.lap_ms();
          sample_bundles(batch.executor, triangles, tree, batch.rays, batch.options.bundle_samples,
                         &batch.statistics->bundles);
          watch.lap_ms();
          batch.meter->begin(stage, tree.level(tree.top()).size());
          return traverse(batch.executor, triangles, View<const FlatMesh>(batch.scene.meshes), tree,
                          batch.rays, traversal, batch.best, batch.tests, batch.meter);
        });
    counts.add_to(batch.statistics);
    // Both stages run in one pass: its wall time is divided in proportion to the threads' times.
    const double wall_ms = watch.lap_ms();
    const double sum = counts.node_seconds + counts.final_seconds;
    const double part = sum > 0 ? counts.final_seconds / sum : 0;
    times.traverse += wall_ms * (1 - part);
    times.intersect += wall_ms * part;
  }

  void trace_packets(const Batch& batch, const std::string& stage,
                     const std::vector<Packet>& packets) const {
    const TriangleView triangles = arrays_->view();
    sample_bundles(batch.executor, triangles, packets, batch.rays, batch.options.bundle_samples,
                   &batch.statistics->bundles);
    batch.meter->begin(stage, packets.size());
    PacketOptions traversal;
    traversal.early_out = batch.options.early_out;
    traversal.facing = batch.options.facing;
    const PacketCounts counts =
        traverse_packets(batch.executor, triangles, *bvh_, packets, batch.rays, traversal,
                         batch.best, batch.tests, batch.meter);
    counts.add_to(batch.statistics);
    StageTimes& times = batch.statistics->times_ms;
    times.hierarchy += 1e3 * counts.packet_seconds;
    times.traverse += 1e3 * counts.traverse_seconds;
    times.intersect += 1e3 * counts.final_seconds;
  }

  std::optional<FlatArrays> arrays_;
  std::optional<Bvh> bvh_;  ///< for `gl10`
  TreeReport tree_report_;
};

}  // namespace

std::unique_ptr<BatchTracer> make_cpu_batch_tracer() {
  return std::make_unique<CpuBatchTracer>();
}

}  // namespace raysheaf
