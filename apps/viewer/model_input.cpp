// The actions of keys, buttons and the wheel.
#include <algorithm>
#include <cmath>

#include "model.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr float kDegreesAWindow = 220;
constexpr float kZoomAStep = 0.88f;
constexpr float kZoomAWindow = 3;  ///< logarithm of the factor of a drag from top to bottom
constexpr float kOrbitStep = 15 * kPi / 180;
constexpr int kPage = 10;              ///< entries of the dialog
constexpr float kClickReach = 0.004f;  ///< of the window: a drag that moves less is a click
constexpr double kDoubleClick = 0.35;
constexpr float kFaster = 4;

const std::set<std::string>& flying_keys() {
  static const std::set<std::string> keys = {"w", "a",    "s",     "d",  "q",
                                             "e", "left", "right", "up", "down"};
  return keys;
}

/// The next of the words that the setting offers.
void next_background(ViewSettings& settings) {
  const SettingField& field = *find_setting("background");
  const auto now = std::find(field.words.begin(), field.words.end(), field.get(settings));
  const bool is_last = now == field.words.end() || now + 1 == field.words.end();
  field.set(settings, is_last ? field.words.front() : now[1]);
}

template <class Enum>
Enum next(Enum value, int count) {
  return static_cast<Enum>((static_cast<int>(value) + 1) % count);
}

}  // namespace

const std::vector<KeyHelp>& key_help() {
  static const std::vector<KeyHelp> help = {
      {"", "Mouse"},
      {"left drag", "orbit around the pivot"},
      {"middle drag, Shift + left drag", "move sideways"},
      {"Ctrl + drag, wheel", "move nearer, farther"},
      {"right drag", "look around"},
      {"click", "show what is under the cursor"},
      {"double click", "set the pivot there"},
      {"", "View"},
      {"1, 3, 7", "front, right, top"},
      {"Ctrl + 1, 3, 7", "back, left, bottom"},
      {"9", "isometric view"},
      {"5", "orthographic, perspective"},
      {"4 6, 2 8", "orbit in steps"},
      {"F, Home", "show the whole scene"},
      {"R, Enter", "return to the first view"},
      {"C", "next camera of the scene"},
      {"U", "z or y points up"},
      {"W A S D, Q E", "fly, faster with Shift"},
      {"arrows", "look around"},
      {"", "Show"},
      {"Z", "edges of the triangles"},
      {"G", "grid on the ground"},
      {"X", "directions of the axes"},
      {"K", "next background"},
      {"- =", "darker, brighter"},
      {"L", "light at the camera"},
      {"space", "play, pause"},
      {", .", "previous, next frame"},
      {"", "File"},
      {"Ctrl + O", "open a file"},
      {"F5", "read the file again"},
      {"F12, Ctrl + S", "save the image in full quality"},
      {"Ctrl + Q", "quit"},
      {"", "Laboratory"},
      {"Tab", "settings"},
      {"P", "plots of times and tests"},
      {"O", "next overlay: tests, normals, ..."},
      {"M, Shift + 1 to 5", "next method, a method"},
      {"V", "two methods side by side"},
      {"B", "bundle of rays under the cursor"},
      {"[ ]", "fewer, more bounces"},
      {"F1, H", "these keys"},
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
      if (over_panel || dialog_ || dragged_button_ >= 0) break;
      dragged_button_ = event.button;
      drag_moved_ = false;
      drag_ = drag_of(event);
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
      if (!over_panel && !dialog_)
        rig.zoom(std::pow(kZoomAStep, std::clamp(event.y, -20.0f, 20.0f)));
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
  const float aspect = static_cast<float>(window_.width) / static_cast<float>(window_.height);
  switch (drag_) {
    case Drag::kPan:
      rig.pan(-dx * aspect, dy);
      break;
    case Drag::kZoom:
      rig.zoom(std::exp(kZoomAWindow * dy));
      break;
    case Drag::kOrbit:
      rig.orbit(dx * angle, -dy * angle);
      break;
    case Drag::kLook:
      rig.look(dx * angle, -dy * angle);
      break;
  }
}

Model::Drag Model::drag_of(const InputEvent& event) const {
  if (event.button == 1) return Drag::kLook;
  if (event.control) return Drag::kZoom;
  if (event.shift) return Drag::kPan;
  const bool pans = event.button == 2 && settings.middle_drag == ViewSettings::MiddleDrag::kPan;
  return pans ? Drag::kPan : Drag::kOrbit;
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
  if (key == "f1" || (key == "h" && !event.control)) {
    settings.help = !settings.help;
  } else if (event.control && key == "q") {
    quit_ = true;
  } else if (event.control && key == "o") {
    open_dialog(!dialog_);
  } else if (dialog_key(key) || view_key(event)) {
    return;
  } else if (event.control) {
    if (key == "s") save();
  } else {
    if (flying_keys().contains(key)) held_.insert(key);
    setting_key(event);
  }
}

bool Model::dialog_key(const std::string& key) {
  if (!dialog_) return false;
  if (key == "up" || key == "down") dialog_->move(key == "up" ? -1 : 1);
  if (key == "home" || key == "end") dialog_->move(key == "home" ? -kPage : kPage);
  if (key == "backspace" || key == "left") dialog_->leave();
  if (key == "enter" || key == "right") {
    choose_file(dialog_->selected());
  } else if (key == "escape") {
    open_dialog(false);
  }
  ++version_;
  return true;
}

bool Model::view_key(const InputEvent& event) {
  const std::string& key = event.text;
  const auto is = [&key](const char* name) { return key == name; };
  const auto sides = [&](ViewSide side, ViewSide opposite) {
    look_from(event.control ? opposite : side);
    return true;
  };
  if (event.shift && key.size() == 1 && key[0] >= '1' && key[0] <= '9') return false;
  if (is("1")) return sides(ViewSide::kFront, ViewSide::kBack);
  if (is("3")) return sides(ViewSide::kRight, ViewSide::kLeft);
  if (is("7")) return sides(ViewSide::kTop, ViewSide::kBottom);
  if (event.control) return false;
  if (is("9")) look_from(ViewSide::kIso);
  if (is("5")) toggle_orthographic();
  if (is("4") || is("6")) rig.orbit(is("4") ? kOrbitStep : -kOrbitStep, 0);
  if (is("2") || is("8")) rig.orbit(0, is("2") ? kOrbitStep : -kOrbitStep);
  if (is("kp+") || is("kp-")) rig.zoom(is("kp+") ? kZoomAStep : 1 / kZoomAStep);
  if ((is("f") || is("home")) && facts_) rig.frame(facts_->bounds);
  if (is("r") || is("enter")) set_camera(camera_index_);
  if (is("c")) set_camera(camera_index_ + 1);
  return false;
}

void Model::setting_key(const InputEvent& event) {
  const std::string& key = event.text;
  const auto is = [&key](const char* name) { return key == name; };
  if (event.shift && key.size() == 1 && key[0] >= '1' && key[0] <= '5')
    settings.left.method = static_cast<Method>(key[0] - '1');
  if (is("m")) settings.left.method = next(settings.left.method, 5);
  if (is("o")) settings.layer = next(settings.layer, 6);
  if (is("b")) settings.bundle = !settings.bundle;
  if (is("v")) settings.split = !settings.split;
  if (is("z")) settings.wireframe = !settings.wireframe;
  if (is("g")) settings.grid = !settings.grid;
  if (is("x")) settings.axes = !settings.axes;
  if (is("k")) next_background(settings);
  if (is("[") && settings.bounces > 0) --settings.bounces;
  if (is("]") && settings.bounces < 32) ++settings.bounces;
  if (is("l")) settings.headlight = !settings.headlight;
  if (is("-")) settings.exposure = std::max(-16.0f, settings.exposure - 0.25f);
  if (is("=")) settings.exposure = std::min(16.0f, settings.exposure + 0.25f);
  if (is("u")) settings.up = settings.up == UpAxis::kY ? UpAxis::kZ : UpAxis::kY;
  if (is("space")) play(!playing_);
  if (is(",")) step(-1);
  if (is(".")) step(1);
  if (is("f5")) reload();
  if (is("f12")) save();
  if (is("tab")) settings.panel = !settings.panel;
  if (is("p")) settings.plots = !settings.plots;
  if (is("escape")) {
    settings.help = false;
    pick_.reset();
    pending_pick_.reset();
  }
}

}  // namespace raysheaf::viewer
