#include "render/frame/cpu_stages.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/bits.h"
#include "render/frame/cpu_paths.h"

namespace raysheaf {
namespace {

/// The most primary hits that `find_sky` keeps for `follow_groups`; further ones are fetched twice.
constexpr std::size_t kMostKept = std::size_t{1} << 21;

/// A thread's objects for following groups.
struct Follower {
  Follower(std::unique_ptr<PathGeometry> own, CpuFrame& frame, Keys keys)
      : geometry(std::move(own)),
        tally(geometry->triangle_count()),
        paths(executor, *geometry, frame, keys, &tally, &meter) {}

  const Executor executor = Executor::serial();
  const std::unique_ptr<PathGeometry> geometry;
  FrameTally tally;
  ProgressMeter meter;  ///< reports to no one
  CpuPaths paths;
};

class CpuStages : public FrameStages {
 public:
  CpuStages(const Executor& executor, const FrameInput& input, Keys keys, FrameTally* tally,
            ProgressMeter* meter)
      : executor_(executor),
        geometry_(input.geometry),
        rasterizer_(input.rasterizer),
        keys_(keys),
        tally_(*tally),
        meter_(*meter),
        frame_(input, tally),
        paths_(executor, geometry_, frame_, keys, tally, meter) {}

  std::size_t look(const CameraFrame& frame) override {
    const Stopwatch watch;
    frame_.sample = frame.sample;
    const auto of_rays = [this]() -> BatchStatistics& {
      return tally_.batch(RayKind::kPrimary, 0);
    };
    frame_.kept.clear();
    Gbuffer of_other_samples;
    Gbuffer* const gbuffer = frame.sample.index == 0 ? &gbuffer_ : &of_other_samples;
    frame_.kept.resize(geometry_.look({frame, rasterizer_, of_rays, frame_.film.tests(),
                                       frame_.options.gbuffer ? gbuffer : nullptr},
                                      &meter_));
    frame_.film.begin_sample();
    tally_.statistics.raster_ms += watch.ms();
    if (geometry_.is_shared() && sends_rays()) share();
    return frame_.kept.size();
  }

  Vec3 find_sky() override {
    const std::size_t groups = frame_.kept.size();
    const std::size_t pixels = std::size_t{frame_.options.width} * frame_.options.height;
    const std::size_t kept = pixels <= kMostKept ? groups : groups * kMostKept / pixels;
    std::vector<SkyPart> parts(div_ceil(pixels, kSkyPart));
    meter_.begin("primary hits", groups);
    for_each_group(groups, [&](CpuPaths& paths, ProgressMeter& /*meter*/, std::size_t group) {
      paths.find_sky(group, group < std::max<std::size_t>(kept, 1), parts);
      meter_.advance(1);
    });
    if (frame_.sharing != nullptr) frame_.sharing->unite(&parts);
    return sky_of_parts(parts);
  }

  void follow_groups(std::size_t count, const FollowGroup& follow) override {
    const std::size_t first = frame_.sample.index * count;
    if (!geometry_.is_shared()) {
      for_each_group(count, [&](CpuPaths& paths, ProgressMeter& meter, std::size_t group) {
        follow(paths, meter, group);
        tally_.keep_plans(first + group);
      });
      return;
    }
    meter_.begin("parts", count);
    for_each_group(count, [&](CpuPaths& paths, ProgressMeter& meter, std::size_t group) {
      follow(paths, meter, group);
      meter_.advance(1);
    });
    tell_of_shared();
  }

  FilmSums film(bool taken) override {
    FilmSums sums = taken ? frame_.film.taken() : frame_.film.sums();
    if (frame_.sharing != nullptr) frame_.sharing->unite(&sums);
    sums.result.gbuffer = gbuffer_;
    return sums;
  }

 private:
  [[nodiscard]] bool sends_rays() const {
    const RenderOptions& options = frame_.options;
    const bool lit = !frame_.lights.empty() || frame_.environment != nullptr;
    return rasterizer_ == nullptr || (options.shadows && lit) || kinds_to_trace(options) != 0;
  }

  void share() {
    SharedWork work = geometry_.share();
    shared_.ms += work.ms;
    if (shared_.plan.empty()) shared_.plan = std::move(work.plan);
  }

  /// Assigns the time and the plan of the shared tree to the first batch that used it.
  void tell_of_shared() {
    for (BatchStatistics& batch : tally_.statistics.batches) {
      // These rays were traced before the tree was prepared.
      if (batch.bounce == 0 && rasterizer_ != nullptr) continue;
      batch.times_ms.hierarchy += std::exchange(shared_.ms, 0);
      if (!told_ && frame_.sharing != nullptr) shared_.plan.push_back(frame_.sharing->sentence());
      if (!told_) batch.plan.insert(batch.plan.begin(), shared_.plan.begin(), shared_.plan.end());
      told_ = true;
      return;
    }
  }

  /// Calls `body(paths, meter, group)`, in parallel if the geometry can be shared.
  template <class Body>
  void for_each_group(std::size_t count, const Body& body) {
    if (!geometry_.is_shared()) {
      for (std::size_t group = 0; group < count; ++group) body(paths_, meter_, group);
      return;
    }
    const Stopwatch watch;
    const auto follow = [&](std::size_t group) {
      std::unique_ptr<Follower> follower = take_follower();
      body(follower->paths, follower->meter, group);
      follower->tally.keep_plans(frame_.sample.index * count + group);
      give_back(std::move(follower));
    };
    if (frame_.sharing == nullptr) {
      executor_.for_each(count, 1, follow);
    } else {
      frame_.sharing->for_each(executor_, count, follow,
                               [this](std::size_t others) { meter_.advance(others); });
    }
    take_tallies(watch.ms());
  }

  /// Collects the counts of followers after a loop of this duration.
  void take_tallies(double loop_ms) {
    // Followers ran in parallel: their times are scaled so that their sum is the loop's.
    double sum = 0;
    for (const auto& follower : free_) {
      const FrameStatistics& s = follower->tally.statistics;
      sum += s.raster_ms + s.shade_ms;
      for (const BatchStatistics& batch : s.batches) {
        if (batch.bounce != 0)
          sum += batch.times_ms.total();  // otherwise it is part of
                                          // `raster_ms`
      }
    }
    FrameTally all(geometry_.triangle_count());
    for (const auto& follower : free_) all.take(&follower->tally, sum > 0 ? loop_ms / sum : 0);
    if (frame_.sharing != nullptr) frame_.sharing->add_up(&all);
    std::uint64_t rays = 0;
    for (const BatchStatistics& batch : all.statistics.batches) rays += batch.rays;
    tally_.take(&all, 1);
    if (rays > 0) geometry_.add_rays(rays);
  }

  std::unique_ptr<Follower> take_follower() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Follower> last = std::move(free_.back());
        free_.pop_back();
        return last;
      }
    }
    return std::make_unique<Follower>(geometry_.of_one_thread(), frame_, keys_);
  }
  void give_back(std::unique_ptr<Follower> follower) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(follower));
  }

  const Executor& executor_;
  FrameGeometry& geometry_;
  Rasterizer* const rasterizer_;
  const Keys keys_;
  FrameTally& tally_;
  ProgressMeter& meter_;
  CpuFrame frame_;
  CpuPaths paths_;   ///< of all threads together
  Gbuffer gbuffer_;  ///< of the first sample, where asked for
  std::mutex mutex_;
  std::vector<std::unique_ptr<Follower>> free_;  ///< of single threads, between groups
  SharedWork shared_;
  bool told_ = false;
};

}  // namespace

std::unique_ptr<FrameStages> make_cpu_stages(const Executor& executor, const FrameInput& input,
                                             Keys keys, FrameTally* tally, ProgressMeter* meter) {
  return std::make_unique<CpuStages>(executor, input, keys, tally, meter);
}

}  // namespace raysheaf
