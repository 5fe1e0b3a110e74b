#include "apps/support/scene_argument.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "apps/support/closest.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {

SceneDescription builtin_from_name(const std::string& name, const std::string& place) {
  const std::vector<std::string> names = builtin_scene_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw Error(ErrorCode::kInvalidArgument,
                fmt::format("no built-in scene has this name; the names are {}{}",
                            fmt::join(names, ", "), did_you_mean(name, names)),
                place);
  }
  return builtin_scene(name);
}

SceneDescription scene_from_argument(const std::string& argument, const LoadOptions& options) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (argument.starts_with(kBuiltin)) {
    return builtin_from_name(argument.substr(kBuiltin.size()), argument);
  }
  return load_scene(argument, options);
}

}  // namespace raysheaf::app
