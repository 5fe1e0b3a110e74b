#include "render/frame/cpu_paths.h"

#include <algorithm>
#include <string>
#include <utility>

#include "render/rays/scatter_body.h"
#include "render/rays/sky_body.h"

namespace raysheaf {
namespace {

/// Both ascend by pixel and have fragments; in a pixel of both, those of `a` come before those of
/// `b`.
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
  LargeVector<Vec3> radiance;          ///< set by `glow`
  LargeVector<std::uint8_t> going_on;  ///< as in `shade_glow`; empty if all paths end
};

CpuSet& of(FragmentSet& set) {
  return static_cast<CpuSet&>(set);
}
const CpuSet& of(const FragmentSet& set) {
  return static_cast<const CpuSet&>(set);
}

}  // namespace

PathStages::Set CpuPaths::see(std::size_t group) {
  watch_.lap_ms();
  group_ = group;
  Fragments& kept = frame_.kept[group];
  Fragments fragments = kept.empty() ? first_hits(group) : std::move(kept);
  if (frame_.sharing != nullptr) frame_.sharing->note(fragments);
  frame_.film.see(executor_, fragments,
                  [this](std::uint32_t triangle) { return geometry_.ids(triangle); });
  statistics().raster_ms += watch_.lap_ms();
  return std::make_unique<CpuSet>(std::move(fragments));
}

void CpuPaths::glow(FragmentSet& set, const GlowInput& input) {
  CpuSet& s = of(set);
  watch_.lap_ms();
  s.going_on.resize(input.last ? 0 : s.fragments.size());
  s.radiance =
      shade_glow(executor_, s.fragments, {input.sky, frame_.environment, input.room, input.behind},
                 input.traced, s.going_on);
  statistics().shade_ms += watch_.lap_ms();
}

std::uint32_t CpuPaths::add_lights(FragmentSet& set, std::uint32_t bounce, std::uint32_t first) {
  CpuSet& s = of(set);
  const auto left = static_cast<std::uint32_t>(frame_.lights.size) - first;
  const auto count = static_cast<std::uint32_t>(std::clamp<std::size_t>(
      geometry_.most_shadow_rays() / s.fragments.size(), 1, std::max(left, 1u)));
  watch_.lap_ms();
  const Visibilities visibility =
      cast_shadows(s.fragments, bounce, count,
                   make_shadow_rays(executor_, s.fragments, frame_.lights, first, count,
                                    geometry_.bounds(), frame_.sample, keys_));
  if (bounce == 1) tally_shadows(s.fragments, count, visibility);
  watch_.lap_ms();
  shade_lights(executor_, s.fragments, {frame_.lights.slice(first, count), first, frame_.sample},
               visibility, s.radiance);
  statistics().shade_ms += watch_.lap_ms();
  return count;
}

void CpuPaths::add_environment(FragmentSet& set, std::uint32_t bounce) {
  if (frame_.environment == nullptr) return;
  CpuSet& s = of(set);
  watch_.lap_ms();
  const Visibilities visibility =
      cast_shadows(s.fragments, bounce, kSkyStrategies,
                   make_sky_rays(executor_, s.fragments, *frame_.environment, geometry_.bounds(),
                                 frame_.sample, keys_));
  watch_.lap_ms();
  shade_sky(executor_, s.fragments, *frame_.environment, frame_.sample, visibility, s.radiance);
  statistics().shade_ms += watch_.lap_ms();
}

void CpuPaths::deposit(const FragmentSet& set) {
  watch_.lap_ms();
  accumulate(executor_, of(set).fragments, of(set).radiance, frame_.film.beauty());
  statistics().shade_ms += watch_.lap_ms();
}

PathStages::Set CpuPaths::follow(const FragmentSet& set, RayKind kind, std::uint32_t bounce) {
  const Fragments& fragments = of(set).fragments;
  watch_.lap_ms();
  RayBatch batch =
      make_bounce_rays(executor_, fragments, kind, geometry_.bounds(), keys_, of(set).going_on);
  if (batch.rays.empty()) return nullptr;
  tell_of(bounce, &batch);
  BatchStatistics& counted = tally_.batch(kind, bounce);
  counted.times_ms.raygen += watch_.lap_ms();
  std::vector<float> tests = room_for_tests(batch);
  const std::vector<RayHit> hits = geometry_.trace(batch, &counted, tests, &meter_);
  add_tests(batch, fragments, tests);
  watch_.lap_ms();
  Fragments arrived(hits.size());
  executor_.for_each(hits.size(), kWorkGrain, [&](std::size_t i) {
    const Fragment& from = fragments[batch.slots[i]];
    Fragment& f = arrived[i];
    begin_fragment(&f, hits[i].triangle, from.pixel);
    f.weight = batch.weights[i];
    f.path = mixed_seed(from.path, static_cast<std::uint32_t>(kind));
    f.incoming = batch.rays[i].direction;
  });
  geometry_.fetch_surfaces(batch.rays, arrived);
  statistics().shade_ms += watch_.lap_ms();
  return std::make_unique<CpuSet>(std::move(arrived));
}

PathStages::Set CpuPaths::merged(Set a, Set b) {
  watch_.lap_ms();
  Fragments all = merged_by_pixel(executor_, of(*a).fragments, of(*b).fragments);
  statistics().shade_ms += watch_.lap_ms();
  return std::make_unique<CpuSet>(std::move(all));
}

PathStages::Set CpuPaths::split_off(FragmentSet& set, std::size_t first) {
  Fragments& all = of(set).fragments;
  const auto rest = all.begin() + static_cast<std::ptrdiff_t>(first);
  Fragments group(rest, all.end());
  all.erase(rest, all.end());
  return std::make_unique<CpuSet>(std::move(group));
}

CpuPaths::Visibilities CpuPaths::cast_shadows(const Fragments& fragments, std::uint32_t bounce,
                                              std::size_t per_fragment, RayBatch batch) {
  tell_of(bounce, &batch);
  Visibilities visibility(fragments.size() * per_fragment, Visibility::kNoRay);
  LargeVector<std::uint8_t> occluded(batch.rays.size());
  if (frame_.options.shadows) {
    BatchStatistics& counted = tally_.batch(RayKind::kShadow, bounce);
    counted.times_ms.raygen += watch_.lap_ms();
    std::vector<float> tests = room_for_tests(batch);
    geometry_.find_occluded(batch, frame_.options.early_out, &counted, tests, &meter_, occluded);
    add_tests(batch, fragments, tests);
  } else {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
  }
  watch_.lap_ms();
  executor_.for_each(batch.slots.size(), kWorkGrain, [&](std::size_t i) {
    visibility[batch.slots[i]] = occluded[i] != 0 ? Visibility::kOccluded : Visibility::kVisible;
  });
  statistics().shade_ms += watch_.lap_ms();
  return visibility;
}

void CpuPaths::tally_shadows(const Fragments& first_hits, std::uint32_t light_count,
                             const Visibilities& visibility) {
  const View<std::uint32_t> faced = frame_.film.lights_faced(),
                            arrived = frame_.film.lights_arrived();
  executor_.for_each(first_hits.size(), kWorkGrain, [&](std::size_t i) {
    const std::uint32_t pixel = first_hits[i].pixel;
    for (std::uint32_t l = 0; l < light_count; ++l) {
      const Visibility v = visibility[l * first_hits.size() + i];
      faced[pixel] += v != Visibility::kNoRay ? 1 : 0;
      arrived[pixel] += v == Visibility::kVisible ? 1 : 0;
    }
  });
}

void CpuPaths::tell_of(std::uint32_t bounce, RayBatch* batch) const {
  batch->bounce = bounce;
  batch->width = frame_.options.width;
  const std::size_t groups = frame_.kept.size();
  batch->part = groups > 1;
  const std::size_t number = frame_.sample.index * groups + group_;
  batch->tells_plan = frame_.tally.wants_plan(batch->kind, bounce, number) &&
                      tally_.wants_plan(batch->kind, bounce, number);
}

std::vector<float> CpuPaths::room_for_tests(const RayBatch& batch) {
  return std::vector<float>(frame_.film.tests().empty() ? 0 : batch.rays.size());
}
void CpuPaths::add_tests(const RayBatch& batch, const Fragments& fragments,
                         const std::vector<float>& tests) {
  const View<float> sums = frame_.film.tests();
  for (std::size_t i = 0; i < tests.size(); ++i)
    sums[fragments[batch.slots[i] % fragments.size()].pixel] += tests[i];
}

Fragments CpuPaths::first_hits(std::size_t group) {
  const std::size_t number = frame_.sample.index * frame_.kept.size() + group;
  const bool tells_plan = frame_.tally.wants_plan(RayKind::kPrimary, 0, number) &&
                          tally_.wants_plan(RayKind::kPrimary, 0, number);
  return geometry_.first_hits(
      group,
      {[this]() -> BatchStatistics& { return tally_.batch(RayKind::kPrimary, 0); }, tells_plan});
}

void CpuPaths::find_sky(std::size_t group, bool keep, View<SkyPart> parts) {
  watch_.lap_ms();
  Fragments fragments = first_hits(group);
  statistics().raster_ms += watch_.lap_ms();
  const std::vector<SkyPart> found = sky_parts(executor_, fragments, frame_.lights);
  for (std::size_t i = 0; i < found.size(); ++i)
    parts[fragments[i * kSkyPart].pixel / kSkyPart] = found[i];
  statistics().shade_ms += watch_.lap_ms();
  if (keep) frame_.kept[group] = std::move(fragments);
}

}  // namespace raysheaf
