#include "tracer_work.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raysheaf/error.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// Refined images are not shown more often, because each is made and uploaded completely.
constexpr double kShowEveryMs = 150;
constexpr std::uint32_t kShowFirst = 4;

bool same_camera(const Camera& a, const Camera& b) {
  return std::memcmp(&a.to_world, &b.to_world, sizeof a.to_world) == 0 && a.y_fov == b.y_fov &&
         a.y_mag == b.y_mag && a.orthographic == b.orthographic && a.aspect_ratio == b.aspect_ratio;
}

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

double tests_a_ray(const FrameStatistics& statistics) {
  double tests = 0, rays = 0;
  for (const BatchStatistics& batch : statistics.batches) {
    tests += static_cast<double>(batch.total_tests());
    rays += static_cast<double>(batch.rays);
  }
  return rays > 0 ? tests / rays : 0;
}

}  // namespace

void PictureMaker::show(std::unique_ptr<Animation> animation) {
  add_missing_camera_and_light(*animation);
  const double start_s = animation->start();
  (void)animation->seek(start_s);  // the last step that can fail: until here the shown scene stays
  renderer_.show(animation->scene());
  animation_ = std::move(animation);
  clip_ = 0;
  time_s_ = start_s;
  lights_ = scene().lights;
  bounds_ = world_bounds(scene());
  exposure_ = 0;
}

SceneFacts PictureMaker::facts() {
  SceneFacts facts = facts_of(scene());
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

void PictureMaker::refine(const ViewRequest& request, RenderOptions left, const Show& shown) {
  Watch since_shown;
  left.on_sample = [&](const RenderResult& result) {
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
  // An image in motion keeps the exposure of the last one at rest, because it would flicker
  // otherwise.
  if (request.refine || !(exposure_ > 0)) exposure_ = left.exposure;
  picture->exposure = exposure_ * std::exp2(request.settings.exposure);
  std::vector<const std::vector<float>*> tests = {&left.tests};
  if (right != nullptr) tests.push_back(&right->tests);
  picture->scale = scale_of(tests);
  const auto fill = [&](const RenderResult& result, Method method, PictureSide& side) {
    side.image = layer_image(result, request.settings.layer, picture->scale, picture->exposure);
    side.statistics = of_one_sample(result.statistics, result.samples);
    side.statistics.method = to_string(method);
    side.tests_a_ray = tests_a_ray(side.statistics);
    picture->trace_ms += side.statistics.total_ms;
  };
  fill(left, request.settings.left.method, picture->sides[0]);
  if (right != nullptr) fill(*right, request.settings.right.method, picture->sides[1]);
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
  return laboratory_->bundle(question.rays, method_settings_of(question.choice), question.x,
                             question.y);
}

}  // namespace raysheaf::viewer
