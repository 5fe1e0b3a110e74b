#include "io/mtl_statements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/refuse.h"
#include "io/srgb.h"
#include "io/text_lines.h"

namespace raysheaf::io {
namespace {

/// A colour with a larger component has bytes; up to it, colours are only too bright.
constexpr float kMostBrightColor = 2;

/// A map or a number that is ignored, and the warning about it.
struct Ignored {
  std::string_view keyword;
  const char* sentence;
};
constexpr Ignored kIgnoredMaps[] = {{"bump", "Bump maps are left out."},
                                    {"map_bump", "Bump maps are left out."},
                                    {"disp", "Displacement maps are left out."},
                                    {"map_disp", "Displacement maps are left out."},
                                    {"map_ks", "Specular maps are left out."},
                                    {"map_ns", "Highlight maps are left out."},
                                    {"refl", "Reflection maps are left out."},
                                    {"map_pr", "Roughness maps are left out."},
                                    {"map_pm", "Metallic maps are left out."},
                                    {"map_ps", "Sheen is left out."},
                                    {"map_pc", "Clear coats are left out."},
                                    {"map_pcr", "Clear coats are left out."},
                                    {"decal", "Decals are left out."}};
constexpr Ignored kIgnoredNumbers[] = {{"ps", "Sheen is left out."},
                                       {"pc", "Clear coats are left out."},
                                       {"aniso", "Anisotropy is left out."}};

template <std::size_t kCount>
const char* sentence_about(const Ignored (&list)[kCount], std::string_view keyword) {
  for (const Ignored& ignored : list)
    if (ignored.keyword == keyword) return ignored.sentence;
  return nullptr;
}

/// Whether the option of a map is followed by a word.
bool has_word(std::string_view option) {
  constexpr std::string_view kOptions[] = {"-blendu", "-blendv", "-bm",         "-boost",
                                           "-cc",     "-clamp",  "-colorspace", "-imfchan",
                                           "-texres", "-type"};
  return std::find(std::begin(kOptions), std::end(kOptions), option) != std::end(kOptions);
}

class MtlReader {
 public:
  explicit MtlReader(const std::function<void(const std::string&)>& warn) : warn_(warn) {}

  std::vector<MtlMaterial> read(std::string_view text) {
    // Receives what precedes the first material.
    MtlMaterial nobody;
    material_ = &nobody;
    while (!text.empty()) {
      ++line_;
      std::string_view rest = take_line(text);
      const std::string keyword = in_lower_case(take_word(rest));
      if (!keyword.empty() && !keyword.starts_with('#')) read_statement(keyword, rest);
    }
    if (has_commas_) warn_(kCommaRemark);
    return std::move(materials_);
  }

 private:
  void read_statement(const std::string& keyword, std::string_view rest) {
    if (keyword == "newmtl") {
      begin_material(trim(rest));
    } else if (MtlMap* const map = map_of(keyword)) {
      read_map(rest, map);
    } else if (keyword.starts_with("map_") || sentence_about(kIgnoredMaps, keyword) != nullptr) {
      leave_out_map(keyword, trim(rest));
    } else {
      words_ = words_of(without_comment(rest));
      if (words_.empty()) return;
      if (Vec3* const color = color_of(keyword))
        read_color(keyword, color);
      else
        read_scalar(keyword);
    }
  }

  void begin_material(std::string_view name) {
    if (name.empty()) return;
    material_ = &materials_.emplace_back();
    material_->name = name;
    has_dissolve_ = false;
    transparency_ = 1;
  }

  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  float number(std::string_view word) {
    const std::optional<double> value = read_number(word, &has_commas_);
    const auto number = static_cast<float>(value.value_or(NAN));
    if (!std::isfinite(number)) refuse(in_quotes(word) + " is not a finite number", place());
    return number;
  }

  Vec3* color_of(std::string_view keyword) {
    if (keyword == "kd") return &color_;
    if (keyword == "ks") return &material_->specular;
    if (keyword == "ke") return &material_->emission;
    if (keyword == "kt" || keyword == "tf") return &material_->filter;
    return nullptr;
  }
  /// "r g b", "xyz x y z" or "spectral file factor".
  void read_color(std::string_view keyword, Vec3* color) {
    const std::string space = in_lower_case(words_[0]);
    if (space == "spectral") return leave_out_spectrum(keyword);
    const std::size_t first = space == "xyz" ? 1 : 0;
    if (words_.size() == first) refuse("has no numbers", place());
    std::array<float, 3> parts;
    for (std::size_t i = 0; i < 3; ++i)
      parts[i] = first + i < words_.size() ? number(words_[first + i]) : parts[0];
    *color = {parts[0], parts[1], parts[2]};
    if (first == 1) *color = narrow(rgb_of_xyz(widen(*color)));
    if (keyword != "ke") limit(color);
    if (keyword == "kd") material_->diffuse = *color;
  }
  void limit(Vec3* color) {
    const float largest = std::max({color->x, color->y, color->z});
    if (largest <= kMostUnitColor) return;
    const bool is_in_bytes = largest > kMostBrightColor;
    warn_(is_in_bytes ? kBytesRemark : "Colours exceed 1; they are reduced to 1.");
    for (float* part : {&color->x, &color->y, &color->z})
      *part = std::min(is_in_bytes ? *part / 255 : *part, 1.0f);
  }
  void leave_out_spectrum(std::string_view keyword) {
    warn_("Colours that name a spectral file are left out; Kd is grey then.");
    if (keyword == "kd") material_->diffuse.reset();
  }

  void read_scalar(std::string_view keyword) {
    if (keyword == "d") {
      const bool is_halo = in_lower_case(words_[0]) == "-halo";
      if (is_halo && words_.size() == 1) refuse("has no number", place());
      if (is_halo)
        warn_(
            "Halos (d -halo) are left out: such materials are equally transparent from all sides.");
      material_->dissolve = number(words_[is_halo ? 1 : 0]);
      has_dissolve_ = true;
      find_invisible();
    } else if (keyword == "tr") {
      transparency_ = number(words_[0]);
      // Programs that write both mean d.
      if (!has_dissolve_) material_->dissolve = 1 - transparency_;
      find_invisible();
    } else if (keyword == "illum") {
      material_->illum = static_cast<int>(std::clamp(number(words_[0]), -1.0f, 100.0f));
    } else if (float* const value = value_of(keyword)) {
      *value = number(words_[0]);
    } else if (const char* const sentence = sentence_about(kIgnoredNumbers, keyword)) {
      if (number(words_[0]) > 0) warn_(sentence);
    }
  }
  float* value_of(std::string_view keyword) {
    if (keyword == "ns") return &material_->shininess;
    if (keyword == "ni") return &material_->ior;
    if (keyword == "pr") return &material_->roughness;
    if (keyword == "pm") return &material_->metallic;
    return nullptr;
  }

  MtlMap* map_of(std::string_view keyword) {
    if (keyword == "map_kd") return &material_->diffuse_map;
    if (keyword == "map_ke") return &material_->emission_map;
    if (keyword == "norm") return &material_->normal_map;
    if (keyword == "map_d") return &material_->alpha_map;
    if (keyword == "map_ka") return &material_->ambient_map;
    return nullptr;
  }
  void leave_out_map(std::string_view keyword, std::string_view rest) {
    if (rest.empty() || keyword == "map_aat") return;
    const char* const sentence = sentence_about(kIgnoredMaps, keyword);
    warn_(sentence != nullptr ? sentence : "Maps of unknown kinds are left out.");
  }

  /// Options, then a name that may contain blanks.
  void read_map(std::string_view rest, MtlMap* map) {
    *map = {};
    bool is_turbulent = false, is_modified = false;
    for (std::string_view after = rest; !after.empty(); rest = after) {
      const std::string option = in_lower_case(take_word(after));
      if (option == "-o") {
        map->offset = pair_of(take_numbers<3>(&after, 0));
      } else if (option == "-s") {
        map->scale = pair_of(take_numbers<3>(&after, 1));
      } else if (option == "-t") {
        is_turbulent = take_numbers<3>(&after, 0) != std::array<float, 3>{};
      } else if (option == "-mm") {
        is_modified = take_numbers<2>(&after, 1, 0) != std::array<float, 2>{0, 1};
      } else if (has_word(option)) {
        set_option(option, take_word(after), map);
      } else {
        break;
      }
    }
    map->name = trim(rest);
    if (!map->is_named()) return;
    if (is_modified) warn_("The option -mm of maps is left out.");
    if (is_turbulent) warn_("The option -t of maps is left out.");
  }
  static Vec2 pair_of(const std::array<float, 3>& numbers) { return {numbers[0], numbers[1]}; }
  /// Up to `kCount` numbers; missing ones are `fallback`, or `first` if all are missing.
  template <std::size_t kCount>
  std::array<float, kCount> take_numbers(std::string_view* rest, float fallback) {
    return take_numbers<kCount>(rest, fallback, fallback);
  }
  template <std::size_t kCount>
  std::array<float, kCount> take_numbers(std::string_view* rest, float fallback, float first) {
    std::array<float, kCount> numbers;
    numbers.fill(fallback);
    numbers[0] = first;
    for (float& result : numbers) {
      std::string_view after = *rest;
      const std::string_view word = take_word(after);
      if (!read_number(word, &has_commas_)) break;
      result = number(word);
      *rest = after;
    }
    return numbers;
  }
  /// Some programs write "Tr 1" for what is opaque, or "d 0" next to "Tr 0".
  void find_invisible() {
    material_->is_invisible = has_dissolve_ && material_->dissolve == 0 && transparency_ == 1;
  }
  void set_option(std::string_view option, std::string_view word, MtlMap* map) {
    if (option == "-clamp") map->clamp = in_lower_case(word) == "on";
    if (option == "-imfchan" && !word.empty()) map->channel = in_lower_case(word)[0];
    if (option == "-bm") map->bump_multiplier = number(word);
  }

  const std::function<void(const std::string&)>& warn_;
  std::vector<MtlMaterial> materials_;
  MtlMaterial* material_ = nullptr;
  std::size_t line_ = 0;
  std::vector<std::string_view> words_;
  Vec3 color_;
  bool has_dissolve_ = false, has_commas_ = false;
  float transparency_ = 1;  ///< Tr, or 1
};

}  // namespace

std::vector<MtlMaterial> read_mtl(std::string_view text,
                                  const std::function<void(const std::string&)>& warn) {
  return MtlReader(warn).read(text);
}

}  // namespace raysheaf::io
