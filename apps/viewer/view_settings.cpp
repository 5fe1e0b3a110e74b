#include "view_settings.h"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "raysheaf/error.h"

namespace raysheaf::viewer {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& sentence) {
  throw Error(ErrorCode::kInvalidArgument, sentence, name);
}

std::string list(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

double number(const std::string& name, const std::string& text, double low, double high) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= low && value <= high))
    refuse(name, "must be a number from " + number_text(low) + " to " + number_text(high) +
                     ", not '" + text + "'");
  return value;
}

const std::vector<std::string> kSwitch = {"off", "on"};
const std::vector<std::string> kMethods = {"brute", "rah", "crsh", "gl10", "dual"};
const std::vector<std::string> kLayers = {"beauty", "tests", "normal", "albedo", "shadow", "ids"};
const std::vector<std::string> kLabRays = {"shadow", "reflection", "reflection-2", "occlusion"};
constexpr const char* kOwn = "own";  ///< that of the method

std::vector<std::string> key_words() {
  std::vector<std::string> words = {kOwn};
  for (const RayKeyEntry& entry : kRayKeys) words.emplace_back(entry.name);
  return words;
}

std::vector<std::string> bound_words() {
  std::vector<std::string> words = {kOwn};
  for (int b = 0; b <= static_cast<int>(BundleBound::kShaftAndCone); ++b)
    words.emplace_back(to_string(static_cast<BundleBound>(b)));
  return words;
}

std::size_t place_of(const std::string& name, const std::vector<std::string>& words,
                     const std::string& text) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == text) return i;
  refuse(name, "'" + text + "' is none of " + list(words));
}

/// One of `words`, by its index.
template <class Get, class Set>
SettingField choice(const std::string& name, std::string what,
                    const std::vector<std::string>& words, Get get, Set set) {
  SettingField field{name, std::move(what), words, {}, {}};
  field.get = [get, words](const ViewSettings& s) { return words[get(s)]; };
  field.set = [set, name, words](ViewSettings& s, const std::string& text) {
    set(s, place_of(name, words, text));
  };
  return field;
}

template <class Value>
SettingField enumeration(const std::string& name, std::string what,
                         const std::vector<std::string>& words, Value ViewSettings::*member) {
  return choice(
      name, std::move(what), words,
      [member](const ViewSettings& s) { return static_cast<std::size_t>(s.*member); },
      [member](ViewSettings& s, std::size_t i) { s.*member = static_cast<Value>(i); });
}

template <class Value>
SettingField numeric(const std::string& name, std::string what, double low, double high,
                     Value ViewSettings::*member) {
  SettingField field{name, std::move(what), {}, {}, {}};
  field.get = [member](const ViewSettings& s) { return number_text(s.*member); };
  field.set = [=](ViewSettings& s, const std::string& text) {
    const double value = number(name, text, low, high);
    if (std::is_integral_v<Value> && value != std::floor(value))
      refuse(name, "must be a whole number, not '" + text + "'");
    s.*member = static_cast<Value>(value);
  };
  return field;
}

/// An optional field of a `MethodChoice`, whose first word is "own".
template <class Value>
SettingField own_or(const std::string& name, std::string what,
                    const std::vector<std::string>& words, MethodChoice ViewSettings::*side,
                    std::optional<Value> MethodChoice::*member) {
  return choice(
      name, std::move(what), words,
      [=](const ViewSettings& s) {
        const std::optional<Value>& value = (s.*side).*member;
        return value ? static_cast<std::size_t>(*value) + 1 : 0;
      },
      [=](ViewSettings& s, std::size_t i) {
        std::optional<Value>& value = (s.*side).*member;
        value.reset();
        if (i > 0) value = static_cast<Value>(i - 1);
      });
}

SettingField shape(const std::string& name, std::string what, std::uint32_t low, std::uint32_t high,
                   MethodChoice ViewSettings::*side, std::uint32_t MethodChoice::*member) {
  SettingField field{name, std::move(what), {}, {}, {}};
  field.get = [=](const ViewSettings& s) { return number_text((s.*side).*member); };
  field.set = [=](ViewSettings& s, const std::string& text) {
    const double value = number(name, text, low, high);
    if (value != std::floor(value)) refuse(name, "must be a whole number, not '" + text + "'");
    (s.*side).*member = static_cast<std::uint32_t>(value);
  };
  return field;
}

/// `prefix`: "" or "right-".
void add_side(const std::string& prefix, MethodChoice ViewSettings::*side,
              std::vector<SettingField>& all) {
  const std::string of = prefix.empty() ? "" : "right side of the split: ";
  all.push_back(choice(
      prefix + "method", of + "how intersections are found", kMethods,
      [side](const ViewSettings& s) { return static_cast<std::size_t>((s.*side).method); },
      [side](ViewSettings& s, std::size_t i) { (s.*side).method = static_cast<Method>(i); }));
  all.push_back(shape(prefix + "levels", of + "levels of the ray hierarchy", 1, 8, side,
                      &MethodChoice::levels));
  all.push_back(shape(prefix + "branching", of + "children of a node", 2, 64, side,
                      &MethodChoice::branching));
  all.push_back(
      own_or(prefix + "key", of + "sort key of the rays", key_words(), side, &MethodChoice::key));
  all.push_back(choice(
      prefix + "key-bits", of + "bits of the key, if it exists in both widths", {"32", "64"},
      [side](const ViewSettings& s) { return std::size_t{(s.*side).key_bits == 64 ? 1u : 0u}; },
      [side](ViewSettings& s, std::size_t i) { (s.*side).key_bits = i == 0 ? 32 : 64; }));
  all.push_back(own_or(prefix + "bound", of + "bounding volume of a bundle of rays", bound_words(),
                       side, &MethodChoice::bound));
  all.push_back(own_or(prefix + "mesh-culling", of + "test bounding spheres of meshes first",
                       {kOwn, "off", "on"}, side, &MethodChoice::mesh_culling));
}

constexpr const char* kSky = "sky";

SettingField background_field() {
  SettingField field{"background",
                     "what is behind the scene: the sky, or a color, such as #20262e",
                     {kSky, "white", "#d8dbe0", "#2b2d33", "black"},
                     {},
                     {}};
  field.get = [](const ViewSettings& s) -> std::string {
    if (!s.background) return kSky;
    const Rgba color = *s.background;
    if (color == Rgba{255, 255, 255, 255}) return "white";
    if (color == Rgba{0, 0, 0, 255}) return "black";
    char code[8];
    std::snprintf(code, sizeof code, "#%02x%02x%02x", color[0], color[1], color[2]);
    return code;
  };
  field.set = [](ViewSettings& s, const std::string& text) {
    if (text == kSky) {
      s.background.reset();
      return;
    }
    try {
      const Rgba color = background_from_string(text);
      if (color[3] == 255) s.background = color;
      if (color[3] == 255) return;
    } catch (const Error&) {  // the sentence below names the sky, too
    }
    refuse("background", "'" + text + "' is none of sky, white, black and #RRGGBB");
  };
  return field;
}

std::vector<SettingField> make_fields() {
  using S = ViewSettings;
  std::vector<SettingField> all;
  add_side("", &S::left, all);
  add_side("right-", &S::right, all);
  all.push_back(enumeration("split", "two methods side by side", kSwitch, &S::split));
  all.push_back(
      numeric("divider", "position of the split, as a part of the width", 0, 1, &S::divider));
  all.push_back(enumeration("device", "device that traces the rays", {"cpu", "cuda"}, &S::device));
  all.push_back(numeric("threads", "threads that trace; 0 uses all cores", 0, 1024, &S::threads));
  all.push_back(
      numeric("bounces", "longest chain of reflections and refractions", 0, 32, &S::bounces));
  all.push_back(enumeration("shadows", "trace shadow rays", kSwitch, &S::shadows));
  all.push_back(enumeration("reflections", "trace mirror reflections", kSwitch, &S::reflections));
  all.push_back(enumeration("refractions", "trace refractions", kSwitch, &S::refractions));
  all.push_back(
      enumeration("early-out", "stop shadow rays at their first hit", kSwitch, &S::early_out));
  all.push_back(numeric("light", "factor on all lights", 0, 100, &S::light));
  all.push_back(enumeration("headlight", "light at the camera", kSwitch, &S::headlight));
  all.push_back(
      numeric("exposure", "exposure in stops, added to the automatic one", -16, 16, &S::exposure));
  all.push_back(enumeration("overlay", "layer that is shown", kLayers, &S::layer));
  all.push_back(enumeration("bundle", "draw the bundle under the cursor", kSwitch, &S::bundle));
  all.push_back(
      enumeration("bundle-rays", "kind of rays in the bundle", kLabRays, &S::bundle_rays));
  all.push_back(enumeration("bar", "bar of menus", kSwitch, &S::bar));
  all.push_back(enumeration("panel", "panel of settings", kSwitch, &S::panel));
  all.push_back(enumeration("plots", "plots of times and counts", kSwitch, &S::plots));
  all.push_back(enumeration("help", "list of keys", kSwitch, &S::help));
  all.push_back(numeric("samples", "samples at which refinement stops", 1, 4096, &S::samples));
  all.push_back(numeric("answer-ms", "goal for the time of an image while the camera moves", 5,
                        1000, &S::answer_ms));
  all.push_back(enumeration("moving", "what is shown while the camera moves", {"preview", "trace"},
                            &S::moving));
  all.push_back(enumeration("wireframe", "edges of the triangles", kSwitch, &S::wireframe));
  all.push_back(enumeration("grid", "grid on the ground", kSwitch, &S::grid));
  all.push_back(enumeration("axes", "directions of x, y and z", kSwitch, &S::axes));
  all.push_back(background_field());
  all.push_back(enumeration("reload", "read the scene again when one of its files changes", kSwitch,
                            &S::reload));
  all.push_back(enumeration("middle-drag", "what a drag with the middle button does",
                            {"pan", "orbit"}, &S::middle_drag));
  all.push_back(
      enumeration("up", "the axis that points up", {"x", "y", "z", "-x", "-y", "-z"}, &S::up));
  all.push_back(numeric("speed", "flying speed, in quarters of the scene's size per second", 0.001,
                        1000, &S::speed));
  all.push_back(numeric("width", "width of the window", 320, 16384, &S::width));
  all.push_back(numeric("height", "height of the window", 240, 16384, &S::height));
  return all;
}

}  // namespace

const std::vector<SettingField>& setting_fields() {
  static const std::vector<SettingField> fields = make_fields();
  return fields;
}

const SettingField* find_setting(const std::string& name) {
  for (const SettingField& field : setting_fields())
    if (field.name == name) return &field;
  return nullptr;
}

RenderOptions render_options(const ViewSettings& settings, const MethodChoice& choice) {
  RenderOptions options;
  static_cast<MethodChoice&>(options) = choice;
  options.threads = settings.threads;
  options.bounces = settings.bounces;
  options.shadows = settings.shadows;
  options.reflections = settings.reflections;
  options.refractions = settings.refractions;
  options.early_out = settings.early_out;
  options.count_pixel_tests = settings.layer == Layer::kTests;
  return options;
}

bool same_picture(const ViewSettings& a, const ViewSettings& b) {
  ViewSettings c = b;
  c.divider = a.divider;
  c.bundle = a.bundle;
  c.bundle_rays = a.bundle_rays;
  c.bar = a.bar;
  c.panel = a.panel;
  c.plots = a.plots;
  c.help = a.help;
  c.answer_ms = a.answer_ms;
  c.moving = a.moving;
  c.wireframe = a.wireframe;
  c.grid = a.grid;
  c.axes = a.axes;
  c.reload = a.reload;
  c.middle_drag = a.middle_drag;
  c.up = a.up;
  c.speed = a.speed;
  c.width = a.width;
  c.height = a.height;
  if (!a.split && !b.split) c.right = a.right;
  return a == c;
}

}  // namespace raysheaf::viewer
