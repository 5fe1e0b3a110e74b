#include "render/frame/frame.h"

#include <algorithm>
#include <string>
#include <utility>

#include "exec/stopwatch.h"
#include "render/frame/cpu_stages.h"
#include "render/picture/film.h"
#include "render/rays/filter.h"
#include "render/shade/shade.h"

namespace raysheaf {
namespace {

/// The most secondary fragments that are processed at once.
constexpr std::size_t kMostFragments = std::size_t{1} << 22;

/// `dual` has a plan for each batch (`BatchStatistics::plan`).
constexpr const char* kPlanned = "plan";

/// The name of the sort key for the statistics.
const char* key_name(const MethodSettings& settings) {
  return settings.traversal == Traversal::kDual ? kPlanned : to_string(settings.key);
}

/// The name of the bundles' bound for the statistics.
const char* bound_name(const MethodSettings& settings) {
  switch (settings.traversal) {
    case Traversal::kBruteForce:
      return "none";
    case Traversal::kPackets:
      return to_string(BundleBound::kFrustum);
    case Traversal::kDual:
      return kPlanned;
    case Traversal::kRayHierarchy:
      break;
  }
  return to_string(settings.bound);
}

/// Follows a group of primary hits to the ends of their paths.
class Paths {
 public:
  using Set = PathStages::Set;

  Paths(PathStages& stages, ProgressMeter& meter, const FrameInput& input, Vec3 sky)
      : stages_(stages),
        meter_(meter),
        bounces_(input.options.bounces),
        traced_(kinds_to_trace(input.options)),
        lights_(static_cast<std::uint32_t>(input.lights.size)),
        sky_(sky),
        room_(input.room) {}

  /// Adds the fragments' light, then that of their rays' hits. If paths split so often that the
  /// next fragments are too many, they are processed in groups, one after the other.
  void follow_light(Set fragments, std::uint32_t bounce) {
    const bool last = bounce > bounces_;
    gather_light(*fragments, bounce, last);
    if (last) return;
    Set next = next_fragments(*fragments, bounce);
    fragments = nullptr;
    if (next == nullptr) return;
    while (next->size() > kMostFragments)
      follow_light(stages_.split_off(*next, next->size() - kMostFragments), bounce + 1);
    follow_light(std::move(next), bounce + 1);
  }

 private:
  /// Traces shadow rays, then adds the light that leaves the fragments to the pixels.
  void gather_light(FragmentSet& fragments, std::uint32_t bounce, bool last) {
    meter_.begin("shading, bounce " + std::to_string(bounce), 1);
    stages_.glow(fragments, {sky_, room_, bounce == 1, last ? std::uint8_t{0} : traced_, last});
    for (std::uint32_t light = 0; light < lights_;)
      light += stages_.add_lights(fragments, bounce, light);
    stages_.add_environment(fragments, bounce);
    stages_.deposit(fragments);
  }

  /// Traces the rays that continue: their hits are the next fragments, sorted by pixel. Misses add
  /// the sky.
  Set next_fragments(const FragmentSet& fragments, std::uint32_t bounce) {
    Set all;
    for (const RayKindEntry& kind : kRayKinds) {
      if ((traced_ & bit_of(kind.kind)) == 0) continue;
      meter_.begin(stage_name(kind.kind, bounce), 1);
      Set hits = stages_.follow(fragments, kind.kind, bounce);
      if (hits == nullptr) continue;
      all = all == nullptr ? std::move(hits) : stages_.merged(std::move(all), std::move(hits));
    }
    return all;
  }

  PathStages& stages_;
  ProgressMeter& meter_;
  const std::uint32_t bounces_;
  const std::uint8_t traced_;  ///< bits (`bit_of`) of the kinds of rays that are followed
  const std::uint32_t lights_;
  const Vec3 sky_;
  const StudioRoom& room_;
};

class Frame {
 public:
  Frame(const Executor& executor, const FrameInput& input)
      : executor_(executor),
        geometry_(input.geometry),
        lights_(static_cast<std::uint32_t>(input.lights.size)),
        input_(input),
        options_(input.options),
        sample_{0, input.samples},
        camera_(make_camera_frame(input.camera, options_.width, options_.height)),
        meter_([this](const Progress& of_stage) { return tell(of_stage); }),
        tally_(geometry_.triangle_count()) {
    const MethodSettings method = method_settings(options_);
    tally_.statistics.key = key_name(method);
    tally_.statistics.bound = bound_name(method);
    if (input.device != nullptr) {
      input.device->begin({executor, options_, input.lights, tally_, meter_, input.rasterize,
                           method, input.ordered, sample_.count > 1, input.ranks});
    } else {
      const Keys keys = orders_rays(method.traversal) ? Keys::kMade : Keys::kNone;
      cpu_ = make_cpu_stages(executor, input, keys, &tally_, &meter_);
    }
    if (sample_.count == 1 || input.camera.aperture == 0) return;
    camera_.lens_radius = 0.5f * input.camera.aperture;
    camera_.focus =
        input.camera.focus > 0 ? input.camera.focus : geometry_.depth_of_middle(camera_, &meter_);
  }

  RenderResult run() {
    while (true) {
      take_sample();
      if (++sample_.index == sample_.count) break;
      if (options_.on_sample && !options_.on_sample(developed(false))) break;
    }
    return developed(true);
  }

 private:
  [[nodiscard]] FrameStages& stages() const {
    return input_.device != nullptr ? *input_.device : *cpu_;
  }

  /// The image of the samples so far; `last`: there are no more.
  RenderResult developed(bool last) {
    RenderResult result = develop(executor_, stages().film(last), options_.exposure);
    result.ambient = sky_;
    result.statistics = tally_.statistics;
    if (input_.complete) input_.complete(&result.statistics);
    return result;
  }

  /// Adds an image with one ray per pixel to the film.
  void take_sample() {
    Stopwatch watch;
    FrameStatistics& statistics = tally_.statistics;
    const SampleStatistics before = totals();
    CameraFrame frame = moved_by_pixels(camera_, filter_offset(sample_));
    frame.sample = sample_;
    const std::size_t groups = stages().look(frame);
    if (sample_.index == 0) sky_ = uniform_sky();
    stages().follow_groups(groups, [&](PathStages& paths, ProgressMeter& meter, std::size_t group) {
      Paths(paths, meter, input_, sky_).follow_light(paths.see(group), 1);
    });
    SampleStatistics sample = totals();
    sample.rays -= before.rays;
    sample.total_tests -= before.total_tests;
    sample.hits -= before.hits;
    sample.ms = watch.lap_ms();
    statistics.samples.push_back(sample);
  }

  [[nodiscard]] Vec3 uniform_sky() {
    if (options_.ambient) return *options_.ambient;
    if (input_.environment != nullptr) return {0, 0, 0};
    return lights_ == 0 ? kWhiteSky : stages().find_sky();
  }

  /// The totals of all batches so far.
  [[nodiscard]] SampleStatistics totals() const {
    SampleStatistics sum;
    for (const BatchStatistics& batch : tally_.statistics.batches) {
      sum.rays += batch.rays;
      sum.total_tests += batch.total_tests();
      sum.hits += batch.hits;
    }
    return sum;
  }

  /// Reports progress: of samples if there are several, otherwise of the stage.
  [[nodiscard]] bool tell(const Progress& of_stage) const {
    if (!options_.progress) return true;
    if (sample_.count > 1) return options_.progress({"samples", sample_.index, sample_.count});
    return options_.progress(of_stage);
  }

  const Executor& executor_;
  FrameGeometry& geometry_;
  const std::uint32_t lights_;
  const FrameInput& input_;
  const RenderOptions& options_;
  SampleOf sample_;
  CameraFrame camera_;  ///< its rays pass through the pixels' centres
  ProgressMeter meter_;
  FrameTally tally_;
  std::unique_ptr<FrameStages> cpu_;  ///< unless the frame runs on a device
  Vec3 sky_;
};

}  // namespace

RenderResult render_frame(const Executor& executor, const FrameInput& input) {
  return Frame(executor, input).run();
}

}  // namespace raysheaf
