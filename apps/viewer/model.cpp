#include "model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "raysheaf/error.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

/// The camera rests if nothing has changed for this time.
constexpr double kStandsAfter = 0.12;
/// If the first image of a refinement takes longer, one of a quarter of a second precedes it.
constexpr double kLongMs = 600, kBetweenMs = 250;
/// The same where the preview shows the new view.
constexpr double kLongWithPreviewMs = 2500;
constexpr double kFrameSeconds = 1.0 / 24;
constexpr std::size_t kHistory = 120;
constexpr std::uint32_t kBundleWidth = 320;

bool same_question(const BundleQuestion& a, const BundleQuestion& b) {
  return same_camera(a.camera, b.camera) && a.choice == b.choice && a.rays == b.rays &&
         a.size == b.size && a.x == b.x && a.y == b.y && a.time_s == b.time_s && a.clip == b.clip;
}

HistoryEntry entry_of(const FrameStatistics& statistics) {
  HistoryEntry entry;
  entry.total_ms = statistics.total_ms;
  entry.raster_ms = statistics.raster_ms;
  entry.shade_ms = statistics.shade_ms;
  for (const BatchStatistics& batch : statistics.batches) {
    entry.rays += static_cast<double>(batch.rays);
    entry.tests += static_cast<double>(batch.total_tests());
    if (batch.kind == RayKind::kPrimary) continue;  // its times are in `raster_ms`
    entry.stages.add(batch.times_ms);
  }
  return entry;
}

}  // namespace

Model::Model(const ViewSettings& start, Tracer& tracer, std::string save_folder)
    : settings(start), tracer_(tracer), save_folder_(std::move(save_folder)) {}

void Model::load(const std::string& path) {
  load_number_ = tracer_.load(path);
}

void Model::reload() {
  if (path_.empty()) return;
  watch_.watch(facts_ ? facts_->files : std::vector<std::string>{});
  reload_number_ = load_number_ = tracer_.load(path_);
}

void Model::reload_if_changed(double now_s) {
  if (settings.reload && !loading() && watch_.changed(now_s)) reload();
}

void Model::note(std::string text, bool failure) {
  note_ = {std::move(text), failure, now_s_};
  ++version_;
}

void Model::set_camera(std::size_t index) {
  if (!facts_) return;
  camera_index_ = index % facts_->cameras.size();
  rig = CameraRig(facts_->cameras[camera_index_], facts_->bounds, settings.up);
  up_ = settings.up;
  side_.reset();
  if (camera_index_ == facts_->automatic_camera && settings.up != UpAxis::kY)
    look_from(std::nullopt);
}

void Model::look_from(std::optional<ViewSide> side) {
  if (!facts_) return;
  side_ = side;
  const auto width = static_cast<float>(window_.width), height = static_cast<float>(window_.height);
  rig.look_from(side, facts_->bounds, width / height);
}

void Model::toggle_orthographic() {
  if (facts_) rig.set_orthographic(!rig.camera().orthographic, facts_->bounds);
}

/// Another axis points up: cameras that the viewer has placed are placed again.
void Model::follow_up_axis() {
  if (up_ == settings.up) return;
  up_ = settings.up;
  rig = CameraRig(rig.camera(), facts_->bounds, settings.up);
  if (camera_index_ == facts_->automatic_camera || side_) look_from(side_);
}

void Model::open_dialog(bool on) {
  dialog_.reset();
  if (on) dialog_.emplace(std::filesystem::path(path_).parent_path().string());
  ++version_;
}

void Model::choose_file(std::size_t entry) {
  if (!dialog_) return;
  if (const auto file = dialog_->choose(entry)) {
    load(*file);
    open_dialog(false);
  }
  ++version_;
}

void Model::select_file(std::size_t entry) {
  if (dialog_) dialog_->move(static_cast<int>(entry) - static_cast<int>(dialog_->selected()));
}

bool Model::mesh_is_current() const {
  return mesh_ && !mesh_->draws.empty() && mesh_->time_s == shown_time() && mesh_->clip == clip_;
}

bool Model::previews() const {
  return can_preview_ && settings.moving == ViewSettings::Moving::kPreview && !settings.split &&
         settings.layer == Layer::kBeauty && !playing_ && mesh_is_current();
}

bool Model::shows_preview() const {
  if (!previews()) return false;
  return !picture_ || !same_camera(picture_->request.camera, rig.camera());
}

const Picture* Model::reprojected() const {
  if (!picture_) return nullptr;
  const ViewRequest& of = picture_->request;
  const bool is_beauty = of.settings.layer == Layer::kBeauty && !of.settings.split;
  return is_beauty && of.time_s == shown_time() && of.clip == clip_ ? picture_.get() : nullptr;
}

bool Model::rests() const {
  return now_s_ - last_change_s_ >= kStandsAfter;
}

bool Model::moves() const {
  return !held_.empty() || playing_;
}

void Model::play(bool on) {
  playing_ = on && facts_ && facts_->moves();
}

void Model::seek(double seconds) {
  playing_ = false;
  if (facts_) time_s_ = std::clamp(seconds, facts_->start_s, end_s());
}

void Model::set_clip(std::uint32_t clip) {
  const std::size_t count = facts_ ? facts_->clips.size() : 0;
  if (clip >= count) {
    throw Error(ErrorCode::kNotFound, "there is no clip " + std::to_string(clip) +
                                          ": the scene has " + std::to_string(count));
  }
  clip_ = clip;
  time_s_ = std::min(time_s_, end_s());
}

double Model::end_s() const {
  if (!facts_) return 0;
  return clip_ < facts_->clip_ends_s.size() ? facts_->clip_ends_s[clip_] : facts_->end_s;
}

/// For a sequence: the time at which the shown frame began.
double Model::shown_time() const {
  if (!facts_ || facts_->frame_times.empty()) return time_s_;
  const std::vector<double>& times = facts_->frame_times;
  const auto after = std::upper_bound(times.begin(), times.end(), time_s_);
  return after == times.begin() ? times.front() : after[-1];
}

void Model::step(int frames) {
  if (!facts_ || !facts_->moves()) return;
  const std::vector<double>& times = facts_->frame_times;
  if (times.empty()) return seek(time_s_ + frames * kFrameSeconds);
  const auto here = std::lower_bound(times.begin(), times.end(), shown_time()) - times.begin();
  const auto last = static_cast<std::ptrdiff_t>(times.size()) - 1;
  seek(times[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(here + frames, 0, last))]);
}

void Model::go_on(double seconds) {
  if (!playing_ || !facts_) return;
  const double length = end_s() - facts_->start_s;
  // The last frame of a sequence is shown as long as the others.
  const std::size_t frames = facts_->frame_times.size();
  const double pause = frames > 1 ? length / static_cast<double>(frames - 1) : 0;
  time_s_ += seconds;
  if (time_s_ >= end_s() + pause) time_s_ = facts_->start_s;
}

bool Model::shows_now() const {
  if (!picture_ || !wished_any_ || loading()) return false;
  const ViewRequest& of = picture_->request;
  return same_wish(of, request_of(window_, true));
}

bool Model::up_to_date() const {
  return shows_now() && picture_->size == window_ && picture_->request.refine;
}

bool Model::bundle_up_to_date() const {
  return bundle_ && asked_ && bundle_->question.number == asked_->number &&
         same_question(*asked_, bundle_question());
}

void Model::update(double now_s) {
  const double passed = now_s - now_s_;
  now_s_ = now_s;
  fly(std::clamp(passed, 0.0, 0.1));
  go_on(std::clamp(passed, 0.0, 0.1));
  take_all(now_s);
  if (!facts_) return;
  reload_if_changed(now_s);
  follow_up_axis();
  wish(now_s);
  wish_for_bundle();
}

void Model::take_all(double now_s) {
  while (auto loaded = tracer_.take_scene()) take_scene(*std::move(loaded));
  if (auto mesh = tracer_.take_mesh()) mesh_ = std::move(mesh);
  if (auto picture = tracer_.take_picture()) take_picture(std::move(picture));
  if (auto answer = tracer_.take_answer()) {
    if (!answer->error.empty()) note(answer->error, true);
    bundle_ = std::move(answer);
    ++version_;
  }
  if (auto saved = tracer_.take_saved()) note(*saved, !saved->starts_with("wrote "));
  (void)now_s;
}

void Model::take_scene(LoadedScene loaded) {
  if (loaded.number == load_number_) load_number_ = 0;
  if (!loaded.facts) {
    note(loaded.error, true);
    return;
  }
  const bool is_same = facts_ && loaded.number == reload_number_;
  // `reload` has looked at these files before they were read.
  if (!is_same || facts_->files != loaded.facts->files) watch_.watch(loaded.facts->files);
  facts_ = std::move(loaded.facts);
  picture_ = nullptr;
  mesh_ = std::move(loaded.mesh);
  path_ = loaded.path;
  ++scene_count_;
  pick_.reset();
  pending_pick_.reset();
  bundle_.reset();
  asked_.reset();
  history_.clear();
  resolution_.forget();
  wished_any_ = false;
  if (is_same) {
    if (clip_ >= facts_->clips.size()) clip_ = 0;
    time_s_ = std::clamp(time_s_, facts_->start_s, end_s());
    playing_ = playing_ && facts_->moves();
    camera_index_ = std::min(camera_index_, facts_->cameras.size() - 1);
  } else {
    time_s_ = facts_->start_s;
    clip_ = 0;
    playing_ = false;
    set_camera(facts_->automatic_camera.value_or(0));
    if (std::exchange(first_orthographic_, false)) rig.set_orthographic(true, facts_->bounds);
    if (const auto side = std::exchange(first_side_, std::nullopt)) look_from(side);
  }
  char text[200];
  std::snprintf(text, sizeof text, "%.80s: %s, %s, %s; %s in %.0f ms", facts_->name.c_str(),
                count_text(facts_->triangles, "triangle", "triangles").c_str(),
                count_text(facts_->meshes, "mesh", "meshes").c_str(),
                count_text(facts_->instances, "instance", "instances").c_str(),
                is_same ? "read again" : "loaded", facts_->load_ms);
  note(text);
}

void Model::take_picture(std::shared_ptr<const Picture> picture) {
  if (!picture->error.empty()) {
    note(picture->error, true);
    return;
  }
  resolution_.took(picture->size.pixels(), picture->trace_ms);
  if (picture->given_up) return;
  // The preview is sharper, and the whole image is not far.
  if (shows_preview() && !picture->request.refine &&
      resolution_.expected_ms(window_.pixels()) < kLongWithPreviewMs)
    return;
  history_.push_back(entry_of(picture->sides[0].statistics));
  if (history_.size() > kHistory) history_.pop_front();
  // An interrupted refinement starts again; of both images the one with more samples is shown.
  const bool same = picture_ && picture_->request.number == picture->request.number;
  if (same && picture_->samples > picture->samples) return;
  picture_ = std::move(picture);
  ++picture_count_;
  ++version_;
  resolve_pick();
}

ViewRequest Model::request_of(Size size, bool refine) const {
  ViewRequest request;
  request.camera = rig.camera();
  request.settings = settings;
  request.size = size;
  request.refine = refine;
  request.time_s = shown_time();
  request.clip = clip_;
  return request;
}

bool Model::same_wish(const ViewRequest& a, const ViewRequest& b) const {
  return same_camera(a.camera, b.camera) && same_picture(a.settings, b.settings) &&
         a.time_s == b.time_s && a.clip == b.clip;
}

/// Small images while anything changes, then larger ones.
void Model::wish(double now_s) {
  const ViewRequest now = request_of(window_, true);
  const bool changed = !wished_any_ || !same_wish(now, wished_);
  if (changed) {
    if (wished_any_ && now.settings.left.method != wished_.settings.left.method)
      resolution_.forget();
    ViewRequest turned = now;
    turned.camera = wished_.camera;
    const bool is_move = wished_any_ && same_wish(turned, wished_);
    const Size size = resolution_.size_for(window_, settings.answer_ms);
    wished_ = request_of(size, false);
    wished_.is_smallest = 4 * size.width <= window_.width + 4;
    if (is_move && previews()) {
      tracer_.drop();  // OpenGL needs the cores
    } else {
      wished_.number = tracer_.submit(wished_);
    }
    wished_any_ = true;
    last_change_s_ = now_s;
    stage_ = 0;
    return;
  }
  const bool resized = stage_ == 2 && wished_.size != window_;
  if (resized) {
    stage_ = 0;
    last_change_s_ = now_s;
  }
  if (stage_ == 2 || now_s - last_change_s_ < kStandsAfter) return;
  const bool arrived = picture_ && picture_->request.number == wished_.number;
  const double long_ms = previews() ? kLongWithPreviewMs : kLongMs;
  const bool between = stage_ == 0 && resolution_.expected_ms(window_.pixels()) > long_ms;
  if (stage_ == 1 && !arrived && tracer_.busy()) return;
  Resolution probe = resolution_;
  const Size size = between ? probe.size_for(window_, kBetweenMs) : window_;
  wished_ = request_of(size, !between);
  wished_.number = tracer_.submit(wished_);
  stage_ = between ? 1 : 2;
  ++version_;  // the preview becomes sharp
}

BundleQuestion Model::bundle_question() const {
  BundleQuestion question;
  question.camera = rig.camera();
  question.choice = settings.split && cursor_x_ > settings.divider ? settings.right : settings.left;
  question.rays = settings.bundle_rays;
  question.threads = settings.threads;
  question.time_s = shown_time();
  question.clip = clip_;
  const float aspect = static_cast<float>(window_.height) / static_cast<float>(window_.width);
  question.size.width = std::min(kBundleWidth, window_.width);
  const auto height = std::lround(static_cast<float>(question.size.width) * aspect);
  question.size.height = static_cast<std::uint32_t>(std::max(1L, height));
  const auto pixel = [](float at, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0f, 0.9999f) * static_cast<float>(count));
  };
  question.x = pixel(cursor_x_, question.size.width);
  question.y = pixel(cursor_y_, question.size.height);
  return question;
}

void Model::wish_for_bundle() {
  if (!settings.bundle) {
    bundle_.reset();
    asked_.reset();
    return;
  }
  if (!rests()) return;
  BundleQuestion question = bundle_question();
  if (asked_ && same_question(*asked_, question)) return;
  question.number = tracer_.ask(question);
  asked_ = question;
}

void Model::resolve_pick() {
  if (!pending_pick_ || !picture_ || !same_camera(picture_->request.camera, rig.camera())) return;
  pick_ = pick(*picture_, *facts_, pending_pick_->x, pending_pick_->y);
  // Once more with the final image, whose pixels are the smallest.
  if (picture_->request.refine) pending_pick_.reset();
}

void Model::save(const std::string& path) {
  if (!facts_) return;
  namespace fs = std::filesystem;
  std::string target = path;
  for (std::error_code ignored; target.empty() || (path.empty() && fs::exists(target, ignored));) {
    char name[40];
    std::snprintf(name, sizeof name, "raysheaf-%04u.png", ++saved_);
    target = (fs::path(save_folder_) / name).string();
  }
  note("saving " + target + " ...");
  tracer_.save({request_of(window_, true), target, {}});
}

}  // namespace raysheaf::viewer
