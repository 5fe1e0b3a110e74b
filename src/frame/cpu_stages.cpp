#include "frame/cpu_stages.h"

#include <algorithm>
#include <string>
#include <utility>

#include "exec/stopwatch.h"
#include "frame/film.h"
#include "raygen/scatter_body.h"
#include "raygen/sky_body.h"

namespace raysheaf {
namespace {

/// First hits that are kept from one look at all of them to the next; more are fetched twice.
constexpr std::size_t kMostKept = std::size_t{1} << 21;

/// A slot of a batch of shadow rays each.
using Visibilities = std::vector<Visibility>;

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

class CpuSet : public FragmentSet {
 public:
  explicit CpuSet(Fragments all) : fragments(std::move(all)) {}
  [[nodiscard]] std::size_t size() const override { return fragments.size(); }

  Fragments fragments;
  LargeVector<Vec3> radiance;          ///< from `glow` on
  LargeVector<std::uint8_t> going_on;  ///< as `shade_glow` has it; nothing where all end
};

class CpuStages : public FrameStages {
 public:
  CpuStages(const Executor& executor, const FrameInput& input, Keys keys, FrameTally* tally,
            ProgressMeter* meter)
      : executor_(executor),
        geometry_(input.geometry),
        lights_(input.lights),
        environment_(input.environment),
        options_(input.options),
        rasterizer_(input.rasterizer),
        keys_(keys),
        tally_(*tally),
        statistics_(tally->statistics),
        meter_(*meter),
        film_(options_.width, options_.height, options_.count_pixel_tests) {}

  std::size_t look(const CameraFrame& frame) override {
    sample_ = frame.sample;
    watch_.lap_ms();
    const auto of_rays = [this]() -> BatchStatistics& {
      return tally_.batch(RayKind::kPrimary, 0);
    };
    kept_.clear();
    kept_.resize(geometry_.look({frame, rasterizer_, of_rays, film_.tests()}, &meter_));
    film_.begin_sample();
    statistics_.raster_ms += watch_.lap_ms();
    return kept_.size();
  }

  Vec3 find_sky() override {
    if (lights_.empty()) return kWhiteSky;
    std::vector<SkyPart> parts;
    std::size_t kept = 0;
    for (std::size_t group = 0; group < kept_.size(); ++group) {
      Fragments fragments = first_hits(group);
      const std::vector<SkyPart> more = sky_parts(executor_, fragments, lights_);
      parts.insert(parts.end(), more.begin(), more.end());
      statistics_.shade_ms += watch_.lap_ms();
      kept += fragments.size();
      if (kept_.size() == 1 || kept <= kMostKept) kept_[group] = std::move(fragments);
    }
    return sky_of_parts(parts);
  }

  Set see(std::size_t group) override {
    Fragments fragments = kept_[group].empty() ? first_hits(group) : std::move(kept_[group]);
    watch_.lap_ms();
    film_.see(executor_, fragments,
              [this](std::uint32_t triangle) { return geometry_.ids(triangle); });
    statistics_.raster_ms += watch_.lap_ms();
    return std::make_unique<CpuSet>(std::move(fragments));
  }

  void glow(FragmentSet& set, const GlowInput& input) override {
    CpuSet& s = of(set);
    watch_.lap_ms();
    s.going_on.resize(input.last ? 0 : s.fragments.size());
    s.radiance =
        shade_glow(executor_, s.fragments, input.sky, input.traced, environment_, s.going_on);
    statistics_.shade_ms += watch_.lap_ms();
  }

  std::uint32_t add_lights(FragmentSet& set, std::uint32_t bounce, std::uint32_t first) override {
    CpuSet& s = of(set);
    const auto left = static_cast<std::uint32_t>(lights_.size) - first;
    const auto count = static_cast<std::uint32_t>(std::clamp<std::size_t>(
        geometry_.most_shadow_rays() / s.fragments.size(), 1, std::max(left, 1u)));
    watch_.lap_ms();
    const Visibilities visibility =
        cast_shadows(s.fragments, bounce, count,
                     make_shadow_rays(executor_, s.fragments, lights_, first, count,
                                      geometry_.bounds(), sample_, keys_));
    if (bounce == 1) tally_shadows(s.fragments, count, visibility);
    watch_.lap_ms();
    shade_lights(executor_, s.fragments, {lights_.slice(first, count), first, sample_}, visibility,
                 s.radiance);
    statistics_.shade_ms += watch_.lap_ms();
    return count;
  }

  void add_environment(FragmentSet& set, std::uint32_t bounce) override {
    if (environment_ == nullptr) return;
    CpuSet& s = of(set);
    watch_.lap_ms();
    const Visibilities visibility = cast_shadows(
        s.fragments, bounce, kSkyStrategies,
        make_sky_rays(executor_, s.fragments, *environment_, geometry_.bounds(), sample_, keys_));
    watch_.lap_ms();
    shade_sky(executor_, s.fragments, *environment_, sample_, visibility, s.radiance);
    statistics_.shade_ms += watch_.lap_ms();
  }

  void deposit(const FragmentSet& set) override {
    watch_.lap_ms();
    accumulate(executor_, of(set).fragments, of(set).radiance, film_.beauty());
    statistics_.shade_ms += watch_.lap_ms();
  }

  Set follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) override {
    const Fragments& fragments = of(set).fragments;
    watch_.lap_ms();
    RayBatch batch =
        make_bounce_rays(executor_, fragments, kind, geometry_.bounds(), keys_, of(set).going_on);
    if (batch.rays.empty()) return nullptr;
    batch.bounce = bounce;
    batch.width = options_.width;
    batch.part = kept_.size() > 1;
    BatchStatistics& statistics = tally_.batch(kind, bounce);
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
    return std::make_unique<CpuSet>(std::move(arrived));
  }

  Set merged(Set a, Set b) override {
    watch_.lap_ms();
    Fragments all = merged_by_pixel(executor_, of(*a).fragments, of(*b).fragments);
    statistics_.shade_ms += watch_.lap_ms();
    return std::make_unique<CpuSet>(std::move(all));
  }

  Set split_off(FragmentSet& set, std::size_t first) override {
    Fragments& all = of(set).fragments;
    const auto rest = all.begin() + static_cast<std::ptrdiff_t>(first);
    Fragments group(rest, all.end());
    all.erase(rest, all.end());
    return std::make_unique<CpuSet>(std::move(group));
  }

  FilmSums film(bool taken) override { return taken ? film_.taken() : film_.sums(); }

 private:
  static CpuSet& of(FragmentSet& set) { return static_cast<CpuSet&>(set); }
  static const CpuSet& of(const FragmentSet& set) { return static_cast<const CpuSet&>(set); }

  Fragments first_hits(std::size_t group) {
    watch_.lap_ms();
    Fragments fragments = geometry_.first_hits(group);
    statistics_.raster_ms += watch_.lap_ms();
    return fragments;
  }

  /// `per_fragment`: how many slots of the batch each fragment has.
  Visibilities cast_shadows(const Fragments& fragments, std::uint32_t bounce,
                            std::size_t per_fragment, RayBatch batch) {
    batch.bounce = bounce;
    batch.width = options_.width;
    batch.part = kept_.size() > 1;
    Visibilities visibility(fragments.size() * per_fragment, Visibility::kNoRay);
    LargeVector<std::uint8_t> occluded(batch.rays.size());
    if (options_.shadows) {
      BatchStatistics& statistics = tally_.batch(RayKind::kShadow, bounce);
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
  void tally_shadows(const Fragments& first_hits, std::uint32_t light_count,
                     const Visibilities& visibility) {
    const View<std::uint32_t> faced = film_.lights_faced(), arrived = film_.lights_arrived();
    executor_.for_each(first_hits.size(), kWorkGrain, [&](std::size_t i) {
      const std::uint32_t pixel = first_hits[i].pixel;
      for (std::uint32_t l = 0; l < light_count; ++l) {
        const Visibility v = visibility[l * first_hits.size() + i];
        faced[pixel] += v != Visibility::kNoRay ? 1 : 0;
        arrived[pixel] += v == Visibility::kVisible ? 1 : 0;
      }
    });
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

  const Executor& executor_;
  FrameGeometry& geometry_;
  const View<const PlacedLight> lights_;
  const EnvironmentView* const environment_;
  const RenderOptions& options_;
  Rasterizer* const rasterizer_;
  const Keys keys_;
  FrameTally& tally_;
  FrameStatistics& statistics_;
  ProgressMeter& meter_;
  Film film_;
  SampleOf sample_;
  std::vector<Fragments> kept_;  ///< of each of the sample's groups, what `find_sky` has for `see`
  Stopwatch watch_;
};

}  // namespace

std::unique_ptr<FrameStages> make_cpu_stages(const Executor& executor, const FrameInput& input,
                                             Keys keys, FrameTally* tally, ProgressMeter* meter) {
  return std::make_unique<CpuStages>(executor, input, keys, tally, meter);
}

}  // namespace raysheaf
