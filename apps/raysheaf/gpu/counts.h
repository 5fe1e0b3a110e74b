// What `raysheaf bench gpu --counts` prints and writes.
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

/// A table in Markdown: a row for each scene and kind of rays that has any.
[[nodiscard]] std::string counts_table(const std::vector<SceneWalks>& scenes);
[[nodiscard]] nlohmann::ordered_json counts_json(const std::vector<SceneWalks>& scenes);

}  // namespace raysheaf::app
