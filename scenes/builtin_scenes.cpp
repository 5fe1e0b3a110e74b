#include "raysheaf/builtin_scenes.h"

#include <array>
#include <string>

#include "raysheaf/error.h"
#include "scenes/scenes.h"

namespace raysheaf {
namespace {

struct Entry {
  std::string_view name;
  SceneDescription (*make)();
};

constexpr std::array<Entry, 3> kScenes = {{
    {"office", builtin::office},
    {"cornell", builtin::cornell},
    {"atrium", builtin::atrium},
}};

}  // namespace

std::vector<std::string> builtin_scene_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kScenes) names.emplace_back(entry.name);
  return names;
}

SceneDescription builtin_scene(std::string_view name) {
  std::string known;
  for (const Entry& entry : kScenes) {
    if (entry.name == name) return entry.make();
    known += known.empty() ? "" : ", ";
    known += entry.name;
  }
  throw Error(ErrorCode::kNotFound, "no such built-in scene; there are " + known,
              "builtin:" + std::string(name));
}

}  // namespace raysheaf
