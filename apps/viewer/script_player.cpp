#include "script_player.h"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "raysheaf/error.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr int kDragFrames = 10;

/// `parse_script` has checked that it is a number.
float number(const std::string& text) {
  float value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

float radians(const std::string& text) {
  return number(text) * kPi / 180;
}

int button_of(const std::vector<std::string>& words, std::size_t at) {
  if (words.size() <= at || words[at] == "left") return 0;
  if (words[at] == "right") return 1;
  if (words[at] == "middle") return 2;
  throw Error(ErrorCode::kInvalidData, "'" + words[at] + "' is none of left, right, middle");
}

InputEvent cursor_event(InputEvent::Type type, float x, float y, int button, double now_s) {
  InputEvent event;
  event.type = type;
  event.x = x;
  event.y = y;
  event.button = button;
  event.time_s = now_s;
  return event;
}

bool holds(const std::string& left, const std::string& comparison, const std::string& right) {
  if (comparison == "is") return left == right;
  if (comparison == "is-not") return left != right;
  if (comparison == "contains") return left.find(right) != std::string::npos;
  char* left_end = nullptr;
  char* right_end = nullptr;
  const double a = std::strtod(left.c_str(), &left_end);
  const double b = std::strtod(right.c_str(), &right_end);
  if (left.empty() || *left_end != 0 || right.empty() || *right_end != 0) return false;
  if (comparison == "<") return a < b;
  if (comparison == "<=") return a <= b;
  if (comparison == ">") return a > b;
  return a >= b;
}

}  // namespace

ScriptPlayer::ScriptPlayer(Script script, Model& model, ScriptHost& host)
    : script_(std::move(script)), model_(model), host_(host) {
  // The first command starts after the viewer's first scene has been loaded.
  ready_ = [this](double) { return !model_.loading(); };
}

void ScriptPlayer::wait_until(Ready ready) {
  ready_ = std::move(ready);
}

void ScriptPlayer::step(double now_s) {
  if (since_s_ == 0) since_s_ = now_s;
  for (;;) {
    if (ready_) {
      if (!ready_(now_s)) {
        if (now_s - since_s_ < patience_s) return;
        const bool first = next_ == 0;
        throw Error(ErrorCode::kInvalidData,
                    "waited without success for " + std::to_string(static_cast<int>(patience_s)) +
                        " s; the last note was: " + model_.last_note().text,
                    first ? script_.file : script_.place(script_.commands[next_ - 1]));
      }
      ready_ = nullptr;
    }
    if (done()) return;
    const ScriptCommand& command = script_.commands[next_++];
    since_s_ = now_s;
    try {
      begin(command, now_s);
    } catch (const Error& error) {
      throw Error(ErrorCode::kInvalidData, error.sentence(), script_.place(command));
    }
  }
}

void ScriptPlayer::begin(const ScriptCommand& command, double now_s) {
  const Words& words = command.words;
  const std::string& verb = words[0];
  if (const SettingField* field = find_setting(verb)) {
    field->set(model_.settings, words[1]);
    if (verb == "width" || verb == "height")
      host_.resize(model_.settings.width, model_.settings.height);
    return;
  }
  if (move_camera(words) || use_hand(words, now_s) || wait_for(words, now_s)) return;
  if (verb == "size") {
    const auto side = [](const std::string& text) {
      return static_cast<std::uint32_t>(std::clamp(number(text), 64.0f, 16384.0f));
    };
    host_.resize(side(words[1]), side(words[2]));
    wait_until([now_s](double now) { return now - now_s > 0.2; });
  } else if (verb == "play" || verb == "pause") {
    model_.play(verb == "play");
  } else if (verb == "time") {
    model_.seek(number(words[1]));
  } else if (verb == "clip") {
    if (!(number(words[1]) >= 0)) throw Error(ErrorCode::kInvalidData, "clips count from 0");
    model_.set_clip(static_cast<std::uint32_t>(std::min(number(words[1]), 1e6f)));
  } else if (verb == "assert") {
    check(words);
  } else if (verb == "print") {
    host_.print(words[1] + " " + value(words[1]) + "\n");
  } else if (verb == "quit") {
    next_ = script_.commands.size();
  }
}

bool ScriptPlayer::move_camera(const Words& words) {
  const std::string& verb = words[0];
  CameraRig& rig = model_.rig;
  if (verb == "orbit") {
    rig.orbit(radians(words[1]), radians(words[2]));
  } else if (verb == "look") {
    rig.look(radians(words[1]), radians(words[2]));
  } else if (verb == "pan") {
    rig.pan(number(words[1]), number(words[2]));
  } else if (verb == "zoom") {
    if (!(number(words[1]) > 0)) throw Error(ErrorCode::kInvalidData, "the factor must be above 0");
    rig.zoom(number(words[1]));
  } else if (verb == "fly") {
    rig.fly(number(words[1]), number(words[2]), number(words[3]));
  } else {
    return false;
  }
  return true;
}

void ScriptPlayer::press(const std::string& key, bool down, double now_s) {
  InputEvent event;
  event.type = down ? InputEvent::Type::kKeyDown : InputEvent::Type::kKeyUp;
  event.text = key;
  event.time_s = now_s;
  for (const auto& [prefix, flag] :
       {std::pair("ctrl+", &event.control), {"shift+", &event.shift}}) {
    if (!event.text.starts_with(prefix)) continue;
    *flag = true;
    event.text = event.text.substr(std::string(prefix).size());
  }
  host_.send(event);
}

void ScriptPlayer::drag(const Words& words, double now_s) {
  using Type = InputEvent::Type;
  const int button = button_of(words, 5);
  const float x = number(words[1]), y = number(words[2]);
  const float dx = number(words[3]) - x, dy = number(words[4]) - y;
  host_.send(cursor_event(Type::kMove, x, y, button, now_s));
  host_.send(cursor_event(Type::kButtonDown, x, y, button, now_s));
  int frame = 0;
  wait_until([=, this](double now) mutable {
    const float part = static_cast<float>(++frame) / kDragFrames;
    host_.send(cursor_event(Type::kMove, x + dx * part, y + dy * part, button, now));
    if (frame < kDragFrames) return false;
    host_.send(cursor_event(Type::kButtonUp, x + dx, y + dy, button, now));
    return true;
  });
}

bool ScriptPlayer::use_hand(const Words& words, double now_s) {
  using Type = InputEvent::Type;
  const std::string& verb = words[0];
  if (verb == "press") {
    press(words[1], true, now_s);
    press(words[1], false, now_s);
  } else if (verb == "hold") {
    press(words[1], true, now_s);
    const double end = now_s + number(words[2]);
    wait_until([this, key = words[1], end](double now) {
      if (now >= end) press(key, false, now);
      return now >= end;
    });
  } else if (verb == "move" || verb == "click") {
    const float x = number(words[1]), y = number(words[2]);
    host_.send(cursor_event(Type::kMove, x, y, 0, now_s));
    if (verb == "click") {
      host_.send(cursor_event(Type::kButtonDown, x, y, 0, now_s));
      host_.send(cursor_event(Type::kButtonUp, x, y, 0, now_s));
    }
  } else if (verb == "drag") {
    drag(words, now_s);
  } else if (verb == "drop") {
    InputEvent event;
    event.type = Type::kDrop;
    event.text = words[1];
    host_.send(event);
    wait_until([this](double) { return !model_.loading(); });
  } else {
    return false;
  }
  return true;
}

bool ScriptPlayer::wait_for(const Words& words, double now_s) {
  const std::string& verb = words[0];
  if (verb == "wait") {
    const double end = now_s + number(words[1]);
    wait_until([end](double now) { return now >= end; });
  } else if (verb == "wait-for-picture") {
    wait_until([this](double) { return model_.shows_now(); });
  } else if (verb == "wait-for-refined") {
    const float samples = words.size() > 1 ? number(words[1]) : 0;
    wait_until([this, samples](double) {
      if (samples == 0) return model_.refined();
      return model_.up_to_date() && static_cast<float>(model_.picture()->samples) >= samples;
    });
  } else if (verb == "wait-for-bundle") {
    wait_until([this](double) { return model_.bundle_up_to_date(); });
  } else if (verb == "screenshot") {
    host_.take_screenshot(words[1]);
    wait_until([this](double) { return host_.screenshot_done(); });
  } else if (verb == "save") {
    model_.save(words[1]);
    wait_until([this](double) { return !model_.saving(); });
  } else if (verb == "measure-latency") {
    host_.start_latency(number(words[1]), button_of(words, 2));
    wait_until([this](double) {
      const Latency* latency = host_.latency();
      if (latency != nullptr) host_.print(latency->histogram());
      return latency != nullptr;
    });
  } else {
    return false;
  }
  return true;
}

std::string ScriptPlayer::value(const std::string& name) const {
  const Latency* latency = host_.latency();
  const auto text = [](double ms) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.3f", ms);
    return std::string(buffer);
  };
  if (latency != nullptr) {
    if (name == "latency-median") return text(latency->percentile(0.5));
    if (name == "latency-95") return text(latency->percentile(0.95));
    if (name == "latency-99") return text(latency->percentile(0.99));
    if (name == "latency-largest") return text(latency->largest());
    if (name == "latency-events") return std::to_string(latency->count());
  }
  if (const auto of_window = host_.value(name)) return *of_window;
  return model_.value(name);
}

void ScriptPlayer::check(const Words& words) {
  const std::string actual = value(words[1]);
  if (holds(actual, words[2], words[3])) return;
  throw Error(ErrorCode::kInvalidData, "this comparison fails: " + words[1] + " " + words[2] + " " +
                                           words[3] + "; it is " + actual);
}

}  // namespace raysheaf::viewer
