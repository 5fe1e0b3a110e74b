#include "out_of_core/cpu_block_tracer.h"

#include "queries/planned_queries.h"

namespace raysheaf {
namespace {

/// The tree is rebuilt after this fraction of the rays has become shorter or is done.
constexpr std::size_t kStaleDivisor = 16;

}  // namespace

/// A block that is being traced, and its working memory.
struct CpuBlockTracer::Slot {
  PlannedQueries engine;
  TriangleRun run;
  std::vector<std::uint8_t> flags;
  std::vector<std::uint32_t> places, numbers;  ///< of the rays that may intersect the block
  Buffer<Ray> rays;
  Buffer<IndexedHit> closest;
  Buffer<std::uint8_t> occluded;
  std::vector<float> tests;
  QueryReport report;

  void set_triangles(const TriangleBlock& block, Facing facing) {
    const auto count = static_cast<std::uint32_t>(block.triangles.size());
    run = {block.positions.data(), block.triangles.data(), 0, count};
    TriangleSource source;
    source.runs = {&run, 1};
    source.count = count;
    if (facing == Facing::kSkipBackOfSingleSided && !block.sides.empty()) {
      if (block.sides.size() == 1) flags.assign(count, block.sides[0]);
      source.flags = block.sides.size() == 1 ? flags.data() : block.sides.data();
    }
    engine.set_triangles(source, false);
  }
};

CpuBlockTracer::CpuBlockTracer(const Executor& executor, std::uint32_t slots)
    : executor_(executor) {
  for (std::uint32_t i = 0; i < slots; ++i) slots_.push_back(std::make_unique<Slot>());
}

CpuBlockTracer::~CpuBlockTracer() = default;

void CpuBlockTracer::begin(const BlockBatch& batch) {
  watch_.lap_ms();
  batch_ = batch;
  report_ = {};
  changed_ = 0;
  tree_.emplace(executor_, batch.rays, batch.scene);
  if (batch.resumed) resume();
  report_.cull_ms += watch_.lap_ms();
}

/// Shortens rays that hit something in an earlier run.
void CpuBlockTracer::resume() {
  executor_.for_each(tree_->size(), kWorkGrain, [&](std::size_t i) {
    const auto place = static_cast<std::uint32_t>(i);
    const std::uint32_t number = tree_->number(place);
    if (is_any() && batch_.occluded[number] != 0) tree_->finish(place);
    if (!is_any() && batch_.hits[number].block != kInvalidId)
      tree_->shorten(place, batch_.hits[number].hit.t);
  });
  tree_->refresh(executor_);
}

void CpuBlockTracer::find_distances(View<const Box> boxes, View<float> squared) {
  watch_.lap_ms();
  executor_.for_each(boxes.size, 4,
                     [&](std::size_t i) { squared[i] = tree_->squared_distance(boxes[i]); });
  report_.cull_ms += watch_.lap_ms();
}

void CpuBlockTracer::find_met(View<const Box> boxes, View<std::uint8_t> met) {
  watch_.lap_ms();
  executor_.for_each(boxes.size, 1,
                     [&](std::size_t i) { met[i] = tree_->meets(boxes[i]) ? 1 : 0; });
  report_.cull_ms += watch_.lap_ms();
}

void CpuBlockTracer::trace() {
  watch_.lap_ms();
  executor_.for_each(round_.size, 1,
                     [&](std::size_t i) { trace_block(*round_[i].block, slots_[i].get()); });
  for (std::size_t i = 0; i < round_.size; ++i) take(round_[i], slots_[i].get());
  report_.trace_ms += watch_.lap_ms();
  refresh();
  report_.cull_ms += watch_.lap_ms();
}

void CpuBlockTracer::trace_block(const TriangleBlock& block, Slot* slot) {
  const Box box = bounds_of(block);
  tree_->find(box, &slot->places);
  const std::size_t count = slot->places.size();
  slot->report = {};
  if (count == 0) return;
  slot->numbers.resize(count);
  slot->rays.resize_uninitialized(count);
  for (std::size_t i = 0; i < count; ++i) {
    slot->numbers[i] = tree_->number(slot->places[i]);
    slot->rays[i] = tree_->ray(slot->places[i]);
  }
  slot->tests.assign(batch_.ray_tests.empty() ? 0 : count, 0.0f);
  slot->set_triangles(block, batch_.facing);
  PlannedOptions options;
  options.facing = batch_.facing;
  options.count = batch_.count;
  options.ray_tests = slot->tests;
  options.whole = true;
  const RaysInPlace rays({slot->rays.data(), count});
  if (is_any()) {
    slot->occluded.resize_uninitialized(count);
    slot->engine.any_hit(executor_, rays, options, slot->occluded, &slot->report);
  } else {
    slot->closest.resize_uninitialized(count);
    const auto take = [slot](std::size_t begin, View<const IndexedHit> hits) {
      std::copy(hits.begin(), hits.end(), slot->closest.begin() + begin);
    };
    slot->engine.closest_hit(executor_, rays, options, take, &slot->report);
  }
}

/// Copies the hits of a block to the answers. A ray occurs at most once in a slot.
void CpuBlockTracer::take(const TracedBlock& traced, Slot* slot) {
  if (slot->places.empty()) ++report_.wasted_blocks;
  report_.bound_tests += slot->report.bound_tests;
  report_.ray_bound_tests += slot->report.ray_bound_tests;
  report_.triangle_tests += slot->report.triangle_tests;
  const TriangleBlock& from = *traced.block;
  const BlockView block{traced.number, View<const Vec3>(from.positions),
                        from.triangles.front().data(), View<const std::uint32_t>(from.prim_ids),
                        View<const BlockPart>(from.parts)};
  executor_.for_each_block(
      slot->places.size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
        std::size_t changed = 0;
        for (std::size_t i = begin; i < end; ++i) {
          if (!slot->tests.empty()) batch_.ray_tests[slot->numbers[i]] += slot->tests[i];
          changed += (is_any() ? take_occluded(*slot, i) : take_hit(block, *slot, i)) ? 1 : 0;
        }
        changed_ += changed;
      });
}

bool CpuBlockTracer::take_occluded(const Slot& slot, std::size_t i) {
  std::uint8_t& occluded = batch_.occluded[slot.numbers[i]];
  if (slot.occluded[i] == 0 || occluded != 0) return false;
  occluded = 1;
  tree_->finish(slot.places[i]);
  return true;
}

bool CpuBlockTracer::take_hit(const BlockView& block, const Slot& slot, std::size_t i) {
  const IndexedHit& found = slot.closest[i];
  if (found.triangle == kInvalidId) return false;
  if (!take_least(block, found, &batch_.hits[slot.numbers[i]])) return false;
  tree_->shorten(slot.places[i], found.t);
  return true;
}

void CpuBlockTracer::refresh() {
  if (changed_ == 0 || changed_ * kStaleDivisor < tree_->size()) return;
  tree_->refresh(executor_);
  changed_ = 0;
}

}  // namespace raysheaf
