#include "stream/streamer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "base/vec.h"
#include "exec/stopwatch.h"
#include "raysheaf/error.h"
#include "stream/batch_checkpoint.h"

namespace raysheaf {
namespace {

/// The tree is made anew when this part of the rays has become shorter or is done.
constexpr std::size_t kStaleDivisor = 16;

std::string megabytes(std::uint64_t bytes) {
  return std::to_string((bytes + 500'000) / 1'000'000) + " MB";
}

/// What became of `now` since `before`.
std::string sentence_of(const StreamStatistics& before, const StreamStatistics& now) {
  const auto grown = [&](std::uint64_t StreamStatistics::*field) {
    return std::to_string(now.*field - before.*field);
  };
  return "stream: of " + grown(&StreamStatistics::blocks) + " blocks " +
         grown(&StreamStatistics::culled_blocks) + " meet no ray's bound and " +
         grown(&StreamStatistics::hidden_blocks) + " lie behind hits; " +
         grown(&StreamStatistics::read_blocks) + " read, " +
         megabytes(now.read_bytes - before.read_bytes);
}

/// The place among the block's parts of a triangle's.
std::size_t part_of(const TriangleBlock& block, std::uint32_t triangle) {
  const auto after =
      std::upper_bound(block.parts.begin(), block.parts.end(), triangle,
                       [](std::uint32_t t, const BlockPart& part) { return t < part.first; });
  return static_cast<std::size_t>(after - block.parts.begin()) - 1;
}

}  // namespace

/// A block that is traced, and what that takes.
struct Streamer::Slot {
  Engine engine;
  TriangleRun run;
  std::vector<std::uint8_t> flags;
  std::vector<std::uint32_t> places, numbers;  ///< of the rays that may meet the block
  Buffer<Ray> rays;
  Buffer<EngineHit> closest;
  Buffer<std::uint8_t> occluded;
  std::vector<float> tests;
  EngineReport report;

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

/// One batch on its way through the blocks.
class Sweep {
 public:
  /// One of `hits` and `occluded` is empty.
  Sweep(Streamer* streamer, View<const Ray> rays, const StreamRequest& request,
        View<StreamHit> hits, View<std::uint8_t> occluded, EngineReport* report)
      : s_(*streamer),
        request_(request),
        hits_(hits),
        occluded_(occluded),
        report_(*report),
        tree_(s_.executor_, rays, s_.bounds_),
        checkpoint_(batch_of(rays), s_.options_.checkpoint, answers()),
        reader_(s_.source_) {
    if (checkpoint_.restore()) go_on();
    stats().cull_ms += watch_.lap_ms();
  }

  void run() {
    find_candidates();
    request_.meter->begin(request_.stage, bytes_ahead_);
    std::vector<std::uint32_t> reading = next_round(), tracing;
    start(reading);
    while (!reading.empty()) {
      watch_.lap_ms();
      stats().read_ms += reader_.wait();
      stats().wait_ms += watch_.lap_ms();
      std::swap(reading, tracing);
      std::swap(s_.reading_, s_.tracing_);
      reading = next_round();
      start(reading);
      trace(tracing);
      refresh();
      checkpoint_.keep(tracing, reading.empty());
    }
  }

 private:
  struct Candidate {
    float squared_distance;
    std::uint32_t block;
  };

  [[nodiscard]] StreamStatistics& stats() { return s_.statistics_; }
  [[nodiscard]] const BlockInfo& info(std::uint32_t block) const {
    return s_.source_.blocks()[block];
  }
  [[nodiscard]] bool is_any() const { return !occluded_.empty(); }

  [[nodiscard]] StreamBatch batch_of(View<const Ray> rays) const {
    // Which hits are asked for, as a number.
    const auto question = (is_any() ? 2u : 0u) + (request_.facing == Facing::kBoth ? 1u : 0u);
    return {
        s_.batches_,        question, s_.options_.part, s_.options_.parts, {rays.data, rays.size},
        s_.source_.blocks()};
  }
  [[nodiscard]] std::span<std::byte> answers() const {
    if (is_any()) return std::as_writable_bytes(std::span(occluded_.data, occluded_.size));
    return std::as_writable_bytes(std::span(hits_.data, hits_.size));
  }

  /// Rays end where an earlier run has met something.
  void go_on() {
    s_.executor_.for_each(tree_.size(), kWorkGrain, [&](std::size_t i) {
      const std::uint32_t place = index(i), number = tree_.number(place);
      if (is_any() && occluded_[number] != 0) tree_.finish(place);
      if (!is_any() && hits_[number].block != kInvalidId) tree_.shorten(place, hits_[number].hit.t);
    });
    tree_.refresh(s_.executor_);
  }

  /// Blocks that some ray's bound meets, near ones first.
  void find_candidates() {
    const std::size_t count = s_.source_.blocks().size();
    std::vector<float> distance(count, -1);
    const std::uint32_t part = s_.options_.part, parts = s_.options_.parts;
    s_.executor_.for_each(count, 4, [&](std::size_t i) {
      if (s_.is_own(i) && !checkpoint_.is_done(i))
        distance[i] = tree_.squared_distance(info(index(i)).bounds);
    });
    for (std::size_t i = part; i < count; i += parts) {
      ++stats().blocks;
      if (distance[i] < 0) {
        ++stats().culled_blocks;
        continue;
      }
      candidates_.push_back({s_.options_.front_to_back ? distance[i] : 0, index(i)});
      bytes_ahead_ += info(index(i)).geometry_bytes;
    }
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) {
                       return a.squared_distance < b.squared_distance;
                     });
    stats().cull_ms += watch_.lap_ms();
  }

  static std::uint32_t index(std::size_t i) { return static_cast<std::uint32_t>(i); }

  /// The next blocks that a ray still may meet, as far as is known.
  std::vector<std::uint32_t> next_round() {
    std::vector<std::uint32_t> round;
    std::uint64_t passed = 0;
    for (; next_ < candidates_.size() && round.size() < s_.slots_.size(); ++next_) {
      const std::uint32_t block = candidates_[next_].block;
      if (tree_.meets(info(block).bounds)) {
        round.push_back(block);
      } else {
        ++stats().hidden_blocks;
        passed += info(block).geometry_bytes;
      }
    }
    stats().cull_ms += watch_.lap_ms();
    request_.meter->advance(passed);
    return round;
  }

  void start(const std::vector<std::uint32_t>& round) {
    if (round.empty()) return;
    for (const std::uint32_t block : round) {
      ++stats().read_blocks;
      stats().read_bytes += info(block).geometry_bytes;
    }
    reader_.start(round, &s_.reading_);
  }

  void trace(const std::vector<std::uint32_t>& round) {
    watch_.lap_ms();
    s_.executor_.for_each(round.size(), 1,
                          [&](std::size_t i) { trace_block(s_.tracing_[i], s_.slots_[i].get()); });
    for (std::size_t i = 0; i < round.size(); ++i) {
      take(round[i], s_.tracing_[i], s_.slots_[i].get());
      request_.meter->advance(info(round[i]).geometry_bytes);
    }
    const double ms = watch_.lap_ms();
    stats().trace_ms += ms;
    report_.trace_ms += ms;
  }

  void trace_block(const TriangleBlock& block, Streamer::Slot* slot) {
    Box box = bounds_of(block);
    tree_.find(box, &slot->places);
    const std::size_t count = slot->places.size();
    slot->report = {};
    if (count == 0) return;
    slot->numbers.resize(count);
    slot->rays.resize_uninitialized(count);
    for (std::size_t i = 0; i < count; ++i) {
      slot->numbers[i] = tree_.number(slot->places[i]);
      slot->rays[i] = tree_.ray(slot->places[i]);
    }
    slot->tests.assign(request_.ray_tests.empty() ? 0 : count, 0.0f);
    slot->set_triangles(block, request_.facing);
    const EngineOptions options{request_.facing, true};
    const View<const Ray> rays(slot->rays.data(), count);
    if (is_any()) {
      slot->occluded.resize_uninitialized(count);
      slot->engine.any_hit(s_.executor_, rays, options, slot->occluded, slot->tests, &slot->report);
    } else {
      slot->closest.resize_uninitialized(count);
      slot->engine.closest_hit(s_.executor_, rays, options, slot->closest, slot->tests,
                               &slot->report);
    }
  }

  /// What a block gave, into the answers. A ray stands in a slot once.
  void take(std::uint32_t number, const TriangleBlock& block, Streamer::Slot* slot) {
    if (slot->places.empty()) ++stats().wasted_blocks;
    report_.bound_tests += slot->report.bound_tests;
    report_.ray_bound_tests += slot->report.ray_bound_tests;
    report_.triangle_tests += slot->report.triangle_tests;
    s_.executor_.for_each_block(
        slot->places.size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
          std::size_t changed = 0;
          for (std::size_t i = begin; i < end; ++i) {
            if (!slot->tests.empty()) request_.ray_tests[slot->numbers[i]] += slot->tests[i];
            const bool news =
                is_any() ? take_occluded(*slot, i) : take_hit(number, block, *slot, i);
            changed += news ? 1 : 0;
          }
          changed_ += changed;
        });
  }

  bool take_occluded(const Streamer::Slot& slot, std::size_t i) {
    std::uint8_t& occluded = occluded_[slot.numbers[i]];
    if (slot.occluded[i] == 0 || occluded != 0) return false;
    occluded = 1;
    tree_.finish(slot.places[i]);
    return true;
  }

  bool take_hit(std::uint32_t number, const TriangleBlock& block, const Streamer::Slot& slot,
                std::size_t i) {
    const EngineHit& found = slot.closest[i];
    if (found.triangle == kInvalidId) return false;
    const std::size_t place = part_of(block, found.triangle);
    const BlockPart& part = block.parts[place];
    const Hit hit{found.t,      found.u,     found.v, block.prim_ids[found.triangle],
                  part.geom_id, part.inst_id};
    StreamHit& best = hits_[slot.numbers[i]];
    if (best.block != kInvalidId && !precedes(hit, best.hit)) return false;
    best.hit = hit;
    best.block = number;
    best.part = static_cast<std::uint32_t>(place);
    best.triangle = found.triangle;
    best.vertex = block.triangles[found.triangle];
    for (std::size_t k = 0; k < 3; ++k) best.corner[k] = block.positions[best.vertex[k]];
    tree_.shorten(slot.places[i], hit.t);
    return true;
  }

  void refresh() {
    watch_.lap_ms();
    if (changed_ * kStaleDivisor >= tree_.size() && tree_.size() != 0 && changed_ != 0) {
      tree_.refresh(s_.executor_);
      changed_ = 0;
    }
    stats().cull_ms += watch_.lap_ms();
  }

  Streamer& s_;
  const StreamRequest& request_;
  View<StreamHit> hits_;
  View<std::uint8_t> occluded_;
  EngineReport& report_;
  Stopwatch watch_;
  RayTree tree_;
  BatchCheckpoint checkpoint_;
  std::vector<Candidate> candidates_;
  std::size_t next_ = 0;  ///< of them
  std::uint64_t bytes_ahead_ = 0;
  std::atomic<std::size_t> changed_{0};  ///< rays, since the tree was made
  BlockReader reader_;                   ///< last: it stops before all else goes
};

Streamer::Streamer(const Executor& executor, const GeometrySource& source,
                   const StreamOptions& options, std::uint32_t slots)
    : executor_(executor), source_(source), options_(options), reading_(slots), tracing_(slots) {
  for (std::uint32_t i = 0; i < slots; ++i) slots_.push_back(std::make_unique<Slot>());
  for (const BlockInfo& block : source.blocks()) {
    bounds_.min = min(bounds_.min, block.bounds.min);
    bounds_.max = max(bounds_.max, block.bounds.max);
    triangle_count_ += block.triangles;
  }
}

Streamer::~Streamer() = default;

void Streamer::closest(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
                       EngineReport* report) {
  std::fill(hits.begin(), hits.end(), StreamHit{});
  sweep(rays, request, hits, {}, report);
  if (options_.exchange != nullptr) options_.exchange->closest({hits.data, hits.size});
}

void Streamer::any(View<const Ray> rays, const StreamRequest& request, View<std::uint8_t> occluded,
                   EngineReport* report) {
  std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
  sweep(rays, request, {}, occluded, report);
  if (options_.exchange != nullptr) options_.exchange->unite({occluded.data, occluded.size});
}

void Streamer::sweep(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
                     View<std::uint8_t> occluded, EngineReport* report) {
  const StreamStatistics before = statistics_;
  HitExchange* const exchange = options_.exchange;
  StreamRequest own = request;
  std::vector<float> tests(exchange != nullptr ? request.ray_tests.size : 0);
  if (exchange != nullptr) own.ray_tests = tests;
  if (!rays.empty()) Sweep(this, rays, own, hits, occluded, report).run();
  ++batches_;
  report->plan.push_back(sentence_of(before, statistics_));
  if (exchange == nullptr) return;
  std::array<std::uint64_t, 3> counts{report->bound_tests, report->ray_bound_tests,
                                      report->triangle_tests};
  exchange->add(counts);
  report->bound_tests = counts[0];
  report->ray_bound_tests = counts[1];
  report->triangle_tests = counts[2];
  if (!tests.empty()) exchange->add(tests);
  for (std::size_t i = 0; i < tests.size(); ++i) request.ray_tests[i] += tests[i];
}

void check_parts(const StreamOptions& options) {
  if (options.part < options.parts) return;
  throw Error(ErrorCode::kInvalidArgument,
              "part " + std::to_string(options.part) + " is not among " +
                  std::to_string(options.parts) + " parts",
              "part");
}

std::uint32_t slots_for(std::uint64_t memory_bytes, std::uint64_t taken, std::uint64_t rays) {
  const std::uint64_t slot = kStreamBlockBytes + rays * 64;
  if (memory_bytes < taken + slot)
    throw Error(ErrorCode::kOutOfMemory,
                "this takes at least " + std::to_string(((taken + slot) >> 20) + 1) + " MiB, not " +
                    std::to_string(memory_bytes >> 20),
                "memory");
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>((memory_bytes - taken) / slot, kMostSlots));
}

}  // namespace raysheaf
