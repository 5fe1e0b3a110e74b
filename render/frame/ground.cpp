#include "render/frame/ground.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "animation/look_around.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/error.h"
#include "render/rays/camera_rays.h"
#include "scene/subject.h"

namespace raysheaf {
namespace {

/// The plane as the pixels of an image see it.
struct SeenGround {
  double up[3] = {0, 1, 0};
  double height = 0;
  CameraRays rays;  ///< of the current sample

  /// Makes each fragment that has no triangle one of the plane, where its ray meets that from
  /// above, and all others dark.
  void show_in(const Executor& executor, View<Fragment> fragments) const {
    executor.for_each(fragments.size, kWorkGrain, [&](std::size_t i) {
      const bool is_free = fragments[i].triangle == kInvalidId;
      fragments[i] = fragment(fragments[i].pixel, is_free);
    });
  }

 private:
  [[nodiscard]] double along(Vec3 v) const {
    return up[0] * double{v.x} + up[1] * double{v.y} + up[2] * double{v.z};
  }

  /// White and matte, or, if the scene hides the plane, without light.
  [[nodiscard]] Fragment fragment(std::uint32_t pixel, bool is_free) const {
    Fragment f;
    f.pixel = pixel;
    f.triangle = 0;
    Surface& s = f.surface;
    s.unlit = true;
    if (!is_free) return f;
    const std::uint32_t width = rays.frame().width;
    const Ray ray = rays.at(pixel % width, pixel / width);
    const double slope = along(ray.direction);
    const double t = (height - along(ray.origin)) / slope;
    if (!(slope < 0) || !(t >= ray.t_min && t <= ray.t_max)) return f;
    const Vec3 at = ray.origin + ray.direction * static_cast<float>(t);
    if (!is_finite(at)) return f;
    s.unlit = false;
    s.position = at;
    s.normal = s.geometric_normal = {static_cast<float>(up[0]), static_cast<float>(up[1]),
                                     static_cast<float>(up[2])};
    s.diffuse = {1, 1, 1};
    s.specular_edge = s.coat_edge = 0;
    // More than the roundings of the point.
    s.clearance = 8 * kUnitRoundoff * max_component(max(abs(ray.origin), abs(at)));
    f.incoming = normalized(ray.direction);
    return f;
  }
};

/// The scene for rays, and the plane for the eye. Paths end at the plane, so no surface of the
/// scene is asked for.
class GroundPaths : public virtual PathGeometry {
 public:
  GroundPaths(const Executor& executor, PathGeometry& scene, const SeenGround& ground)
      : executor_(executor), scene_(scene), ground_(ground) {}

  [[nodiscard]] const Box& bounds() const override { return scene_.bounds(); }
  [[nodiscard]] std::uint64_t triangle_count() const override { return scene_.triangle_count(); }
  [[nodiscard]] std::size_t most_shadow_rays() const override { return scene_.most_shadow_rays(); }
  [[nodiscard]] Fragments first_hits(std::size_t group, const FirstHitTally& tally) override {
    Fragments fragments = scene_.first_hits(group, tally);
    ground_.show_in(executor_, fragments);
    return fragments;
  }
  [[nodiscard]] std::vector<RayHit> trace(const RayBatch& batch, BatchStatistics* statistics,
                                          View<float> ray_tests, ProgressMeter* meter) override {
    return scene_.trace(batch, statistics, ray_tests, meter);
  }
  void find_occluded(const RayBatch& batch, bool early_out, BatchStatistics* statistics,
                     View<float> ray_tests, ProgressMeter* meter,
                     View<std::uint8_t> occluded) override {
    scene_.find_occluded(batch, early_out, statistics, ray_tests, meter, occluded);
  }
  void fetch_surfaces(View<const Ray> rays, View<Fragment> fragments) override {
    scene_.fetch_surfaces(rays, fragments);
  }
  [[nodiscard]] PixelIds ids(std::uint32_t /*triangle*/) const override { return {}; }

 private:
  const Executor& executor_;
  PathGeometry& scene_;
  const SeenGround& ground_;
};

struct HasScene {
  const Executor executor = Executor::serial();
  std::unique_ptr<PathGeometry> scene;
};

/// The same for one thread.
class ThreadGroundPaths : private HasScene, public GroundPaths {
 public:
  ThreadGroundPaths(std::unique_ptr<PathGeometry> own, const SeenGround& ground)
      : HasScene{Executor::serial(), std::move(own)}, GroundPaths(executor, *scene, ground) {}
};

class GroundGeometry : public FrameGeometry, public GroundPaths {
 public:
  GroundGeometry(const Executor& executor, FrameGeometry& scene, const SeenGround& ground)
      : GroundPaths(executor, scene, ground_), scene_(scene), ground_(ground) {}

  [[nodiscard]] std::size_t look(const Seeing& seeing, ProgressMeter* meter) override {
    ground_.rays = CameraRays(seeing.frame);
    return scene_.look(seeing, meter);
  }
  [[nodiscard]] float depth_of_middle(const CameraFrame& frame, ProgressMeter* meter) override {
    return scene_.depth_of_middle(frame, meter);
  }
  [[nodiscard]] bool is_shared() const override { return scene_.is_shared(); }
  [[nodiscard]] SharedWork share() override { return scene_.share(); }
  [[nodiscard]] std::unique_ptr<PathGeometry> of_one_thread() override {
    return std::make_unique<ThreadGroundPaths>(scene_.of_one_thread(), ground_);
  }
  void add_rays(std::uint64_t count) override { scene_.add_rays(count); }

 private:
  FrameGeometry& scene_;
  SeenGround ground_;
};

/// The radiance that the camera sees behind the scene, without the ground.
Vec3 background_at(const FrameInput& input, const CameraRays& rays, std::size_t pixel,
                   const RenderResult& image) {
  if (input.environment == nullptr) return image.ambient;
  const auto x = static_cast<std::uint32_t>(pixel % image.width),
             y = static_cast<std::uint32_t>(pixel / image.width);
  return environment_radiance(*input.environment, normalized(rays.at(x, y).direction));
}

}  // namespace

Ground ground_under(Animation& animation, UpAxis up) {
  Ground ground{up, std::nullopt};
  look_around(animation, [&](const SceneDescription& scene) {
    const float lowest = lowest_along(world_bounds(scene), direction_of(up));
    if (std::isfinite(lowest)) ground.height = std::min(ground.height.value_or(lowest), lowest);
  });
  return ground;
}

Ground placed_ground(Ground ground, const Box& bounds) {
  const Vec3 extent = bounds.max - bounds.min;
  if (!(max_component(extent) > 0))
    throw Error(ErrorCode::kInvalidData,
                "the scene has no extent, so it casts no shadow on a ground", "ground");
  if (!ground.height) ground.height = lowest_along(bounds, direction_of(ground.up));
  return ground;
}

RenderOptions ground_options(const RenderOptions& of_image, const RenderResult& image) {
  RenderOptions options;
  options.width = image.width;
  options.height = image.height;
  options.method = Method::kDual;
  options.primary = Primary::kTrace;
  options.bounces = 0;
  options.shadows = of_image.shadows;
  options.threads = of_image.threads;
  options.exposure = 1;
  options.ambient = image.ambient;
  if (of_image.progress)
    options.progress = [&of_image](const Progress& progress) {
      return of_image.progress({"ground", progress.done, progress.total});
    };
  // The image may have ended early.
  options.on_sample = [samples = image.samples](const RenderResult& so_far) {
    return so_far.samples < samples;
  };
  return options;
}

void add_ground(const Executor& executor, const FrameInput& input, const Ground& ground,
                RenderResult* image) {
  image->ground.assign(image->beauty.size(), 0);
  if (!input.options.shadows) return;
  const Vec3 up = direction_of(ground.up);
  const SeenGround seen{{double{up.x}, double{up.y}, double{up.z}}, double{*ground.height}, {}};
  GroundGeometry geometry(executor, input.geometry, seen);
  RenderOptions options = input.options;
  const auto render_lit = [&](bool shadows) {
    options.shadows = shadows;
    FrameInput own{geometry, input.camera, input.lights, options, input.samples};
    own.environment = input.environment;
    own.ranks = input.ranks;
    return render_frame(executor, own);
  };
  const RenderResult bright = render_lit(false), dark = render_lit(true);
  const CameraRays rays(make_camera_frame(input.camera, image->width, image->height));
  executor.for_each(image->beauty.size(), kWorkGrain, [&](std::size_t i) {
    const float lit = luminance(bright.beauty[i]);
    const float left = lit > 0 ? clamp(luminance(dark.beauty[i]) / lit, 0, 1) : 1;
    const float taken = bright.albedo[i].x * (1 - left);
    image->ground[i] = taken;
    if (!(taken > 0)) return;
    image->beauty[i] =
        max(image->beauty[i] - background_at(input, rays, i, *image) * taken, {0, 0, 0});
  });
}

}  // namespace raysheaf
