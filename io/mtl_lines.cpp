#include "io/mtl_lines.h"

#include <algorithm>
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
    else
      add_line(line);
  }

  void add_line(std::string_view line) { (result_ += line) += '\n'; }
  void add_words(std::initializer_list<std::string_view> words) {
    for (const std::string_view word : words) (result_ += word) += ' ';
    result_ += '\n';
  }

  /// "r g b", "xyz x y z" or "spectral file factor"; what is left out after the first number is
  /// equal to it.
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
    add_words({keyword, std::to_string(rgb.x), std::to_string(rgb.y), std::to_string(rgb.z)});
  }

  void add_spectral(std::string_view keyword) {
    if (keyword == "Ka") return;
    warn_("Colours that name a spectral file are left out; grey stands in for that of Kd.");
    if (keyword == "Kd") add_line("Kd 0.8 0.8 0.8");
  }

  /// "factor" or "-halo factor".
  void add_dissolve(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.size() < 2 || words[0] != "-halo") return add_line(line);
    warn_("Halos (d -halo) are left out: such materials are as thin from every side.");
    add_words({"d", words[1]});
  }

  const std::function<void(const std::string&)>& warn_;
  std::string result_;
};

}  // namespace

std::string plain_mtl(std::string_view text, const std::function<void(const std::string&)>& warn) {
  return MtlRewriter(warn).rewrite(text);
}

}  // namespace raysheaf::io
