#include "tracer_work.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raysheaf/error.h"
#include "raysheaf/studio.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// Refined images are not shown more often, because each is made and uploaded completely.
constexpr double kShowEveryMs = 150;
constexpr std::uint32_t kShowFirst = 4;

std::vector<Light> lit(const std::vector<Light>& own, const ViewRequest& request,
                       const Box& bounds) {
  std::vector<Light> lights = own;
  for (Light& light : lights) light.intensity = light.intensity * request.settings.light;
  if (request.settings.headlight) {
    // The radiant intensity that gives an illuminance of 1 at half the scene's size.
    const float reach = 0.5f * length(bounds.max - bounds.min);
    const float candela = reach * reach;
    Light& light = lights.emplace_back();
    light.name = "headlight";
    light.position = column(request.camera.to_world, 3);
    light.intensity = {candela, candela, candela};
  }
  return lights;
}

/// The mean colour of the pixels that see nothing; `standard` if there are none.
Vec3 sky_of(const Image& image, const std::vector<PixelIds>& ids, Vec3 standard) {
  std::array<std::uint64_t, 3> sum{};
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i].prim_id != kInvalidId) continue;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += image.rgba[4 * i + c];
    ++count;
  }
  if (count == 0) return standard;
  const auto part = [&](std::size_t c) {
    return static_cast<float>(sum[c]) / (255 * static_cast<float>(count));
  };
  return {part(0), part(1), part(2)};
}

/// The radiance for display, for each part of light that the surfaces reflect.
float light_of(const RenderResult& result, float exposure) {
  double shown = 0, reflected = 0;
  for (std::size_t i = 0; i < result.ids.size(); ++i) {
    if (result.ids[i].prim_id == kInvalidId) continue;
    const Vec3 beauty = result.beauty[i] * exposure, albedo = result.albedo[i];
    const auto bounded = [](float value) { return static_cast<double>(std::min(value, 1.0f)); };
    shown += bounded(beauty.x) + bounded(beauty.y) + bounded(beauty.z);
    reflected += static_cast<double>(albedo.x + albedo.y + albedo.z);
  }
  const double light = reflected > 0 ? shown / reflected : 1;
  return static_cast<float>(std::clamp(light, 0.05, 4.0));
}

double tests_a_ray(const FrameStatistics& statistics) {
  double tests = 0, rays = 0;
  for (const BatchStatistics& batch : statistics.batches) {
    tests += static_cast<double>(batch.total_tests());
    rays += static_cast<double>(batch.rays);
  }
  return rays > 0 ? tests / rays : 0;
}

/// Adds what is missing, and a camera that frames the scene if the first one does not show it.
/// Returns the index of the added camera.
std::optional<std::size_t> add_automatic_camera(Animation& animation) {
  SceneDescription& scene = animation.scene();
  std::optional<std::size_t> added;
  if (scene.cameras.empty()) {
    added = 0;
  } else if (!first_camera_shows(animation)) {
    added = scene.cameras.size();
    scene.cameras.push_back(framing_camera(animation, Viewpoint{}));
    scene.cameras.back().name = "automatic";
    if (needs_light(scene)) scene.lights = studio_lights(scene, scene.cameras.back());
  }
  add_missing_camera_and_light(animation);
  return added;
}

}  // namespace

void PictureMaker::show(std::unique_ptr<Animation> animation) {
  const std::optional<std::size_t> automatic_camera = add_automatic_camera(*animation);
  const double start_s = animation->start();
  (void)animation->seek(start_s);  // the last step that can fail: until here the shown scene stays
  renderer_.show(animation->scene());
  animation_ = std::move(animation);
  clip_ = 0;
  time_s_ = start_s;
  lights_ = scene().lights;
  bounds_ = world_bounds(scene());
  automatic_camera_ = automatic_camera;
  exposure_ = 0;
  fixed_exposure_ = false;
}

std::shared_ptr<const PreviewMesh> PictureMaker::mesh() {
  auto mesh = std::make_shared<PreviewMesh>(preview_mesh(scene()));
  mesh->time_s = mesh_time_s_ = time_s_;
  mesh->clip = mesh_clip_ = clip_;
  return mesh;
}

std::shared_ptr<const PreviewMesh> PictureMaker::new_mesh(const ViewRequest& request) {
  if (!has_scene() || (request.time_s == mesh_time_s_ && request.clip == mesh_clip_))
    return nullptr;
  pose(request);
  return mesh();
}

std::optional<float> PictureMaker::kept_exposure(const ViewRequest& request) const {
  const bool is_moved = request.time_s != exposed_.time_s || request.clip != exposed_.clip;
  if (!(exposure_ > 0) || !is_moved || !same_camera(request.camera, exposed_.camera) ||
      !same_picture(request.settings, exposed_.settings))
    return std::nullopt;
  return exposure_;
}

void PictureMaker::fix_exposure(float exposure) {
  exposure_ = exposure;
  fixed_exposure_ = true;
}

SceneFacts PictureMaker::facts() {
  SceneFacts facts = facts_of(scene());
  facts.automatic_camera = automatic_camera_;
  facts.start_s = animation_->start();
  facts.end_s = animation_->end();
  facts.frame_times = animation_->frame_times();
  facts.clips = animation_->clips();
  for (std::uint32_t clip = 0; clip < facts.clips.size(); ++clip) {
    animation_->play(clip);
    facts.clip_ends_s.push_back(animation_->end());
    facts.end_s = std::max(facts.end_s, animation_->end());
    if (facts.clips[clip].empty()) facts.clips[clip] = "clip " + std::to_string(clip);
  }
  if (!facts.clips.empty()) animation_->play(clip_);
  return facts;
}

void PictureMaker::pose(const ViewRequest& request) {
  SceneDescription& scene = animation_->scene();
  if (request.time_s != time_s_ || request.clip != clip_) {
    scene.lights = lights_;  // as `seek` left them
    if (request.clip != clip_) animation_->play(request.clip);
    const SceneChanges changes = animation_->seek(request.time_s);
    lights_ = scene.lights;
    time_s_ = request.time_s;
    clip_ = request.clip;
    renderer_.show(scene, changes);
  }
  scene.lights = lit(lights_, request, bounds_);
}

SceneDescription PictureMaker::posed_copy(const ViewRequest& request) {
  pose(request);
  return scene();
}

RenderResult PictureMaker::render_side(RenderOptions options, const Camera& camera) {
  options.primary = rasters_ ? Primary::kRaster : Primary::kTrace;
  try {
    return renderer_.render(options, camera);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNoGraphics) throw;
  }
  rasters_ = false;
  options.primary = Primary::kTrace;
  return renderer_.render(options, camera);
}

bool PictureMaker::make(const ViewRequest& request, const Unwanted& unwanted, const Show& shown) {
  if (request.settings.device != Device::kCpu)
    throw Error(ErrorCode::kUnsupported, "this build traces rays only on the CPU", "device");
  pose(request);
  // An image in motion keeps the exposure of the last one at rest, because it would flicker
  // otherwise.
  keeps_exposure_ = exposure_ > 0 && (fixed_exposure_ || !request.refine || kept_exposure(request));
  if (!keeps_exposure_) exposed_ = request;
  const Watch watch;
  const auto options_of = [&](const MethodChoice& choice) {
    RenderOptions options = render_options(request.settings, choice);
    options.width = request.size.width;
    options.height = request.size.height;
    options.samples = request.refine ? request.settings.samples : 1;
    options.progress = [&](const Progress&) { return !unwanted(watch.ms()); };
    return options;
  };
  try {
    const RenderOptions left = options_of(request.settings.left);
    if (request.settings.split) {
      refine_split(request, left, options_of(request.settings.right), shown);
    } else {
      refine(request, left, shown);
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kCancelled) return false;
    throw;
  }
  return true;
}

/// Puts the background into `backdrop`, and returns what it observes the samples with.
std::function<bool(const RenderResult&)> PictureMaker::watched(const ViewRequest& request,
                                                               std::optional<Backdrop>& backdrop,
                                                               RenderOptions* options) {
  backdrop.reset();
  if (!request.settings.background) return nullptr;
  backdrop.emplace(*request.settings.background).watch(options);
  return options->on_sample;
}

void PictureMaker::refine(const ViewRequest& request, RenderOptions left, const Show& shown) {
  Watch since_shown;
  const auto counts = watched(request, left_backdrop_, &left);
  left.on_sample = [&](const RenderResult& result) {
    if (counts) counts(result);
    if (result.samples > kShowFirst && since_shown.ms() < kShowEveryMs) return true;
    shown(picture(request, result, nullptr));
    since_shown = {};
    return true;
  };
  const RenderResult result = render_side(left, request.camera);
  auto last = picture(request, result, nullptr);
  last->finished = request.refine;
  shown(std::move(last));
}

/// Alternates between both sides, with four times the samples each time.
void PictureMaker::refine_split(const ViewRequest& request, RenderOptions left, RenderOptions right,
                                const Show& shown) {
  const std::uint32_t wanted = left.samples;
  for (std::uint32_t samples = 1;; samples = std::min(4 * samples, wanted)) {
    left.samples = right.samples = samples;
    (void)watched(request, left_backdrop_, &left);
    (void)watched(request, right_backdrop_, &right);
    const RenderResult one = render_side(left, request.camera);
    const RenderResult other = render_side(right, request.camera);
    auto made = picture(request, one, &other);
    made->finished = request.refine && samples == wanted;
    shown(std::move(made));
    if (samples == wanted) return;
  }
}

std::shared_ptr<Picture> PictureMaker::picture(const ViewRequest& request, const RenderResult& left,
                                               const RenderResult* right) {
  auto picture = std::make_shared<Picture>();
  picture->request = request;
  picture->size = request.size;
  picture->samples = std::max(left.samples, 1u);
  if (!keeps_exposure_) exposure_ = left.exposure;
  picture->exposure = exposure_ * std::exp2(request.settings.exposure);
  std::vector<const std::vector<float>*> tests = {&left.tests};
  if (right != nullptr) tests.push_back(&right->tests);
  picture->scale = scale_of(tests);
  const auto fill = [&](const RenderResult& result, Method method,
                        const std::optional<Backdrop>& backdrop, PictureSide& side) {
    side.image = layer_image(result, request.settings.layer, picture->scale, picture->exposure,
                             backdrop ? &*backdrop : nullptr);
    side.statistics = of_one_sample(result.statistics, result.samples);
    side.statistics.method = to_string(method);
    side.tests_a_ray = tests_a_ray(side.statistics);
    picture->trace_ms += side.statistics.total_ms;
  };
  fill(left, request.settings.left.method, left_backdrop_, picture->sides[0]);
  if (right != nullptr)
    fill(*right, request.settings.right.method, right_backdrop_, picture->sides[1]);
  picture->light = light_of(left, picture->exposure);
  picture->depth = depths_of(left, request.camera);
  picture->sky = sky_of(picture->sides[0].image, left.ids, picture->sky);
  picture->ids = left.ids;
  picture->position = left.position;
  return picture;
}

std::optional<RayBundle> Tracer::Work::bundle(const BundleQuestion& question) {
  if (!pictures.has_scene()) return std::nullopt;
  if (laboratory_ == nullptr || !same_camera(asked_.camera, question.camera) ||
      asked_.size != question.size || asked_.time_s != question.time_s ||
      asked_.clip != question.clip) {
    laboratory_.reset();
    SceneDescription copy = pictures.scene();
    copy.cameras = {question.camera};
    laboratory_ = std::make_unique<Laboratory>(copy, question.size.width, question.size.height,
                                               question.threads);
    asked_ = question;
  }
  return laboratory_->bundle(question.rays, method_settings(question.choice), question.x,
                             question.y);
}

}  // namespace raysheaf::viewer
