#include "frame/frame.h"

#include <algorithm>
#include <string>
#include <utility>

#include "frame/stopwatch.h"
#include "raster/gbuffer.h"
#include "raygen/raygen.h"
#include "raygen/scatter_body.h"
#include "shade/shade.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 1024;

/// Shadow slots that are worked on at once; more lights go in groups, so that memory stays bounded.
constexpr std::size_t kMostShadowSlots = std::size_t{1} << 24;
/// Secondary fragments that are worked on at once.
constexpr std::size_t kMostFragments = std::size_t{1} << 22;

Vec3 xyz(Vec4 v) {
  return {v.x, v.y, v.z};
}

/// The method's settings with what was asked for in their place.
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

class Frame {
 public:
  Frame(const Executor& executor, const FrameInput& input, ProgressMeter* meter)
      : executor_(executor),
        scene_(input.scene),
        lights_(input.lights),
        input_(input),
        options_(input.options),
        meter_(*meter) {
    trace_.method = settings_for(options_);
    trace_.cache = &trace_cache_;
    trace_.backend = input_.backend;
    result_.statistics.key = key_name(trace_.method);
    result_.statistics.bound = bound_name(trace_.method);
    result_.width = options_.width;
    result_.height = options_.height;
    result_.beauty.resize(pixel_count());
    if (options_.count_pixel_tests) result_.tests.resize(pixel_count());
    rays_faced_.resize(pixel_count());
    rays_arrived_.resize(pixel_count());
  }

  RenderResult run() {
    std::vector<Fragment> fragments = see();
    sky_ = options_.ambient ? *options_.ambient : automatic_sky(executor_, fragments, lights_);
    follow_light(std::move(fragments), 1);
    finish();
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::size_t pixel_count() const {
    return std::size_t{options_.width} * options_.height;
  }

  /// Primary visibility: rasterised or traced, then fetched into the G-buffer.
  std::vector<Fragment> see() {
    const PictureSize size{options_.width, options_.height};
    std::vector<std::uint32_t> triangles;
    watch_.lap_ms();
    if (options_.primary == Primary::kRaster) {
      meter_.begin("raster", 1);
      triangles = rasterize_primary(executor_, *input_.rasterizer, scene_, input_.camera, size);
    } else {
      BatchStatistics& batch = statistics_for(RayKind::kPrimary, 0);
      triangles = trace_primary(executor_, scene_, input_.camera, size, trace_.method, &batch,
                                result_.tests, &meter_, &trace_cache_, input_.backend);
    }
    meter_.begin("surfaces", 1);
    std::vector<Fragment> fragments =
        fetch_fragments(executor_, scene_, input_.textures, input_.camera, size, triangles);
    keep_gbuffer(fetch_gbuffer(executor_, scene_, fragments));
    result_.statistics.raster_ms = watch_.lap_ms();
    return fragments;
  }

  void keep_gbuffer(GBuffer g) {
    result_.position.resize(pixel_count());
    result_.normal.resize(pixel_count());
    result_.albedo.resize(pixel_count());
    executor_.for_each(pixel_count(), kGrain, [&](std::size_t i) {
      result_.position[i] = xyz(g.position[i]);
      result_.normal[i] = xyz(g.normal[i]);
      result_.albedo[i] = xyz(g.diffuse[i]) + xyz(g.specular[i]);
    });
    result_.ids = std::move(g.ids);
  }

  /// The light of the fragments, then that of what their rays meet. Where paths split so often that
  /// the next fragments are too many, they go on in groups, one after the other.
  void follow_light(std::vector<Fragment> fragments, std::uint32_t bounce) {
    const bool last = bounce > options_.bounces;
    gather_light(fragments, bounce, last);
    if (last) return;
    std::vector<Fragment> next = next_fragments(fragments, bounce);
    fragments = {};
    while (next.size() > kMostFragments) {
      const auto rest = next.end() - static_cast<std::ptrdiff_t>(kMostFragments);
      std::vector<Fragment> group(rest, next.end());
      next.erase(rest, next.end());
      follow_light(std::move(group), bounce + 1);
    }
    if (!next.empty()) follow_light(std::move(next), bounce + 1);
  }

  /// Shadow rays, then the light that leaves the fragments, into the pixels.
  void gather_light(const std::vector<Fragment>& fragments, std::uint32_t bounce, bool last) {
    const TracedParts traced{options_.reflections && !last, options_.refractions && !last};
    meter_.begin("shading, bounce " + std::to_string(bounce), 1);
    watch_.lap_ms();
    std::vector<Vec3> radiance = shade_glow(executor_, fragments, sky_, traced);
    result_.statistics.shade_ms += watch_.lap_ms();
    const auto lights = static_cast<std::uint32_t>(lights_.size);
    const auto group = static_cast<std::uint32_t>(
        std::clamp<std::size_t>(kMostShadowSlots / fragments.size(), 1, std::max(lights, 1u)));
    for (std::uint32_t first = 0; first < lights; first += group) {
      const std::uint32_t count = std::min(group, lights - first);
      const std::vector<Visibility> visibility = cast_shadows(fragments, bounce, first, count);
      watch_.lap_ms();
      shade_lights(executor_, fragments, lights_.slice(first, count), visibility, radiance);
      result_.statistics.shade_ms += watch_.lap_ms();
    }
    watch_.lap_ms();
    accumulate(executor_, fragments, radiance, result_.beauty);
    result_.statistics.shade_ms += watch_.lap_ms();
  }

  std::vector<Visibility> cast_shadows(const std::vector<Fragment>& fragments, std::uint32_t bounce,
                                       std::uint32_t first_light, std::uint32_t light_count) {
    watch_.lap_ms();
    RayBatch batch =
        make_shadow_rays(executor_, fragments, lights_, first_light, light_count, scene_.bounds);
    batch.bounce = bounce;
    batch.width = options_.width;
    std::vector<Visibility> visibility(fragments.size() * light_count, Visibility::kNoRay);
    std::vector<RayHit> hits(options_.shadows ? 0 : batch.rays.size());
    if (options_.shadows) {
      BatchStatistics& statistics = statistics_for(RayKind::kShadow, bounce);
      statistics.times_ms.raygen += watch_.lap_ms();
      hits = trace_batch(batch, fragments, options_.early_out, &statistics);
    }
    executor_.for_each(batch.slots.size(), kGrain, [&](std::size_t i) {
      visibility[batch.slots[i]] = hits[i].found() ? Visibility::kOccluded : Visibility::kVisible;
    });
    if (bounce == 1) tally_shadows(light_count, visibility);
    return visibility;
  }

  /// How many of the lights each pixel faces, and how many of those reach it.
  void tally_shadows(std::uint32_t light_count, const std::vector<Visibility>& visibility) {
    executor_.for_each(pixel_count(), kGrain, [&](std::size_t pixel) {
      for (std::uint32_t l = 0; l < light_count; ++l) {
        const Visibility v = visibility[l * pixel_count() + pixel];
        rays_faced_[pixel] += v != Visibility::kNoRay ? 1 : 0;
        rays_arrived_[pixel] += v == Visibility::kVisible ? 1 : 0;
      }
    });
  }

  /// Reflections and refractions: what they meet are the next fragments, sorted by pixel. What they
  /// miss is sky.
  std::vector<Fragment> next_fragments(const std::vector<Fragment>& fragments,
                                       std::uint32_t bounce) {
    std::vector<Fragment> reflected, refracted;
    if (options_.reflections) reflected = follow(fragments, RayKind::kReflection, bounce);
    if (options_.refractions) refracted = follow(fragments, RayKind::kRefraction, bounce);
    if (refracted.empty()) return reflected;
    if (reflected.empty()) return refracted;
    watch_.lap_ms();
    std::vector<Fragment> merged(reflected.size() + refracted.size());
    std::merge(reflected.begin(), reflected.end(), refracted.begin(), refracted.end(),
               merged.begin(),
               [](const Fragment& a, const Fragment& b) { return a.pixel < b.pixel; });
    result_.statistics.shade_ms += watch_.lap_ms();
    return merged;
  }

  std::vector<Fragment> follow(const std::vector<Fragment>& fragments, RayKind kind,
                               std::uint32_t bounce) {
    meter_.begin(std::string(to_string(kind)) + " rays, bounce " + std::to_string(bounce), 1);
    watch_.lap_ms();
    RayBatch batch = make_bounce_rays(executor_, fragments, kind, scene_.bounds);
    if (batch.rays.empty()) return {};
    batch.bounce = bounce;
    batch.width = options_.width;
    BatchStatistics& statistics = statistics_for(kind, bounce);
    statistics.times_ms.raygen += watch_.lap_ms();
    const std::vector<RayHit> hits = trace_batch(batch, fragments, false, &statistics);
    watch_.lap_ms();
    std::vector<Fragment> arrived(hits.size());
    executor_.for_each(hits.size(), kGrain, [&](std::size_t i) {
      arrived[i] = arrive(fragments[batch.slots[i]], kind, batch.rays[i], hits[i]);
    });
    result_.statistics.shade_ms += watch_.lap_ms();
    return arrived;
  }

  [[nodiscard]] Fragment arrive(const Fragment& from, RayKind kind, const Ray& ray,
                                const RayHit& hit) const {
    const Scattering s = scatter(from);
    Fragment f;
    f.weight = from.weight * (kind == RayKind::kReflection ? s.reflected_part : s.refracted_part);
    f.pixel = from.pixel;
    f.incoming = ray.direction;
    f.triangle = hit.triangle;
    if (!hit.found()) return f;
    TriangleHit where{};
    intersect_triangle(make_ray_setup(ray), scene_.corner(hit.triangle, 0),
                       scene_.corner(hit.triangle, 1), scene_.corner(hit.triangle, 2), &where);
    f.surface = surface_at(scene_, input_.textures, hit.triangle, where.u, where.v, ray.direction);
    return f;
  }

  std::vector<RayHit> trace_batch(const RayBatch& batch, const std::vector<Fragment>& fragments,
                                  bool early_out, BatchStatistics* statistics) {
    TraceOptions options = trace_;
    options.early_out = early_out;
    std::vector<float> tests(result_.tests.empty() ? 0 : batch.rays.size());
    std::vector<RayHit> hits = trace(executor_, scene_, batch, options, statistics, tests, &meter_);
    for (std::size_t i = 0; i < tests.size(); ++i)
      result_.tests[fragments[batch.slots[i] % fragments.size()].pixel] += tests[i];
    return hits;
  }

  BatchStatistics& statistics_for(RayKind kind, std::uint32_t bounce) {
    auto& batches = result_.statistics.batches;
    const auto found = std::find_if(batches.begin(), batches.end(), [&](const BatchStatistics& b) {
      return b.kind == kind && b.bounce == bounce;
    });
    if (found != batches.end()) return *found;
    batches.emplace_back();
    batches.back().kind = kind;
    batches.back().bounce = bounce;
    batches.back().triangles = scene_.triangle_count;
    return batches.back();
  }

  void finish() {
    result_.exposure =
        options_.exposure ? *options_.exposure : automatic_exposure(result_.beauty, result_.ids);
    result_.shadow.resize(pixel_count());
    for (std::size_t i = 0; i < pixel_count(); ++i) {
      const auto faced = static_cast<float>(rays_faced_[i]);
      result_.shadow[i] = faced > 0 ? static_cast<float>(rays_arrived_[i]) / faced : 1;
    }
  }

  const Executor& executor_;
  const FlatScene& scene_;
  const View<const Light> lights_;
  const FrameInput& input_;
  const RenderOptions& options_;
  ProgressMeter& meter_;
  TraceCache trace_cache_;
  TraceOptions trace_;
  RenderResult result_;
  Vec3 sky_;
  Stopwatch watch_;
  std::vector<std::uint32_t> rays_faced_, rays_arrived_;  ///< a pixel, of primary hits
};

}  // namespace

RenderResult render_frame(const Executor& executor, const FrameInput& input, ProgressMeter* meter) {
  return Frame(executor, input, meter).run();
}

}  // namespace raysheaf
