#include "report/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace raysheaf::app {
namespace {

/// What both commands share: all that is not as it is by default.
std::string view_and_rays(const RenderOptions& o) {
  const RenderOptions usual;
  std::string text = fmt::format(" --size {}x{}", o.width, o.height);
  const auto add = [&text](bool differs, const std::string& words) {
    if (differs) text += " " + words;
  };
  add(!o.camera.empty(), "--camera " + quoted(o.camera));
  if (o.exposure) add(true, fmt::format("--exposure {}", *o.exposure));
  if (o.ambient)
    add(true, fmt::format("--ambient {},{},{}", o.ambient->x, o.ambient->y, o.ambient->z));
  add(o.bounces != usual.bounces, fmt::format("--bounces {}", o.bounces));
  add(!o.shadows, "--no-shadows");
  add(!o.reflections, "--no-reflections");
  add(!o.refractions, "--no-refractions");
  add(o.early_out, "--early-out");
  add(o.primary == Primary::kTrace, "--primary trace");
  add(o.levels != usual.levels, fmt::format("--levels {}", o.levels));
  add(o.branching != usual.branching, fmt::format("--branching {}", o.branching));
  if (o.key) add(true, fmt::format("--key {}", to_string(*o.key)));
  if (o.key_bits) add(true, fmt::format("--key-bits {}", *o.key_bits));
  if (o.bound) add(true, fmt::format("--bound {}", to_string(*o.bound)));
  if (o.mesh_culling) add(true, fmt::format("--mesh-culling {}", *o.mesh_culling ? "on" : "off"));
  add(o.threads != 0, fmt::format("--threads {}", o.threads));
  return text;
}

std::string scene_words(const ReportCommand& command) {
  return quoted(command.scene) + (command.load.allow_external ? " --allow-external" : "");
}

}  // namespace

std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-./:,=+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string command_line(const ReportCommand& command) {
  std::string text = "raysheaf report " + scene_words(command) + " -o " + quoted(command.output) +
                     view_and_rays(command.options);
  for (const Method method : command.methods)
    text += fmt::format(" --method {}", to_string(method));
  return text;
}

std::string stats_command_line(const ReportCommand& command, Method method) {
  return fmt::format("raysheaf render {} -o {}.png --stats {}.json{} --method {}",
                     scene_words(command), to_string(method), to_string(method),
                     view_and_rays(command.options), to_string(method));
}

}  // namespace raysheaf::app
