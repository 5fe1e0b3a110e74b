#include "out_of_core/streamer.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/vec.h"
#include "exec/stopwatch.h"
#include "out_of_core/batch_checkpoint.h"
#include "out_of_core/cpu_block_tracer.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

std::string megabytes(std::uint64_t bytes) {
  return std::to_string((bytes + 500'000) / 1'000'000) + " MB";
}

/// Describes the blocks counted between `before` and `now`.
std::string sentence_of(const StreamStatistics& before, const StreamStatistics& now) {
  const auto grown = [&](std::uint64_t StreamStatistics::*field) {
    return std::to_string(now.*field - before.*field);
  };
  return "stream: of " + grown(&StreamStatistics::blocks) + " blocks " +
         grown(&StreamStatistics::culled_blocks) + " are outside all rays' bounds and " +
         grown(&StreamStatistics::hidden_blocks) + " are behind hits; " +
         grown(&StreamStatistics::read_blocks) + " read, " +
         megabytes(now.read_bytes - before.read_bytes);
}

}  // namespace

/// One batch that blocks stream past.
class Sweep {
 public:
  /// One of `hits` and `occluded` is empty.
  Sweep(Streamer* streamer, const BlockBatch& batch, const StreamRequest& request,
        QueryReport* report)
      : s_(*streamer),
        batch_(batch),
        request_(request),
        report_(*report),
        checkpoint_(identity(), s_.options_.checkpoint, answers()),
        reader_(s_.source_) {}

  void run() {
    batch_.resumed = checkpoint_.restore();
    s_.tracer_->begin(batch_);
    find_candidates();
    request_.meter->begin(request_.stage, bytes_ahead_);
    std::vector<std::uint32_t> reading = next_round(), tracing;
    if (reading.empty()) checkpoint_.keep({}, true);  // there is no last block
    start(reading);
    while (!reading.empty()) {
      watch_.lap_ms();
      stats().read_ms += reader_.wait();
      stats().wait_ms += watch_.lap_ms();
      std::swap(reading, tracing);
      std::swap(s_.reading_, s_.tracing_);
      const std::vector<TracedBlock> round = load(tracing);
      reading = next_round();
      start(reading);
      s_.tracer_->trace();
      for (const std::uint32_t block : tracing) request_.meter->advance(info(block).geometry_bytes);
      if (checkpoint_.is_kept()) s_.tracer_->collect();
      checkpoint_.keep(tracing, reading.empty());
    }
    take_report(s_.tracer_->finish());
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
  [[nodiscard]] bool is_any() const { return !batch_.occluded.empty(); }

  [[nodiscard]] StreamBatch identity() const {
    // The kind of query as a number.
    const auto question = (is_any() ? 2u : 0u) + (batch_.facing == Facing::kBoth ? 1u : 0u);
    return {s_.batches_,
            question,
            s_.options_.part,
            s_.options_.parts,
            {batch_.rays.data, batch_.rays.size},
            s_.source_.blocks()};
  }
  [[nodiscard]] std::span<std::byte> answers() const {
    if (is_any())
      return std::as_writable_bytes(std::span(batch_.occluded.data, batch_.occluded.size));
    return std::as_writable_bytes(std::span(batch_.hits.data, batch_.hits.size));
  }

  /// Finds the blocks that some ray's bound intersects, and sorts near ones first.
  void find_candidates() {
    const std::size_t count = s_.source_.blocks().size();
    std::vector<std::uint32_t> asked;
    std::vector<Box> boxes;
    for (std::size_t i = s_.options_.part; i < count; i += s_.options_.parts) {
      ++stats().blocks;
      if (checkpoint_.is_done(i)) {
        ++stats().culled_blocks;
        continue;
      }
      asked.push_back(static_cast<std::uint32_t>(i));
      boxes.push_back(s_.source_.blocks()[i].bounds);
    }
    std::vector<float> distance(boxes.size());
    s_.tracer_->find_distances(boxes, distance);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (distance[i] < 0) {
        ++stats().culled_blocks;
        continue;
      }
      candidates_.push_back({s_.options_.front_to_back ? distance[i] : 0, asked[i]});
      bytes_ahead_ += info(asked[i]).geometry_bytes;
    }
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const Candidate& a, const Candidate& b) {
                       return a.squared_distance < b.squared_distance;
                     });
  }

  /// The next blocks that a ray may still intersect, given the hits so far.
  std::vector<std::uint32_t> next_round() {
    std::vector<std::uint32_t> round;
    std::uint64_t passed = 0;
    while (next_ < candidates_.size() && round.size() < s_.slots_) {
      const std::size_t window = std::max(s_.tracer_->window(), s_.slots_ - round.size());
      const std::vector<std::uint8_t> met = ask(std::min(window, candidates_.size() - next_));
      for (std::size_t i = 0; i < met.size() && round.size() < s_.slots_; ++i, ++next_) {
        const std::uint32_t block = candidates_[next_].block;
        if (met[i] != 0) {
          round.push_back(block);
        } else {
          ++stats().hidden_blocks;
          passed += info(block).geometry_bytes;
        }
      }
    }
    request_.meter->advance(passed);
    return round;
  }

  /// Whether rays may intersect the next `count` candidates.
  std::vector<std::uint8_t> ask(std::size_t count) {
    std::vector<Box> boxes;
    for (std::size_t i = next_; i < next_ + count; ++i)
      boxes.push_back(info(candidates_[i].block).bounds);
    std::vector<std::uint8_t> met(count);
    s_.tracer_->find_met(boxes, met);
    return met;
  }

  void start(const std::vector<std::uint32_t>& round) {
    if (round.empty()) return;
    for (const std::uint32_t block : round) {
      ++stats().read_blocks;
      stats().read_bytes += info(block).geometry_bytes;
    }
    reader_.start(round, &s_.reading_);
  }

  /// Loads blocks into the tracer, which uses the result until it has traced.
  std::vector<TracedBlock> load(const std::vector<std::uint32_t>& numbers) {
    std::vector<TracedBlock> round;
    for (std::size_t i = 0; i < numbers.size(); ++i) round.push_back({numbers[i], &s_.tracing_[i]});
    s_.tracer_->load(round);
    return round;
  }

  void take_report(const BlockReport& report) {
    report_.bound_tests += report.bound_tests;
    report_.ray_bound_tests += report.ray_bound_tests;
    report_.triangle_tests += report.triangle_tests;
    report_.trace_ms += report.trace_ms;
    stats().wasted_blocks += report.wasted_blocks;
    stats().cull_ms += report.cull_ms;
    stats().trace_ms += report.trace_ms;
  }

  Streamer& s_;
  BlockBatch batch_;
  const StreamRequest& request_;
  QueryReport& report_;
  Stopwatch watch_;
  BatchCheckpoint checkpoint_;
  std::vector<Candidate> candidates_;
  std::size_t next_ = 0;  ///< of the candidates
  std::uint64_t bytes_ahead_ = 0;
  BlockReader reader_;  ///< last, because it must stop before the other members are destroyed
};

Streamer::Streamer(const Executor& executor, const GeometrySource& source,
                   const StreamOptions& options, std::uint32_t slots, const DeviceBackend* device)
    : source_(source),
      options_(options),
      bounds_(world_bounds(source)),
      slots_(slots),
      reading_(slots),
      tracing_(slots) {
  BlockLimits limits{options.memory_bytes, slots, 1};
  for (std::size_t i = 0; i < source.blocks().size(); ++i) {
    const BlockInfo& block = source.blocks()[i];
    if (block.triangles != 0 && !(min_component(block.bounds.max - block.bounds.min) >= 0))
      throw Error(ErrorCode::kInvalidData, "has triangles, but its bounds are empty",
                  source.place(i));
    triangle_count_ += block.triangles;
    limits.most_triangles = std::clamp(block.triangles, limits.most_triangles, kBlockTriangles);
  }
  if (device != nullptr) {
    tracer_ = device->make_block_tracer(executor, limits);
  } else {
    tracer_ = std::make_unique<CpuBlockTracer>(executor, slots);
  }
}

Streamer::~Streamer() = default;

void Streamer::closest(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
                       QueryReport* report) {
  std::fill(hits.begin(), hits.end(), StreamHit{});
  sweep(rays, request, hits, {}, report);
  if (options_.exchange != nullptr) options_.exchange->closest({hits.data, hits.size});
}

void Streamer::any(View<const Ray> rays, const StreamRequest& request, View<std::uint8_t> occluded,
                   QueryReport* report) {
  std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
  sweep(rays, request, {}, occluded, report);
  if (options_.exchange != nullptr) options_.exchange->unite({occluded.data, occluded.size});
}

void Streamer::sweep(View<const Ray> rays, const StreamRequest& request, View<StreamHit> hits,
                     View<std::uint8_t> occluded, QueryReport* report) {
  const StreamStatistics before = statistics_;
  HitExchange* const exchange = options_.exchange;
  StreamRequest own = request;
  std::vector<float> tests(exchange != nullptr ? request.ray_tests.size : 0);
  if (exchange != nullptr) own.ray_tests = tests;
  const std::size_t most = std::min(tracer_->most_rays(), rays.size);
  for (std::size_t first = 0; first < rays.size; first += most)
    sweep_part(rays.slice(first, std::min(most, rays.size - first)), first, own, hits, occluded,
               report);
  if (rays.empty()) ++batches_;
  tracer_->explain(&report->plan);
  if (most < rays.size)
    report->plan.push_back("device: the blocks stream again for every " + std::to_string(most) +
                           " rays, because it has no memory for more");
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

void Streamer::sweep_part(View<const Ray> rays, std::size_t first, const StreamRequest& request,
                          View<StreamHit> hits, View<std::uint8_t> occluded, QueryReport* report) {
  BlockBatch batch;
  batch.rays = rays;
  batch.scene = triangle_count_ != 0 ? bounds_ : Box{{0, 0, 0}, {0, 0, 0}};
  batch.facing = request.facing;
  if (!hits.empty()) batch.hits = hits.slice(first, rays.size);
  if (!occluded.empty()) batch.occluded = occluded.slice(first, rays.size);
  if (!request.ray_tests.empty()) batch.ray_tests = request.ray_tests.slice(first, rays.size);
  batch.count = request.count;
  Sweep(this, batch, request, report).run();
  ++batches_;
}

void check_parts(const StreamOptions& options) {
  if (options.part < options.parts) return;
  throw Error(ErrorCode::kInvalidArgument,
              "part " + std::to_string(options.part) + " is not one of " +
                  std::to_string(options.parts) + " parts",
              "part");
}

std::uint32_t slots_for(std::uint64_t memory_bytes, std::uint64_t taken, std::uint64_t rays) {
  const std::uint64_t slot = kStreamBlockBytes + rays * 64;
  if (memory_bytes < taken + slot)
    throw Error(ErrorCode::kOutOfMemory,
                "this takes at least " + std::to_string(((taken + slot) >> 20) + 1) +
                    " MiB, but the limit is " + std::to_string(memory_bytes >> 20) + " MiB",
                "memory");
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>((memory_bytes - taken) / slot, kMostSlots));
}

}  // namespace raysheaf
