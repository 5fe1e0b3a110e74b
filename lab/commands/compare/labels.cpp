// Short texts about a case.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "lab/commands/compare/compare.h"

namespace raysheaf::app {
namespace {

/// A plan sentence that begins with one of these states a choice. The choice is the part after
/// "object tree: " or a similar word, up to the first comma.
struct Choice {
  std::string_view begin, text;
  bool adds_choice = false;
};

constexpr std::array<Choice, 3> kChoices = {{
    {"object tree: ", "tree ", true},
    {"bundles: ", "", true},
    {"order: tiles", "tiles"},
}};

std::string chosen_in(std::string_view sentence) {
  for (const Choice& choice : kChoices) {
    if (!sentence.starts_with(choice.begin)) continue;
    const std::string_view rest = sentence.substr(choice.begin.size());
    return std::string(choice.text) +
           std::string(choice.adds_choice ? rest.substr(0, rest.find(',')) : "");
  }
  return {};
}

}  // namespace

std::string size_text(const ImageSize& size) {
  return fmt::format("{}x{}", size.first, size.second);
}

std::string label_of(const CompareCase& c) {
  return c.one_of_sizes ? c.scene + " " + size_text(c.size) : c.scene;
}

std::string short_plan(const std::vector<std::string>& plan) {
  std::string text;
  for (const std::string& sentence : plan) {
    const std::string choice = chosen_in(sentence);
    if (!choice.empty()) text += (text.empty() ? "" : ", ") + choice;
  }
  return text;
}

}  // namespace raysheaf::app
