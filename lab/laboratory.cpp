// Batches of one scene, made once, and measurements with them.
#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "exec/stopwatch.h"
#include "lab/as_published.h"
#include "lab/bundle.h"
#include "lab/lab_rays.h"
#include "raysheaf/error.h"
#include "raysheaf/lab.h"
#include "raysheaf/paper.h"
#include "render/frame/brute_force.h"
#include "render/frame/primary.h"
#include "render/frame/ranges.h"
#include "render/frame/trace.h"
#include "render/raster/rasterizer.h"

namespace raysheaf {
namespace {

constexpr std::size_t kBatches = 4;
constexpr float kOcclusionReach = 0.25f;  ///< of the scene's diagonal

PictureSize checked(PictureSize size) {
  if (size.width < 1 || size.height < 1 || size.width > kLargestSide || size.height > kLargestSide)
    throw Error(ErrorCode::kInvalidArgument, "each side must be from 1 to 16384", "size");
  return size;
}

void check(const MethodSettings& settings) {
  check_hierarchy(settings.levels, settings.branching, settings.key_bits);
}

SceneDescription prepared(SceneDescription scene) {
  validate(scene);
  // Adds only one light, because each light adds a batch of shadow rays to the counts.
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (needs_light(scene)) scene.lights.push_back(showing_light(scene, scene.cameras.front()));
  return scene;
}

/// By OpenGL, or by rays if OpenGL is not available.
std::vector<std::uint32_t> visible_triangles(const Executor& executor, const FlatScene& scene,
                                             const CameraFrame& frame) {
  try {
    Rasterizer rasterizer;
    return rasterize_primary(executor, rasterizer, scene, frame);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNoGraphics) throw;
  }
  BatchStatistics not_kept;
  ProgressMeter meter;
  return trace_primary(executor, scene, frame, method_settings(Method::kDual), &not_kept, {},
                       &meter);
}

}  // namespace

class Laboratory::Impl {
 public:
  Impl(const SceneDescription& scene, PictureSize size, std::uint32_t threads)
      : size_(size),
        executor_(threads),
        description_(prepared(scene)),
        flat_(flatten(executor_, description_, mesh_bounds(executor_, description_))),
        textures_(description_) {
    use_paper_methods();
    const CameraFrame frame =
        make_camera_frame(description_.cameras.front(), size.width, size.height);
    const std::vector<std::uint32_t> seen = visible_triangles(executor_, flat_, frame);
    fragments_ = fetch_fragments(executor_, flat_, textures_, frame, seen);
  }

  const RayBatch& batch(LabRays rays) { return made(rays).batch; }

  BatchStatistics measure(LabRays rays, const MethodSettings& settings, bool compares) {
    check(settings);
    Made& m = made(rays);
    BatchStatistics statistics;
    statistics.times_ms.raygen = m.raygen_ms;
    const std::vector<RayHit> hits = traced(m.batch, settings, &statistics);
    if (compares) compare(hits, reference(m), m.batch);
    return statistics;
  }

  std::optional<RayBundle> bundle(LabRays rays, const MethodSettings& settings, std::uint32_t x,
                                  std::uint32_t y) {
    check(settings);
    if (x >= size_.width || y >= size_.height)
      throw Error(ErrorCode::kInvalidArgument, "this pixel is outside the image", "x, y");
    const RayBatch& batch = made(rays).batch;
    const auto found = std::find(batch.pixels.begin(), batch.pixels.end(), y * size_.width + x);
    if (found == batch.pixels.end()) return std::nullopt;
    const auto ray = static_cast<std::size_t>(found - batch.pixels.begin());
    return find_bundle(executor_, flat_, batch, ray, settings);
  }

  BatchStatistics as_published(LabRays rays, Method method, const Quirks& quirks,
                               PublishedShape shape) {
    if (method != Method::kRah && method != Method::kCrsh)
      throw Error(ErrorCode::kInvalidArgument, "only rah and crsh were published", "method");
    check_range("levels", shape.levels, 1, 32);
    check_range("branching", shape.branching, 2, ~0u);
    return count_as_published(executor_, flat_, batch(rays), method, quirks, size_.width, shape);
  }

 private:
  struct Made {
    RayBatch batch;
    double raygen_ms = 0;
    std::vector<RayHit> reference;  ///< brute force's hits, once requested
  };

  std::vector<RayHit> traced(const RayBatch& batch, const MethodSettings& settings,
                             BatchStatistics* statistics) {
    cache_.ordered.reset();  // each measurement builds its own hierarchies
    cache_.dual.reset();
    TraceOptions options;
    options.method = settings;
    options.cache = &cache_;
    ProgressMeter meter;
    return trace(executor_, flat_, batch, options, statistics, {}, &meter);
  }

  Made& made(LabRays rays) {
    std::optional<Made>& m = made_[static_cast<std::size_t>(rays)];
    if (m) return *m;
    const Fragments met = rays == LabRays::kReflection2 ? mirrored_fragments() : Fragments{};
    Stopwatch watch;
    Made result;
    result.batch = make(rays, met);
    result.batch.width = size_.width;
    result.raygen_ms = watch.lap_ms();
    m = std::move(result);
    return *m;
  }

  RayBatch make(LabRays rays, const Fragments& met) {
    const auto lights = static_cast<std::uint32_t>(description_.lights.size());
    switch (rays) {
      case LabRays::kShadow:
        return make_shadow_rays(executor_, fragments_, placed_lights(description_.lights), 0,
                                lights, flat_.bounds);
      case LabRays::kReflection1:
        return make_mirror_rays(executor_, fragments_, flat_.bounds, 1);
      case LabRays::kReflection2:
        return make_mirror_rays(executor_, met, flat_.bounds, 2);
      case LabRays::kAmbientOcclusion:
        break;
    }
    const float reach = kOcclusionReach * length(flat_.bounds.max - flat_.bounds.min);
    return make_occlusion_rays(executor_, fragments_, flat_.bounds, reach);
  }

  /// The hits of the primary hits' mirror rays.
  Fragments mirrored_fragments() {
    const RayBatch& first = batch(LabRays::kReflection1);
    BatchStatistics not_kept;
    const std::vector<RayHit> hits = traced(first, method_settings(Method::kDual), &not_kept);
    Fragments met(hits.size());
    executor_.for_each(met.size(), kWorkGrain, [&](std::size_t i) {
      Fragment& f = met[i] = {};
      f.pixel = first.pixels[i];
      f.incoming = first.rays[i].direction;
      f.triangle = hits[i].triangle;
      if (!hits[i].found()) return;
      TriangleHit where{};
      const auto [a, b, c] = flat_.corners(f.triangle);
      intersect_triangle(make_ray_setup(first.rays[i]), a, b, c, &where);
      f.surface = surface_at(flat_, textures_, f.triangle, where.u, where.v, f.incoming);
    });
    return met;
  }

  const std::vector<RayHit>& reference(Made& m) {
    if (m.reference.size() != m.batch.rays.size()) {
      std::vector<RayHit> hits(m.batch.rays.size());
      ProgressMeter meter;
      intersect_brute_force(executor_, flat_.source(), m.batch.rays, Facing::kBoth, hits, &meter);
      m.reference = std::move(hits);  // complete or not at all, because memory may run out
    }
    return m.reference;
  }

  /// For an unnamed triangle, only the existence of a hit is compared.
  static bool same(const RayHit& hit, const RayHit& expected) {
    if (hit.triangle == kSomeTriangle) return expected.found();
    return hit.t == expected.t && hit.triangle == expected.triangle;
  }

  static void compare(const std::vector<RayHit>& hits, const std::vector<RayHit>& expected,
                      const RayBatch& batch) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (same(hits[i], expected[i])) continue;
      throw Error(ErrorCode::kInternal, "a hit differs from brute force's",
                  std::string(to_string(batch.kind)) + " ray " + std::to_string(i) + ", bounce " +
                      std::to_string(batch.bounce));
    }
  }

  const PictureSize size_;
  const Executor executor_;
  const SceneDescription description_;
  const FlatScene flat_;
  TraceCache cache_;
  const TextureSet textures_;
  Fragments fragments_;
  std::array<std::optional<Made>, kBatches> made_;
};

Laboratory::Laboratory(const SceneDescription& scene, std::uint32_t width, std::uint32_t height,
                       std::uint32_t threads)
    : impl_(std::make_unique<Impl>(scene, checked({width, height}), threads)) {}

Laboratory::~Laboratory() = default;
Laboratory::Laboratory(Laboratory&&) noexcept = default;
Laboratory& Laboratory::operator=(Laboratory&&) noexcept = default;

std::uint64_t Laboratory::ray_count(LabRays rays) {
  return impl_->batch(rays).rays.size();
}

std::vector<Ray> Laboratory::rays(LabRays rays) {
  const RayBatch& batch = impl_->batch(rays);
  return {batch.rays.begin(), batch.rays.end()};
}

BatchStatistics Laboratory::measure(LabRays rays, const MethodSettings& settings, bool check) {
  return impl_->measure(rays, settings, check);
}

std::optional<RayBundle> Laboratory::bundle(LabRays rays, const MethodSettings& settings,
                                            std::uint32_t x, std::uint32_t y) {
  return impl_->bundle(rays, settings, x, y);
}

BatchStatistics Laboratory::measure_as_published(LabRays rays, Method method, const Quirks& quirks,
                                                 std::uint32_t levels, std::uint32_t branching) {
  return impl_->as_published(rays, method, quirks, {levels, branching});
}

}  // namespace raysheaf
