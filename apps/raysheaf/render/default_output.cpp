#include "render/default_output.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "render/frames_command.h"

namespace raysheaf::app {

bool writes_nothing(const RenderCommand& command) {
  const bool counts_frames = wants_frames(command) && !command.stats_path.empty();
  return command.pictures.empty() && !counts_frames && command.heatmap_path.empty() &&
         !command.explain;
}

std::string default_picture(const std::string& scene) {
  namespace fs = std::filesystem;
  constexpr std::string_view kBuiltin = "builtin:";
  std::string stem =
      scene.starts_with(kBuiltin) ? scene.substr(kBuiltin.size()) : fs::path(scene).stem().string();
  // Characters of patterns and of frame numbers.
  const auto is_no_letter = [](char c) { return c == '*' || c == '?' || c == '%'; };
  stem.erase(std::remove_if(stem.begin(), stem.end(), is_no_letter), stem.end());
  if (stem.empty() || stem.front() == '-') stem = "picture" + stem;
  std::string name = stem + ".png";
  std::error_code failed;
  for (std::uint32_t n = 2; fs::symlink_status(name, failed).type() != fs::file_type::not_found;
       ++n)
    name = stem + "-" + std::to_string(n) + ".png";
  return name;
}

}  // namespace raysheaf::app
