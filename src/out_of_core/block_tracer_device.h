// A tracer of blocks on a given type of device; for the sources that create one.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "exec/links.h"
#include "out_of_core/block_rays_device.h"
#include "out_of_core/block_tracer.h"
#include "out_of_core/block_upload.h"

namespace raysheaf {

/// The tree is rebuilt after 1 / kStaleRays of the rays have become shorter or are done.
inline constexpr std::size_t kStaleRays = 16;

template <class Device>
class BlockTracerOn : public BlockTracer {
 public:
  /// The arguments after the first two construct the device.
  template <class... Args>
  BlockTracerOn(const Executor& executor, const BlockLimits& limits, Args&&... args)
      : executor_(executor), device_(std::forward<Args>(args)...) {
    const BlockBudget budget = budget_for(limits, device_.free_bytes());
    most_rays_ = budget.rays;
    for (std::uint32_t i = 0; i < budget.buffers; ++i)
      lanes_.push_back(std::make_unique<Lane>(device_, most_upload_bytes(limits.most_triangles)));
    mail_.resize_uninitialized("cull: boxes", 1);
    device_.synchronize("copy: blocks");
  }

  [[nodiscard]] std::size_t most_rays() const override { return most_rays_; }
  [[nodiscard]] std::size_t window() const override { return kMetWindow; }

  void explain(std::vector<std::string>* plan) const override {
    plan->push_back(
        "device: rays, the tree over them and their hits stay in its memory; blocks come through " +
        std::to_string(lanes_.size()) + " buffers, one thread per ray");
  }

  void begin(const BlockBatch& batch) override {
    batch_ = batch;
    report_ = {};
    rounds_ = loaded_ = traced_ = 0;
    changed_before_ = 0;
    device_.keep_times(batch.count);
    rays_.take(batch.rays, batch.scene);
    take_answers();
    device_.fill("rays: answers", mail_.view(), 0);
    rays_.build();
  }

  void find_distances(View<const Box> boxes, View<float> squared) override {
    if (boxes.empty()) return;
    boxes_.resize_uninitialized("cull: distances", boxes.size);
    words_.resize_uninitialized("cull: distances", boxes.size);
    met_.resize_uninitialized("cull: distances", boxes.size);
    device_.fill("cull: distances", met_.view(), 0);
    device_.copy("cull: distances", boxes_.data(), boxes.data, boxes.size * sizeof(Box));
    distances_on(device_, rays_.state(), rays_.leaves(), boxes_.view_const(), words_.view());
    std::vector<std::uint32_t> words(boxes.size);
    device_.copy("cull: distances", words.data(), words_.data(), words.size() * sizeof words[0]);
    for (std::size_t i = 0; i < boxes.size; ++i)
      squared[i] = words[i] == kNoWord ? -1 : bits_float(words[i]);
  }

  void find_met(View<const Box> boxes, View<std::uint8_t> met) override {
    for (std::size_t first = 0; first < boxes.size; first += kMetWindow) {
      const std::size_t count = std::min<std::size_t>(kMetWindow, boxes.size - first);
      BoxWindow window;
      std::copy_n(boxes.data + first, count, window.box);
      meets_on(device_, rays_.state(), window, count, mail_.data()->met);
      const BlockMail mail = read_mail();
      for (std::size_t i = 0; i < count; ++i) met[first + i] = mail.met[i] != 0 ? 1 : 0;
    }
    // All queued work is done now: read the clocks, and rebuild the tree if necessary.
    keep_times();
    refresh();
  }

  void load(View<const TracedBlock> round) override {
    round_ = round;
    loaded_ = traced_ = 0;
    const std::size_t count = std::min(round.size, lanes_.size());
    std::vector<std::byte*> rooms(count);
    for (std::size_t i = 0; i < count; ++i) rooms[i] = room_for(i);
    executor_.for_each(count, 1, [&](std::size_t i) { pack(i, rooms[i]); });
    for (; loaded_ < count; ++loaded_) send(loaded_);
  }

  void trace() override {
    for (; traced_ < round_.size; ++traced_) {
      trace_block(traced_);
      if (loaded_ == round_.size) continue;
      pack(loaded_, room_for(loaded_));
      send(loaded_++);
    }
    rounds_ += round_.size;
  }

  void collect() override {
    const auto deliver = [&](const auto& from, const auto& to) {
      device_.copy("copy: hits", to.data, from.data(), to.size * sizeof to.data[0]);
    };
    if (is_any()) {
      deliver(occluded_, batch_.occluded);
    } else {
      deliver(hits_, batch_.hits);
    }
    device_.synchronize("copy: hits");
  }

  BlockReport finish() override {
    collect();
    take_counts();
    std::vector<std::uint32_t> met(rounds_);
    device_.copy("count", met.data(), met_.data(), met.size() * sizeof met[0]);
    report_.wasted_blocks = static_cast<std::uint64_t>(std::count(met.begin(), met.end(), 0u));
    keep_times();
    device_.keep_times(false);
    return report_;
  }

 private:
  static constexpr std::uint32_t kNoWord = 0xffffffffu;

  /// A device buffer for a block, and the link that fills it. The link is destroyed first, because
  /// its pending copy needs the memory.
  struct Lane {
    Lane(Device& device, std::uint64_t bytes) : memory(device.allocator()), link(device) {
      memory.resize_uninitialized("copy: blocks", bytes);
      static_cast<void>(link.room("copy: blocks", bytes));
    }
    DeviceBuffer<std::byte> memory;
    typename Device::Uplink link;
  };

  [[nodiscard]] bool is_any() const { return !batch_.occluded.empty(); }
  [[nodiscard]] bool counts_rays() const { return batch_.count || !batch_.ray_tests.empty(); }
  /// The lane of the round's i-th block: all rounds use the lanes cyclically.
  [[nodiscard]] Lane& lane(std::size_t i) { return *lanes_[(rounds_ + i) % lanes_.size()]; }
  [[nodiscard]] BlockUpload upload(std::size_t i) const {
    return BlockUpload(*round_[i].block, batch_.facing);
  }

  std::byte* room_for(std::size_t i) {
    return lane(i).link.room("copy: blocks", upload(i).bytes());
  }
  void pack(std::size_t i, std::byte* room) const { upload(i).pack(room); }
  void send(std::size_t i) {
    lane(i).link.send("copy: blocks", lane(i).memory.data(), upload(i).bytes());
  }

  void take_answers() {
    const std::size_t count = batch_.rays.size;
    counts_.resize_uninitialized("rays: answers", counts_rays() ? count : 0);
    device_.fill("rays: answers", counts_.view(), 0);
    hits_.resize_uninitialized("rays: answers", is_any() ? 0 : count);
    occluded_.resize_uninitialized("rays: answers", is_any() ? count : 0);
    if (batch_.resumed) {
      device_.copy("rays: answers", hits_.data(), batch_.hits.data,
                   hits_.size() * sizeof(StreamHit));
      device_.copy("rays: answers", occluded_.data(), batch_.occluded.data, occluded_.size());
      resume_on(device_, rays_.state(), is_any() ? nullptr : hits_.data(),
                is_any() ? occluded_.data() : nullptr);
    } else {
      miss_all_on(device_, hits_.view());
      device_.fill("rays: answers", occluded_.view(), 0);
    }
  }

  /// Rebuilds the tree after many rays have changed.
  void refresh() {
    const std::uint64_t changed = mail_read_.changed - changed_before_;
    if (changed == 0 || changed * kStaleRays < rays_.size()) return;
    changed_before_ = mail_read_.changed;
    if (is_any()) rays_.drop_done();
    rays_.build();
  }

  /// Adds the rays' counts to the report and to the batch.
  void take_counts() {
    std::vector<WalkCounts> counts(counts_.size());
    device_.copy("count", counts.data(), counts_.data(), counts.size() * sizeof counts[0]);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      report_.ray_bound_tests += counts[i].box_tests;
      report_.triangle_tests += counts[i].triangle_tests;
      if (!batch_.ray_tests.empty())
        batch_.ray_tests[i] += static_cast<float>(counts[i].box_tests + counts[i].triangle_tests);
    }
  }

  const BlockMail& read_mail() {
    downlink_.ask("cull: boxes", mail_.data(), sizeof(BlockMail));
    std::memcpy(&mail_read_, downlink_.wait("cull: boxes"), sizeof mail_read_);
    return mail_read_;
  }

  void trace_block(std::size_t i) {
    Lane& from = lane(i);
    const BlockUpload arrays = upload(i);
    const BlockView block = arrays.view(from.memory.data(), round_[i].number);
    const View<const std::uint8_t> sides = arrays.sides(from.memory.data());
    corners_.resize_uninitialized("trace: triangles", std::size_t{3} * block.count());
    flags_.resize_uninitialized("trace: triangles", sides.empty() ? 0 : block.count());
    from.link.see("copy: blocks");
    spread_triangles_on(device_, block, sides, corners_.data(), flags_.data());
    tree_.build(device_, {corners_.view_const(), flags_.view_const()});
    BlockPassage passage;
    passage.state = rays_.state();
    passage.block = block;
    passage.tree = tree_.view();
    passage.bounds = tree_.scene();
    passage.facing = batch_.facing;
    passage.hits = hits_.data();
    passage.occluded = occluded_.data();
    passage.counts = counts_rays() ? counts_.data() : nullptr;
    passage.changed = &mail_.data()->changed;
    passage.met = met_.data() + rounds_ + i;
    if (is_any()) {
      any_in_block_on(device_, passage);
    } else {
      closest_in_block_on(device_, passage);
    }
    from.link.done_with("copy: blocks");
  }

  void keep_times() {
    if (!batch_.count) return;
    for (const StageTime& time : device_.times()) {
      const std::string_view stage = time.stage;
      const bool culls = stage.starts_with("rays:") || stage.starts_with("cull:");
      (culls ? report_.cull_ms : report_.trace_ms) += time.ms;
    }
    device_.keep_times(true);
  }

  const Executor& executor_;
  Device device_;
  DeviceAllocator& memory_ = device_.allocator();
  std::size_t most_rays_ = 0;
  BlockBatch batch_;
  BlockReport report_;
  View<const TracedBlock> round_;
  std::size_t rounds_ = 0;  ///< blocks of earlier rounds
  std::size_t loaded_ = 0, traced_ = 0;
  std::uint64_t changed_before_ = 0;  ///< when the tree was built

  DeviceBuffer<Vec3> corners_{memory_};  // of the traced block, and its tree
  DeviceBuffer<std::uint8_t> flags_{memory_};
  LinearTree tree_{memory_};
  DeviceRays<Device> rays_{device_};
  DeviceBuffer<StreamHit> hits_{memory_};  // by the caller's numbers
  DeviceBuffer<std::uint8_t> occluded_{memory_};
  DeviceBuffer<WalkCounts> counts_{memory_};
  DeviceBuffer<Box> boxes_{memory_};
  DeviceBuffer<std::uint32_t> words_{memory_}, met_{memory_};
  DeviceBuffer<BlockMail> mail_{memory_};
  BlockMail mail_read_{};
  typename Device::Downlink downlink_{device_};
  std::vector<std::unique_ptr<Lane>> lanes_;
};

}  // namespace raysheaf
