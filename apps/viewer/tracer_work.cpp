#include "tracer_work.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raysheaf/error.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// Refined pictures are shown no more often: each is made and uploaded whole.
constexpr double kShowEveryMs = 150;
constexpr std::uint32_t kShowFirst = 4;

bool same_camera(const Camera& a, const Camera& b) {
  return std::memcmp(&a.to_world, &b.to_world, sizeof a.to_world) == 0 && a.y_fov == b.y_fov &&
         a.y_mag == b.y_mag && a.orthographic == b.orthographic;
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

void PictureMaker::show(SceneDescription scene) {
  add_missing_camera_and_light(scene);
  scene_ = std::make_unique<SceneDescription>(std::move(scene));
  lights_ = scene_->lights;
  bounds_ = world_bounds(*scene_);
  exposure_ = 0;
}

std::vector<Light> PictureMaker::lit(const ViewRequest& request) const {
  std::vector<Light> lights = lights_;
  for (Light& light : lights) light.intensity = light.intensity * request.settings.light;
  if (request.settings.headlight) {
    // A radiant intensity that gives an illuminance of 1 half a scene away.
    const float reach = 0.5f * length(bounds_.max - bounds_.min);
    const float candela = reach * reach;
    Light& light = lights.emplace_back();
    light.name = "headlight";
    light.position = column(request.camera.to_world, 3);
    light.intensity = {candela, candela, candela};
  }
  return lights;
}

SceneDescription PictureMaker::lit_copy(const ViewRequest& request) const {
  SceneDescription copy = *scene_;
  copy.lights = lit(request);
  return copy;
}

RenderResult PictureMaker::render_side(const ViewRequest& request, const MethodChoice& choice,
                                       const Camera& camera, const Unwanted& unwanted) {
  RenderOptions options = render_options(request.settings, choice);
  options.width = request.size.width;
  options.height = request.size.height;
  options.primary = Primary::kTrace;
  const Watch watch;
  options.progress = [&](const Progress&) { return !unwanted(watch.ms()); };
  scene_->cameras = {camera};
  return render(*scene_, options);
}

bool PictureMaker::add_sample(const ViewRequest& request, const Unwanted& unwanted) {
  const Camera camera = jittered(request.camera, request.size, sides_[0].samples());
  const Watch watch;
  try {
    RenderResult left = render_side(request, request.settings.left, camera, unwanted);
    if (request.settings.split)
      sides_[1].add(render_side(request, request.settings.right, camera, unwanted));
    sides_[0].add(std::move(left));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kCancelled) return false;
    throw;
  }
  sample_ms_ = watch.ms();
  return true;
}

bool PictureMaker::make(const ViewRequest& request, const Unwanted& unwanted, const Show& shown) {
  if (request.settings.device != Device::kCpu)
    throw Error(ErrorCode::kUnsupported, "this build traces rays on the CPU alone", "device");
  scene_->lights = lit(request);
  for (Accumulator& side : sides_) side = {};
  const std::uint32_t wanted = request.refine ? request.settings.samples : 1;
  Watch since_shown;
  for (std::uint32_t sample = 1; sample <= wanted; ++sample) {
    if (!add_sample(request, unwanted)) return false;
    if (sample > kShowFirst && sample < wanted && since_shown.ms() < kShowEveryMs) continue;
    auto made = picture(request);
    made->finished = request.refine && sample == wanted;
    shown(std::move(made));
    since_shown = {};
  }
  return true;
}

std::shared_ptr<Picture> PictureMaker::picture(const ViewRequest& request) {
  auto picture = std::make_shared<Picture>();
  picture->request = request;
  picture->size = request.size;
  picture->samples = sides_[0].samples();
  picture->trace_ms = sample_ms_;
  RenderResult results[2];
  const std::size_t count = request.settings.split ? 2 : 1;
  for (std::size_t i = 0; i < count; ++i) results[i] = sides_[i].mean();
  // A picture that moves keeps the exposure of the one that stood: it would flicker.
  if (request.refine || !(exposure_ > 0)) exposure_ = results[0].exposure;
  picture->exposure = exposure_ * std::exp2(request.settings.exposure);
  picture->scale = scale_of({&results[0].tests, &results[1].tests});
  for (std::size_t i = 0; i < count; ++i) {
    results[i].exposure = picture->exposure;
    picture->sides[i].image = layer_image(results[i], request.settings.layer, picture->scale);
    picture->sides[i].statistics = std::move(results[i].statistics);
    picture->sides[i].tests_a_ray = tests_a_ray(picture->sides[i].statistics);
  }
  picture->ids = std::move(results[0].ids);
  picture->position = std::move(results[0].position);
  return picture;
}

BundleAnswer Tracer::Work::answer(const BundleQuestion& question) {
  BundleAnswer answer{question, {}, {}};
  if (!pictures.has_scene()) return answer;
  try {
    if (laboratory_ == nullptr || !same_camera(asked_.camera, question.camera) ||
        asked_.size != question.size) {
      laboratory_.reset();
      SceneDescription copy = pictures.scene();
      copy.cameras = {question.camera};
      laboratory_ = std::make_unique<Laboratory>(copy, question.size.width, question.size.height,
                                                 question.threads);
      asked_ = question;
    }
    answer.bundle = laboratory_->bundle(question.rays, method_settings_of(question.choice),
                                        question.x, question.y);
  } catch (const Error& error) {
    answer.error = error.what();
  }
  return answer;
}

}  // namespace raysheaf::viewer
