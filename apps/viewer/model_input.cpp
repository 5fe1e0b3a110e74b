// The actions of keys, buttons and the wheel.
#include <algorithm>
#include <cmath>

#include "model.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr float kDegreesAWindow = 220;
constexpr float kZoomAStep = 0.88f;
constexpr float kClickReach = 0.004f;  ///< of the window: a drag that moves less is a click
constexpr double kDoubleClick = 0.35;
constexpr float kFaster = 4;

const std::set<std::string>& flying_keys() {
  static const std::set<std::string> keys = {"w", "a",    "s",     "d",  "q",
                                             "e", "left", "right", "up", "down"};
  return keys;
}

template <class Enum>
Enum next(Enum value, int count) {
  return static_cast<Enum>((static_cast<int>(value) + 1) % count);
}

}  // namespace

const std::vector<KeyHelp>& key_help() {
  static const std::vector<KeyHelp> help = {
      {"left drag", "orbit around the pivot"},
      {"right drag", "look around"},
      {"middle drag, shift + left drag", "move sideways"},
      {"wheel", "nearer, farther"},
      {"click", "show what is under the cursor"},
      {"double click", "set the pivot there"},
      {"W A S D, Q E", "fly, faster with shift"},
      {"arrows", "look around"},
      {"F", "show the whole scene"},
      {"R", "return to the scene's camera"},
      {"C", "next camera of the scene"},
      {"1 2 3 4 5", "brute, rah, crsh, gl10, dual"},
      {"O", "next overlay: tests, normals, ..."},
      {"B", "show the bundle under the cursor"},
      {"X", "split: two methods side by side"},
      {"[ ]", "fewer, more bounces"},
      {"L", "light at the camera"},
      {"- =", "darker, brighter"},
      {"Z", "change the axis that points up"},
      {"space", "play, pause"},
      {", .", "previous, next frame"},
      {"F12", "save the image in full quality"},
      {"Tab", "hide or show the settings"},
      {"P", "hide or show the plots"},
      {"F1, H", "show these keys"},
      {"Ctrl + Q", "quit"},
  };
  return help;
}

void Model::handle(const InputEvent& event, bool over_panel, bool typing) {
  using Type = InputEvent::Type;
  fast_ = event.shift;
  switch (event.type) {
    case Type::kKeyDown:
      if (!typing) key_down(event);
      break;
    case Type::kKeyUp:
      held_.erase(event.text);
      break;
    case Type::kButtonDown:
      if (over_panel || dragged_button_ >= 0) break;
      dragged_button_ = event.button;
      drag_moved_ = false;
      drag_shift_ = event.shift;
      cursor_x_ = press_x_ = event.x;
      cursor_y_ = press_y_ = event.y;
      break;
    case Type::kButtonUp:
      if (event.button != dragged_button_) break;
      dragged_button_ = -1;
      if (event.button == 0 && !drag_moved_) click(event);
      break;
    case Type::kMove:
      cursor_moved(event);
      break;
    case Type::kScroll:
      if (!over_panel) rig.zoom(std::pow(kZoomAStep, std::clamp(event.y, -20.0f, 20.0f)));
      break;
    case Type::kDrop:
      load(event.text);
      break;
  }
}

void Model::cursor_moved(const InputEvent& event) {
  const float dx = event.x - cursor_x_, dy = event.y - cursor_y_;
  cursor_x_ = event.x;
  cursor_y_ = event.y;
  if (dragged_button_ < 0) return;
  const float from_x = event.x - press_x_, from_y = event.y - press_y_;
  if (from_x * from_x + from_y * from_y > kClickReach * kClickReach) drag_moved_ = true;
  if (!drag_moved_) return;
  const float angle = kDegreesAWindow * kPi / 180;
  const bool sidewise = dragged_button_ == 2 || (dragged_button_ == 0 && drag_shift_);
  const float aspect = static_cast<float>(window_.width) / static_cast<float>(window_.height);
  if (sidewise) {
    rig.pan(-dx * aspect, dy);
  } else if (dragged_button_ == 0) {
    rig.orbit(dx * angle, -dy * angle);
  } else {
    rig.look(dx * angle, -dy * angle);
  }
}

void Model::click(const InputEvent& event) {
  const bool twice = event.time_s - last_click_s_ < kDoubleClick;
  last_click_s_ = event.time_s;
  pending_pick_ = event;
  pick_.reset();
  resolve_pick();
  if (twice && pick_) rig.set_pivot(pick_->position);
}

void Model::fly(double seconds) {
  if (held_.empty() || !facts_) return;
  const auto held = [this](const char* key) { return held_.contains(key) ? 1.0f : 0.0f; };
  const float size = length(facts_->bounds.max - facts_->bounds.min);
  const auto s = static_cast<float>(seconds);
  const float step = 0.25f * size * settings.speed * s * (fast_ ? kFaster : 1);
  const float turn = s * (fast_ ? 2.0f : 0.8f);
  rig.fly(step * (held("w") - held("s")), step * (held("d") - held("a")),
          step * (held("e") - held("q")));
  if (held("left") + held("right") + held("up") + held("down") > 0)
    rig.look(turn * (held("right") - held("left")), turn * (held("up") - held("down")));
}

void Model::key_down(const InputEvent& event) {
  const std::string& key = event.text;
  if (event.control) {
    if (key == "q") quit_ = true;
    if (key == "s") save();
    return;
  }
  if (flying_keys().contains(key)) held_.insert(key);
  const auto is = [&key](const char* name) { return key == name; };
  if (key.size() == 1 && key[0] >= '1' && key[0] <= '5')
    settings.left.method = static_cast<Method>(key[0] - '1');
  if (is("f") && facts_) rig.frame(facts_->bounds);
  if (is("r")) set_camera(camera_index_);
  if (is("c")) set_camera(camera_index_ + 1);
  if (is("o")) settings.layer = next(settings.layer, 6);
  if (is("b")) settings.bundle = !settings.bundle;
  if (is("x")) settings.split = !settings.split;
  if (is("[") && settings.bounces > 0) --settings.bounces;
  if (is("]") && settings.bounces < 32) ++settings.bounces;
  if (is("l")) settings.headlight = !settings.headlight;
  if (is("-")) settings.exposure = std::max(-16.0f, settings.exposure - 0.25f);
  if (is("=")) settings.exposure = std::min(16.0f, settings.exposure + 0.25f);
  if (is("z") && facts_) {
    settings.up = next(settings.up, 2);
    rig = CameraRig(rig.camera(), facts_->bounds, settings.up);
  }
  if (is("space")) play(!playing_);
  if (is(",")) step(-1);
  if (is(".")) step(1);
  if (is("f12")) save();
  if (is("tab")) settings.panel = !settings.panel;
  if (is("p")) settings.plots = !settings.plots;
  if (is("f1") || is("h")) settings.help = !settings.help;
  if (is("escape")) {
    settings.help = false;
    pick_.reset();
    pending_pick_.reset();
  }
}

}  // namespace raysheaf::viewer
