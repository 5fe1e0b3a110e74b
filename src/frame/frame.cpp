#include "frame/frame.h"

#include <algorithm>
#include <string>
#include <utility>

#include "exec/stopwatch.h"
#include "frame/film.h"
#include "raygen/filter.h"
#include "raygen/raygen.h"
#include "raygen/scatter_body.h"
#include "raygen/sky_body.h"
#include "shade/shade.h"

namespace raysheaf {
namespace {

/// A slot of a batch of shadow rays each.
using Visibilities = std::vector<Visibility>;

/// Secondary fragments that are worked on at once.
constexpr std::size_t kMostFragments = std::size_t{1} << 22;

/// `dual` plans each batch by itself (`BatchStatistics::plan`).
constexpr const char* kPlanned = "plan";

/// What rays are sorted by, in a word for the statistics.
const char* key_name(const MethodSettings& settings) {
  return settings.traversal == Traversal::kDual ? kPlanned : to_string(settings.key);
}

/// What bounds bundles of rays, in a word for the statistics.
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

/// Whether rays are brought together by keys of theirs; `dual` finds its own way.
bool sorts_by_keys(const MethodSettings& settings) {
  return settings.traversal == Traversal::kRayHierarchy ||
         settings.traversal == Traversal::kPackets;
}

/// Both ascend by pixel and have fragments; those of `a` come before those of `b` with their pixel.
Fragments merged_by_pixel(const Executor& executor, const Fragments& a, const Fragments& b) {
  constexpr std::size_t kParts = 64;  // each of whole pixels
  const Fragments& larger = a.size() < b.size() ? b : a;
  const auto begin_of = [&](const Fragments& all, std::size_t part) {
    if (part == 0 || part == kParts) return part == 0 ? all.begin() : all.end();
    const std::uint32_t pixel = larger[larger.size() * part / kParts].pixel;
    return std::partition_point(all.begin(), all.end(),
                                [pixel](const Fragment& f) { return f.pixel < pixel; });
  };
  Fragments merged(a.size() + b.size());
  executor.for_each(kParts, 1, [&](std::size_t part) {
    const auto first_a = begin_of(a, part), first_b = begin_of(b, part);
    std::merge(first_a, begin_of(a, part + 1), first_b, begin_of(b, part + 1),
               merged.begin() + ((first_a - a.begin()) + (first_b - b.begin())),
               [](const Fragment& f, const Fragment& g) { return f.pixel < g.pixel; });
  });
  return merged;
}

class Frame {
 public:
  Frame(const Executor& executor, const FrameInput& input, ProgressMeter* meter)
      : executor_(executor),
        geometry_(input.geometry),
        lights_(input.lights),
        input_(input),
        options_(input.options),
        sample_{0, input.samples},
        camera_(make_camera_frame(input.camera, options_.width, options_.height)),
        film_(options_.width, options_.height, options_.count_pixel_tests),
        samples_meter_([this](const Progress& /*of a stage*/) { return tell_samples(); }),
        meter_(sample_.count == 1 ? *meter : samples_meter_) {
    const MethodSettings method = settings_for(options_);
    keys_ = sorts_by_keys(method) ? Keys::kMade : Keys::kNone;
    statistics_.key = key_name(method);
    statistics_.bound = bound_name(method);
    if (sample_.count == 1 || input.camera.aperture == 0) return;
    camera_.lens_radius = 0.5f * input.camera.aperture;
    camera_.focus =
        input.camera.focus > 0 ? input.camera.focus : geometry_.depth_of_middle(camera_, &meter_);
  }

  RenderResult run() {
    while (true) {
      take_sample();
      if (++sample_.index == sample_.count) break;
      if (!options_.on_sample) continue;
      RenderResult so_far = film_.developed(executor_, options_.exposure);
      so_far.ambient = sky_;
      so_far.statistics = statistics_;
      complete(&so_far.statistics);
      if (!options_.on_sample(so_far)) break;
    }
    RenderResult result = film_.taken(executor_, options_.exposure);
    result.ambient = sky_;
    result.statistics = std::move(statistics_);
    complete(&result.statistics);
    return result;
  }

 private:
  void complete(FrameStatistics* statistics) const {
    if (input_.complete) input_.complete(statistics);
  }

  [[nodiscard]] std::size_t pixel_count() const {
    return std::size_t{options_.width} * options_.height;
  }

  /// A picture of one ray a pixel, added to the film.
  void take_sample() {
    Stopwatch watch;
    std::vector<std::size_t> plan_sizes;
    for (const BatchStatistics& batch : statistics_.batches)
      plan_sizes.push_back(batch.plan.size());
    const SampleStatistics before = totals();
    Fragments fragments = see();
    if (sample_.index == 0) sky_ = uniform_sky(fragments);
    follow_light(std::move(fragments), 1);
    // The plan of a batch is that of the first sample which had it.
    for (std::size_t i = 0; i < plan_sizes.size(); ++i)
      statistics_.batches[i].plan.resize(plan_sizes[i]);
    SampleStatistics sample = totals();
    sample.rays -= before.rays;
    sample.total_tests -= before.total_tests;
    sample.hits -= before.hits;
    sample.ms = watch.lap_ms();
    statistics_.samples.push_back(sample);
  }

  [[nodiscard]] Vec3 uniform_sky(const Fragments& fragments) const {
    if (options_.ambient) return *options_.ambient;
    if (input_.environment != nullptr) return {0, 0, 0};
    return automatic_sky(executor_, fragments, lights_);
  }

  /// Of all batches so far.
  [[nodiscard]] SampleStatistics totals() const {
    SampleStatistics sum;
    for (const BatchStatistics& batch : statistics_.batches) {
      sum.rays += batch.rays;
      sum.total_tests += batch.total_tests();
      sum.hits += batch.hits;
    }
    return sum;
  }

  /// Whatever a stage tells of its own progress, the caller hears of samples.
  [[nodiscard]] bool tell_samples() const {
    return !options_.progress || options_.progress({"samples", sample_.index, sample_.count});
  }

  /// Primary visibility: rasterised or traced, then fetched into the G-buffer.
  Fragments see() {
    CameraFrame frame = moved_by_pixels(camera_, filter_offset(sample_));
    frame.sample = sample_;
    Seeing seeing{frame, input_.rasterizer, nullptr, {}};
    watch_.lap_ms();
    if (seeing.rasterizer == nullptr) {
      seeing.statistics = &statistics_for(RayKind::kPrimary, 0);
      seeing.pixel_tests = film_.tests();
    }
    Fragments fragments = geometry_.see(seeing, &meter_);
    film_.see(executor_, fragments,
              [this](std::uint32_t triangle) { return geometry_.ids(triangle); });
    statistics_.raster_ms += watch_.lap_ms();
    return fragments;
  }

  /// The light of the fragments, then that of what their rays meet. Where paths split so often that
  /// the next fragments are too many, they go on in groups, one after the other.
  void follow_light(Fragments fragments, std::uint32_t bounce) {
    const bool last = bounce > options_.bounces;
    LargeVector<std::uint8_t> going_on(last ? 0 : fragments.size());
    gather_light(fragments, bounce, last, going_on);
    if (last) return;
    Fragments next = next_fragments(fragments, going_on, bounce);
    going_on = {};
    fragments = {};
    while (next.size() > kMostFragments) {
      const auto rest = next.end() - static_cast<std::ptrdiff_t>(kMostFragments);
      Fragments group(rest, next.end());
      next.erase(rest, next.end());
      follow_light(std::move(group), bounce + 1);
    }
    if (!next.empty()) follow_light(std::move(next), bounce + 1);
  }

  /// Shadow rays, then the light that leaves the fragments, into the pixels. `going_on`: as
  /// `shade_glow` has it.
  void gather_light(const Fragments& fragments, std::uint32_t bounce, bool last,
                    View<std::uint8_t> going_on) {
    const TracedParts traced{options_.reflections && !last, options_.refractions && !last};
    meter_.begin("shading, bounce " + std::to_string(bounce), 1);
    watch_.lap_ms();
    LargeVector<Vec3> radiance =
        shade_glow(executor_, fragments, sky_, traced, input_.environment, going_on);
    statistics_.shade_ms += watch_.lap_ms();
    const auto lights = static_cast<std::uint32_t>(lights_.size);
    const auto group = static_cast<std::uint32_t>(std::clamp<std::size_t>(
        geometry_.most_shadow_rays() / fragments.size(), 1, std::max(lights, 1u)));
    for (std::uint32_t first = 0; first < lights; first += group) {
      const std::uint32_t count = std::min(group, lights - first);
      const Visibilities visibility = look_at_lights(fragments, bounce, first, count);
      watch_.lap_ms();
      shade_lights(executor_, fragments, {lights_.slice(first, count), first, sample_}, visibility,
                   radiance);
      statistics_.shade_ms += watch_.lap_ms();
    }
    if (input_.environment != nullptr) {
      const Visibilities visibility = look_at_sky(fragments, bounce);
      watch_.lap_ms();
      shade_sky(executor_, fragments, *input_.environment, sample_, visibility, radiance);
      statistics_.shade_ms += watch_.lap_ms();
    }
    watch_.lap_ms();
    accumulate(executor_, fragments, radiance, film_.beauty());
    statistics_.shade_ms += watch_.lap_ms();
  }

  Visibilities look_at_lights(const Fragments& fragments, std::uint32_t bounce,
                              std::uint32_t first_light, std::uint32_t light_count) {
    watch_.lap_ms();
    Visibilities visibility =
        cast_shadows(fragments, bounce, light_count,
                     make_shadow_rays(executor_, fragments, lights_, first_light, light_count,
                                      geometry_.bounds(), sample_, keys_));
    if (bounce == 1) tally_shadows(light_count, visibility);
    return visibility;
  }

  Visibilities look_at_sky(const Fragments& fragments, std::uint32_t bounce) {
    watch_.lap_ms();
    return cast_shadows(fragments, bounce, kSkyStrategies,
                        make_sky_rays(executor_, fragments, *input_.environment, geometry_.bounds(),
                                      sample_, keys_));
  }

  /// `per_fragment`: how many slots of the batch each fragment has.
  Visibilities cast_shadows(const Fragments& fragments, std::uint32_t bounce,
                            std::size_t per_fragment, RayBatch batch) {
    batch.bounce = bounce;
    batch.width = options_.width;
    Visibilities visibility(fragments.size() * per_fragment, Visibility::kNoRay);
    LargeVector<std::uint8_t> occluded(batch.rays.size());
    if (options_.shadows) {
      BatchStatistics& statistics = statistics_for(RayKind::kShadow, bounce);
      statistics.times_ms.raygen += watch_.lap_ms();
      std::vector<float> tests = room_for_tests(batch);
      geometry_.find_occluded(batch, options_.early_out, &statistics, tests, &meter_, occluded);
      add_tests(batch, fragments, tests);
    } else {
      std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    }
    watch_.lap_ms();
    executor_.for_each(batch.slots.size(), kWorkGrain, [&](std::size_t i) {
      visibility[batch.slots[i]] = occluded[i] != 0 ? Visibility::kOccluded : Visibility::kVisible;
    });
    statistics_.shade_ms += watch_.lap_ms();
    return visibility;
  }

  /// How many of the lights each pixel faces, and how many of those reach it.
  void tally_shadows(std::uint32_t light_count, const Visibilities& visibility) {
    const View<std::uint32_t> faced = film_.lights_faced(), arrived = film_.lights_arrived();
    executor_.for_each(pixel_count(), kWorkGrain, [&](std::size_t pixel) {
      for (std::uint32_t l = 0; l < light_count; ++l) {
        const Visibility v = visibility[l * pixel_count() + pixel];
        faced[pixel] += v != Visibility::kNoRay ? 1 : 0;
        arrived[pixel] += v == Visibility::kVisible ? 1 : 0;
      }
    });
  }

  /// Reflections and refractions: what they meet are the next fragments, sorted by pixel. What they
  /// miss is sky.
  Fragments next_fragments(const Fragments& fragments, View<const std::uint8_t> going_on,
                           std::uint32_t bounce) {
    Fragments reflected, refracted;
    if (options_.reflections) reflected = follow(fragments, going_on, RayKind::kReflection, bounce);
    if (options_.refractions) refracted = follow(fragments, going_on, RayKind::kRefraction, bounce);
    if (refracted.empty()) return reflected;
    if (reflected.empty()) return refracted;
    watch_.lap_ms();
    Fragments merged = merged_by_pixel(executor_, reflected, refracted);
    statistics_.shade_ms += watch_.lap_ms();
    return merged;
  }

  Fragments follow(const Fragments& fragments, View<const std::uint8_t> going_on, RayKind kind,
                   std::uint32_t bounce) {
    meter_.begin(std::string(to_string(kind)) + " rays, bounce " + std::to_string(bounce), 1);
    watch_.lap_ms();
    RayBatch batch =
        make_bounce_rays(executor_, fragments, kind, geometry_.bounds(), keys_, going_on);
    if (batch.rays.empty()) return {};
    batch.bounce = bounce;
    batch.width = options_.width;
    BatchStatistics& statistics = statistics_for(kind, bounce);
    statistics.times_ms.raygen += watch_.lap_ms();
    std::vector<float> tests = room_for_tests(batch);
    const std::vector<RayHit> hits = geometry_.trace(batch, &statistics, tests, &meter_);
    add_tests(batch, fragments, tests);
    watch_.lap_ms();
    Fragments arrived(hits.size());
    executor_.for_each(hits.size(), kWorkGrain, [&](std::size_t i) {
      const Fragment& from = fragments[batch.slots[i]];
      Fragment& f = arrived[i] = {};  // all but the surface
      f.weight = batch.weights[i];
      f.pixel = from.pixel;
      f.path = mixed_seed(from.path, static_cast<std::uint32_t>(kind));
      f.incoming = batch.rays[i].direction;
      f.triangle = hits[i].triangle;
    });
    geometry_.fetch_surfaces(batch.rays, arrived);
    statistics_.shade_ms += watch_.lap_ms();
    return arrived;
  }

  /// A count a ray, where pixels' tests are asked for.
  [[nodiscard]] std::vector<float> room_for_tests(const RayBatch& batch) {
    return std::vector<float>(film_.tests().empty() ? 0 : batch.rays.size());
  }
  void add_tests(const RayBatch& batch, const Fragments& fragments,
                 const std::vector<float>& tests) {
    const View<float> sums = film_.tests();
    for (std::size_t i = 0; i < tests.size(); ++i)
      sums[fragments[batch.slots[i] % fragments.size()].pixel] += tests[i];
  }

  BatchStatistics& statistics_for(RayKind kind, std::uint32_t bounce) {
    auto& batches = statistics_.batches;
    const auto found = std::find_if(batches.begin(), batches.end(), [&](const BatchStatistics& b) {
      return b.kind == kind && b.bounce == bounce;
    });
    if (found != batches.end()) return *found;
    batches.emplace_back();
    batches.back().kind = kind;
    batches.back().bounce = bounce;
    batches.back().triangles = geometry_.triangle_count();
    return batches.back();
  }

  const Executor& executor_;
  FrameGeometry& geometry_;
  const View<const Light> lights_;
  const FrameInput& input_;
  const RenderOptions& options_;
  SampleOf sample_;
  Keys keys_ = Keys::kMade;
  CameraFrame camera_;  ///< its rays go through the pixels' centres
  Film film_;
  ProgressMeter samples_meter_;
  ProgressMeter& meter_;
  FrameStatistics statistics_;
  Vec3 sky_;
  Stopwatch watch_;
};

}  // namespace

MethodSettings settings_for(const RenderOptions& options) {
  MethodSettings settings = method_settings(options.method);
  settings.key = options.key.value_or(settings.key);
  settings.key_bits = options.key_bits.value_or(settings.key_bits);
  settings.bound = options.bound.value_or(settings.bound);
  settings.mesh_culling = options.mesh_culling.value_or(settings.mesh_culling);
  settings.levels = options.levels;
  settings.branching = options.branching;
  return settings;
}

RenderResult render_frame(const Executor& executor, const FrameInput& input, ProgressMeter* meter) {
  return Frame(executor, input, meter).run();
}

}  // namespace raysheaf
