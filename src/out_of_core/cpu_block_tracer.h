// Traces the rays of a batch through blocks on the CPU: each block is a scene for `dual`, with the
// rays that may intersect it; the blocks of a round run in parallel.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "base/buffer.h"
#include "exec/stopwatch.h"
#include "out_of_core/block_tracer.h"
#include "out_of_core/ray_tree.h"

namespace raysheaf {

class CpuBlockTracer : public BlockTracer {
 public:
  /// `slots`: the most blocks of a round.
  CpuBlockTracer(const Executor& executor, std::uint32_t slots);
  ~CpuBlockTracer() override;

  [[nodiscard]] std::size_t most_rays() const override { return ~std::size_t{0}; }
  [[nodiscard]] std::size_t window() const override { return 1; }
  void explain(std::vector<std::string>* /*plan*/) const override {}

  void begin(const BlockBatch& batch) override;
  void find_distances(View<const Box> boxes, View<float> squared) override;
  void find_met(View<const Box> boxes, View<std::uint8_t> met) override;
  void load(View<const TracedBlock> round) override { round_ = round; }
  void trace() override;
  void collect() override {}
  BlockReport finish() override { return report_; }

 private:
  struct Slot;

  [[nodiscard]] bool is_any() const { return !batch_.occluded.empty(); }
  void resume();
  void trace_block(const TriangleBlock& block, Slot* slot);
  void take(const TracedBlock& traced, Slot* slot);
  bool take_occluded(const Slot& slot, std::size_t i);
  bool take_hit(const BlockView& block, const Slot& slot, std::size_t i);
  void refresh();

  const Executor& executor_;
  std::vector<std::unique_ptr<Slot>> slots_;
  BlockBatch batch_;
  BlockReport report_;
  std::optional<RayTree> tree_;
  View<const TracedBlock> round_;
  std::atomic<std::size_t> changed_{0};  ///< number of rays, since the tree was built
  Stopwatch watch_;
};

}  // namespace raysheaf
