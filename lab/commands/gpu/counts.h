// The output of `raysheaf bench gpu --counts`.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "raysheaf/device_bench.h"

namespace raysheaf::app {

struct SceneWalks {
  std::string scene;
  DeviceWalksReport report;
};

/// A table in Markdown with a row for each scene and each of its kinds of rays.
[[nodiscard]] std::string counts_table(const std::vector<SceneWalks>& scenes);
[[nodiscard]] nlohmann::ordered_json counts_json(const std::vector<SceneWalks>& scenes);

}  // namespace raysheaf::app
