// The renderer: validates the input, updates what it has computed for the scene, and renders a
// frame. Only this file turns errors of lower layers into `Error`.
#include "raysheaf/renderer.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "api/scene/context_impl.h"
#include "base/large.h"
#include "exec/executor.h"
#include "exec/stopwatch.h"
#include "ranks/share.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "render/device/frame_backend.h"
#include "render/frame/frame.h"
#include "render/frame/ground.h"
#include "render/geometry/resident_geometry.h"
#include "render/raster/rasterizer.h"
#include "render/rays/light_body.h"
#include "render/render_input.h"
#include "render/shown_scene.h"

namespace raysheaf {
namespace {

/// Features that devices do not support.
void check_for_device(const RenderOptions& options) {
  const auto refuse = [](const char* sentence, const char* option) {
    throw Error(ErrorCode::kUnsupported, sentence, option);
  };
  if (options.method == Method::kDual || options.method == Method::kBrute) return;
  if (options.count_pixel_tests)
    refuse(
        "rah, crsh and gl10 do not count tests per pixel on a CUDA device, which heat maps and "
        "OpenEXR need",
        "tests");
  const RayKey key = options.key.value_or(RayKey::kCrsh);
  if (key != RayKey::kCrsh && key != RayKey::kRaster)
    refuse("a CUDA device sorts rays by the key crsh, or leaves them in raster order", "key");
  if (options.bundle_samples != 0)
    refuse("bundles of rays are not measured on a CUDA device", "bundle_samples");
  if (options.method == Method::kGl10) return;
  if (options.bound.value_or(BundleBound::kSphereCone) != BundleBound::kSphereCone)
    refuse("a CUDA device bounds rays only by sphere-cone", "bound");
}

const char* word_of(const TreeReport& tree) {
  if (!tree.used) return "none";
  switch (tree.work) {
    case TreeWork::kKeep:
      return "kept";
    case TreeWork::kRefit:
      return "refit";
    case TreeWork::kRebuildCoarsely:
      return "coarse rebuild";
    case TreeWork::kRebuild:
      return "rebuild";
    case TreeWork::kRebuildFinely:
      break;
  }
  return "fine rebuild";
}

/// A device that says when the host has to draw.
class WatchedDevice final : public SlotDevice {
 public:
  WatchedDevice(SlotDevice& device, std::function<void()> host_draws)
      : device_(device), host_draws_(std::move(host_draws)) {}
  [[nodiscard]] std::optional<std::uint32_t> pack(const PackedBatch& batch) override {
    const std::optional<std::uint32_t> shown = device_.pack(batch);
    if (!shown) host_draws_();
    return shown;
  }
  [[nodiscard]] bool take(const SlotPicture& picture) override {
    const bool taken = device_.take(picture);
    if (!taken) host_draws_();
    return taken;
  }

 private:
  SlotDevice& device_;
  const std::function<void()> host_draws_;
};

}  // namespace

class Renderer::Impl {
 public:
  Impl() = default;
  explicit Impl(const Context& context) : context_(context) {
    cache_.backend = ContextAccess::backend(context);
    cache_.ranks = ContextAccess::ranks(context);
  }

  void show(const SceneDescription& scene, const SceneChanges& changes) {
    scene_.show(scene, changes);
  }

  RenderResult render(const RenderOptions& wanted, const Camera* given) {
    try {
      RenderOptions options = wanted;
      const SceneDescription* const shown = scene_.description();
      if (options.width == 0 && options.height == 0 && shown != nullptr)
        set_default_size(given != nullptr ? *given : find_camera(*shown, options.camera), &options);
      check(options);
      if (orders_rays(method_settings(options).traversal)) static_cast<void>(batch_tracers());
      if (cache_.backend != nullptr) check_for_device(options);
      if (shown == nullptr)
        throw Error(ErrorCode::kWrongState, "no scene is shown yet: call show() first");
      return within_memory("there is not enough memory for this image", "",
                           [&] { return render_checked(options, given); });
    } catch (const Error& error) {
      // A cancelled call leaves everything intact: kept data is not built where a caller can
      // cancel.
      if (error.code() != ErrorCode::kCancelled) scene_.distrust();
      throw;
    }
  }

  [[nodiscard]] const UpdateStatistics& last_update() const { return update_; }

 private:
  RenderResult render_checked(const RenderOptions& options, const Camera* given) {
    Stopwatch watch;
    scene_.validate();
    const SceneDescription& shown = *scene_.description();
    if (given != nullptr) validate_camera(*given);
    const Executor& executor =
        context_ ? ContextAccess::executor(*context_) : executor_for(options.threads);
    ProgressMeter meter(options.progress);
    Camera camera = given != nullptr ? *given : find_camera(shown, options.camera);
    camera.aperture = options.aperture.value_or(camera.aperture);
    camera.focus = options.focus.value_or(camera.focus);
    const Traversal traversal = method_settings(options).traversal;
    const std::uint32_t samples = find_samples(shown, camera, options);
    const bool lens = camera.aperture > 0 && samples > 1;
    const bool only_rays = needs_rays(options, shown);
    const bool rasters = options.primary == Primary::kRaster && !lens && !only_rays;
    if (options.gbuffer && !rasters)
      throw Error(ErrorCode::kUnsupported,
                  "a lens needs rays for primary visibility, and OpenGL draws no targets then",
                  "gbuffer");
    if (rasters && !rasterizer_) rasterizer_.emplace();
    scene_.settle(host_need(options, rasters, lens && camera.focus <= 0),
                  traversal == Traversal::kRayHierarchy,
                  rasters ? 0 : entering_rays(options, shown, samples));
    const std::vector<PlacedLight> lights = find_lights(shown, camera, samples);
    meter.begin("scene", 1);
    update_ = scene_.update(executor);
    if (cache_.backend == nullptr && orders_rays(traversal)) {
      Stopwatch arrays;
      cache_.ordered_tracer().prepare(executor, scene_.flat());
      update_.place_ms += arrays.lap_ms();
    }
    std::optional<Ground> ground;
    if (options.ground) ground = placed_ground(*options.ground, world_bounds(shown));
    ResidentGeometry geometry(executor, scene_.flat(), scene_.textures(), options, &cache_,
                              samples);
    const auto complete = [&](FrameStatistics* s) {
      s->scene = shown.name;
      s->triangles = shown.triangle_count();
      s->meshes = scene_.flat().meshes.size();
      s->width = options.width;
      s->height = options.height;
      s->method = to_string(options.method);
      s->device = to_string(cache_.backend != nullptr ? Device::kCuda : Device::kCpu);
      s->primary = rasters                               ? rastered(options.gbuffer)
                   : options.primary != Primary::kRaster ? "trace"
                   : lens                                ? "trace: a lens needs rays"
                          : "trace: OpenGL would need all instances placed";
      s->threads = executor.threads();
      s->total_ms = watch.ms();
      if (!scene_.placing().empty() && !s->batches.empty())
        s->batches.front().plan.push_back(scene_.placing());
    };
    const bool on_device = cache_.backend != nullptr;
    FrameInput input{geometry,
                     camera,
                     lights,
                     options,
                     samples,
                     rasters ? &*rasterizer_ : nullptr,
                     shown.environment.empty() ? nullptr : &scene_.environment(),
                     complete};
    input.room = find_room(shown, camera, options);
    input.ranks = cache_.ranks;
    if (on_device) {
      input.device = &device_stages(executor);
      if (orders_rays(traversal))
        input.ordered = &cache_.device_tracer(scene_.flat())
                             .ordered(executor, traversal, input.device->triangles(), &cache_.tree);
      if (rasters)
        input.rasterize = [&](const CameraFrame& frame, SlotDevice* device, Gbuffer* gbuffer) {
          return seen_by_opengl(executor, frame, device, gbuffer);
        };
    }
    RenderResult result = render_frame(executor, input);
    update_.tree = word_of(cache_.tree);
    update_.tree_ms = cache_.tree.ms;
    if (ground) {
      const RenderOptions lit = ground_options(options, result);
      ResidentGeometry again(executor, scene_.flat(), scene_.textures(), lit,
                             on_device ? nullptr : &cache_, samples);
      FrameInput ground_input{again, camera, lights, lit, samples};
      ground_input.environment = input.environment;
      ground_input.ranks = input.ranks;
      add_ground(executor, ground_input, *ground, &result);
      result.statistics.total_ms = watch.ms();
    }
    return result;
  }

  /// With several processes, rank 0's image, because that of other ranks may differ.
  std::vector<std::uint32_t> seen_by_opengl(const Executor& executor, const CameraFrame& frame,
                                            SlotDevice* device, Gbuffer* gbuffer) {
    const GbufferRequest targets{scene_.textures(), gbuffer};
    const GbufferRequest* const wish = gbuffer != nullptr ? &targets : nullptr;
    const auto see = [&](SlotDevice* taker) {
      if (taker == nullptr) scene_.catch_up(executor);
      return rasterizer_->visible_triangles(executor, scene_.flat(), frame, taker, nullptr, wish);
    };
    if (cache_.ranks == nullptr || cache_.ranks->size() == 1) {
      if (device == nullptr) return see(nullptr);
      WatchedDevice watched(*device, [&] { scene_.catch_up(executor); });
      return see(&watched);
    }
    return made_by_first(cache_.ranks, std::size_t{frame.width} * frame.height,
                         [&] { return see(nullptr); });
  }

  /// How primary visibility is found, and the memory that a G-buffer takes; in words.
  [[nodiscard]] std::string rastered(bool gbuffer) const {
    const std::string by = ": " + rasterizer_->description();
    if (!gbuffer) return "raster" + by;
    return "raster into four RGBA32F targets, 64 bytes a pixel in place of 4, of " +
           std::to_string(rasterizer_->drawn_triangles()) +
           " triangles, 144 bytes each in place of 36" + by;
  }

  /// Returns the device's stages with the current scene.
  DeviceStages& device_stages(const Executor& executor) {
    if (cache_.stages == nullptr) cache_.stages = frame_backend(*cache_.backend).make_stages();
    if (!cache_.stages->has_scene())
      cache_.stages->set_scene(executor, scene_.flat(), scene_.textures(), scene_.environment());
    return *cache_.stages;
  }

  const Executor& executor_for(std::uint32_t threads) {
    if (!executor_ || threads != asked_threads_) executor_.emplace(threads);
    asked_threads_ = threads;
    return *executor_;
  }

  /// Why a frame needs the triangles in the host's memory, in words that follow "for"; empty: they
  /// may be in the device's memory only.
  [[nodiscard]] std::string host_need(const RenderOptions& options, bool rasters, bool focuses) {
    if (cache_.backend == nullptr) return "the CPU traces";
    if (options.ground) return "the shadow on the ground is traced there";
    if (focuses) return "the lens finds its focus there";
    if (scene_.has_other_shapes() && needs_light(*scene_.description()))
      return "the lights of the studio are placed there";
    if (!rasters) return "";
    if (cache_.ranks != nullptr && cache_.ranks->size() > 1)
      return "OpenGL draws for all processes";
    if (cache_.stages != nullptr && !cache_.stages->draws_there())
      return "OpenGL draws what lies there";
    return "";
  }

  /// Whether rays may enter the scene's instances.
  [[nodiscard]] bool may_enter(const RenderOptions& options) const {
    return cache_.backend == nullptr && options.method == Method::kDual &&
           !options.count_pixel_tests;
  }
  /// Whether OpenGL cannot draw the scene, but rays find what pixels see.
  [[nodiscard]] bool needs_rays(const RenderOptions& options, const SceneDescription& shown) const {
    return may_enter(options) && !options.gbuffer && is_too_large_to_place(shown);
  }
  /// The rays of an image that may enter instances, as far as they can be counted beforehand; 0:
  /// none.
  [[nodiscard]] std::uint64_t entering_rays(const RenderOptions& options,
                                            const SceneDescription& shown,
                                            std::uint32_t samples) const {
    if (!may_enter(options)) return 0;
    constexpr std::uint64_t kOfAStudio = 3, kOfAnEnvironment = 2;
    const std::uint64_t lights = needs_light(shown) ? kOfAStudio : shown.lights.size();
    const std::uint64_t shadows = lights + (shown.environment.empty() ? 0 : kOfAnEnvironment);
    return std::uint64_t{options.width} * options.height * samples *
           (1 + (options.shadows ? shadows : 0));
  }

  const LargeMemoryKeeper memory_;
  const std::optional<Context> context_;  // keeps the device
  std::optional<Executor> executor_;
  std::uint32_t asked_threads_ = 0;
  std::optional<Rasterizer> rasterizer_;
  TraceCache cache_;
  ShownScene scene_{cache_};
  UpdateStatistics update_;
};

Renderer::Renderer() : impl_(std::make_unique<Impl>()) {}
Renderer::Renderer(const Context& context) : impl_(std::make_unique<Impl>(context)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::show(const SceneDescription& scene) {
  SceneChanges all;
  all.everything = true;
  impl_->show(scene, all);
}

void Renderer::show(const SceneDescription& scene, const SceneChanges& changes) {
  impl_->show(scene, changes);
}

RenderResult Renderer::render(const RenderOptions& options) {
  return impl_->render(options, nullptr);
}

RenderResult Renderer::render(const RenderOptions& options, const Camera& camera) {
  return impl_->render(options, &camera);
}

const UpdateStatistics& Renderer::last_update() const {
  return impl_->last_update();
}

RenderResult render(const SceneDescription& scene, const RenderOptions& options) {
  Renderer renderer;
  renderer.show(scene);
  return renderer.render(options);
}

RenderResult render(const Context& context, const SceneDescription& scene,
                    const RenderOptions& options) {
  Renderer renderer(context);
  renderer.show(scene);
  return renderer.render(options);
}

}  // namespace raysheaf
