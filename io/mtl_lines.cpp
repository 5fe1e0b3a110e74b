#include "io/mtl_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <vector>

#include "io/obj_lines.h"
#include "io/srgb.h"

namespace raysheaf::io {
namespace {

bool is_color(std::string_view keyword) {
  constexpr std::string_view kColors[] = {"Ka", "Kd", "Ks", "Ke", "Kt", "Tf"};
  return std::find(std::begin(kColors), std::end(kColors), keyword) != std::end(kColors);
}

bool is_map(std::string_view keyword) {
  constexpr std::string_view kOthers[] = {"bump", "disp", "decal", "refl", "norm"};
  return keyword.starts_with("map_") ||
         std::find(std::begin(kOthers), std::end(kOthers), keyword) != std::end(kOthers);
}

/// A map's option with a list of numbers, of which the last ones are optional.
struct MapOption {
  std::string_view name;
  std::size_t count;
  std::string_view fallback;
};
const MapOption* numbers_of(std::string_view option) {
  static constexpr MapOption kOptions[] = {
      {"-o", 3, "0"}, {"-s", 3, "1"}, {"-t", 3, "0"}, {"-mm", 2, "1"}};
  const auto* const found =
      std::find_if(std::begin(kOptions), std::end(kOptions),
                   [&](const MapOption& known) { return known.name == option; });
  return found == std::end(kOptions) ? nullptr : found;
}
/// Whether the option is followed by a word.
bool has_word(std::string_view option) {
  constexpr std::string_view kOptions[] = {"-blendu", "-blendv", "-bm",         "-boost",
                                           "-cc",     "-clamp",  "-colorspace", "-imfchan",
                                           "-texres", "-type"};
  return std::find(std::begin(kOptions), std::end(kOptions), option) != std::end(kOptions);
}

/// The same in every locale.
std::string text_of(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

class MtlRewriter {
 public:
  explicit MtlRewriter(const std::function<void(const std::string&)>& warn) : warn_(warn) {}

  std::string rewrite(std::string_view text) {
    while (!text.empty()) add(take_line(text));
    return std::move(result_);
  }

 private:
  void add(std::string_view line) {
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (is_color(keyword))
      add_color(keyword, words_of(rest), line);
    else if (keyword == "d")
      add_dissolve(words_of(rest), line);
    else if (is_map(keyword))
      add_map(keyword, rest);
    else if (keyword == "newmtl" && !trim(rest).empty())
      add_material(line);
    else
      add_line(line);
  }

  void add_line(std::string_view line) { (result_ += line) += '\n'; }
  void add_words(std::initializer_list<std::string_view> words) {
    for (const std::string_view word : words) (result_ += word) += ' ';
    result_ += '\n';
  }

  /// Adds the defaults that the parser lacks: without illum it assumes model 0, and a map_Kd
  /// without Kd is grey, unless an earlier material has a Kd.
  void add_material(std::string_view line) {
    add_line(line);
    add_line("illum 2");
    add_line("Kd 0 0 0");
  }

  /// "r g b", "xyz x y z" or "spectral file factor". Missing components equal the first one.
  void add_color(std::string_view keyword, std::vector<std::string_view> words,
                 std::string_view line) {
    const std::string_view space = words.empty() ? std::string_view{} : words[0];
    if (space == "spectral") return add_spectral(keyword);
    if (space == "xyz") words.erase(words.begin());
    const auto end = std::find_if_not(words.begin(), words.end(), is_number);
    words.erase(end, words.end());
    if (words.empty()) return add_line(line);
    words.resize(std::max<std::size_t>(words.size(), 3), words[0]);
    if (space != "xyz") return add_words({keyword, words[0], words[1], words[2]});
    const Double3 rgb = rgb_of_xyz({number_of(words[0]), number_of(words[1]), number_of(words[2])});
    add_words({keyword, text_of(rgb.x), text_of(rgb.y), text_of(rgb.z)});
  }

  void add_spectral(std::string_view keyword) {
    if (keyword == "Ka") return;
    warn_("Colours that name a spectral file are left out; Kd is grey then.");
    if (keyword == "Kd") add_line("Kd 0.8 0.8 0.8");
  }

  /// "factor" or "-halo factor".
  void add_dissolve(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.size() < 2 || words[0] != "-halo") return add_line(line);
    warn_("Halos (d -halo) are left out: such materials are equally transparent from all sides.");
    add_words({"d", words[1]});
  }

  /// Options, then a name that may contain blanks. Drops the colour correction -cc, which is meant
  /// for a display: the parser would read it as part of the name.
  void add_map(std::string_view keyword, std::string_view rest) {
    (result_ += keyword) += ' ';
    for (std::string_view after = rest; !after.empty(); rest = after) {
      const std::string_view option = take_word(after);
      if (const MapOption* numbers = numbers_of(option)) {
        add_option(*numbers, &after);
      } else if (has_word(option)) {
        const std::string_view word = take_word(after);
        if (option != "-cc") result_ += std::string(option) + " " + std::string(word) + " ";
      } else {
        break;
      }
    }
    add_line(trim(rest));
  }
  void add_option(const MapOption& option, std::string_view* rest) {
    (result_ += option.name) += ' ';
    for (std::size_t i = 0; i < option.count; ++i) {
      std::string_view after = *rest;
      const std::string_view word = take_word(after);
      const bool is_said = is_number(word);
      if (is_said) *rest = after;
      (result_ += is_said ? word : option.fallback) += ' ';
    }
  }

  const std::function<void(const std::string&)>& warn_;
  std::string result_;
};

}  // namespace

std::string plain_mtl(std::string_view text, const std::function<void(const std::string&)>& warn) {
  return MtlRewriter(warn).rewrite(text);
}

}  // namespace raysheaf::io
