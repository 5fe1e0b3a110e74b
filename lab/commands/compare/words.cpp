#include "lab/commands/compare/words.h"

#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

template <typename Word>
Word word_from(const std::string& name, const std::vector<Word>& all, const char* what) {
  std::string known;
  for (const Word word : all) {
    if (name == to_string(word)) return word;
    known += (known.empty() ? "" : ", ") + std::string(to_string(word));
  }
  throw Error(ErrorCode::kInvalidArgument, "'" + name + "' is no " + what + "; there are " + known);
}

}  // namespace

std::vector<CompareKind> all_compare_kinds() {
  return {CompareKind::kShadow, CompareKind::kMirror, CompareKind::kSecond,
          CompareKind::kAmbientOcclusion, CompareKind::kRandom};
}

std::vector<CompareMode> all_compare_modes() {
  return {CompareMode::kRebuild, CompareMode::kRefit, CompareMode::kStatic};
}

const char* to_string(CompareKind kind) {
  switch (kind) {
    case CompareKind::kShadow:
      return "shadow";
    case CompareKind::kMirror:
      return "mirror";
    case CompareKind::kSecond:
      return "second";
    case CompareKind::kAmbientOcclusion:
      return "ao";
    case CompareKind::kRandom:
      break;
  }
  return "random";
}

const char* to_string(CompareMode mode) {
  switch (mode) {
    case CompareMode::kRebuild:
      return "rebuild";
    case CompareMode::kRefit:
      return "refit";
    case CompareMode::kStatic:
      break;
  }
  return "static";
}

CompareKind compare_kind_from_string(const std::string& name) {
  return word_from(name, all_compare_kinds(), "kind of rays");
}

CompareMode compare_mode_from_string(const std::string& name) {
  return word_from(name, all_compare_modes(), "mode");
}

bool asks_for_any_hit(CompareKind kind) {
  return kind == CompareKind::kShadow || kind == CompareKind::kAmbientOcclusion;
}

}  // namespace raysheaf::app
