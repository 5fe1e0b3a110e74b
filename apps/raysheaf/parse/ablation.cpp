#include "parse/commands.h"

#include <algorithm>

#include "apps/support/values.h"
#include "lab/commands/ablation/ablation.h"
#include "parse/parts.h"

namespace raysheaf::app {
namespace {

/// Parses the parts of "a,b,c", each once. "all" stands for the values in `all`.
template <typename Value, typename Parse>
std::vector<Value> parse_list(const std::string& text, const std::vector<Value>& all, Parse parse) {
  if (text == "all" && !all.empty()) return all;
  std::vector<Value> values;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const Value value = parse(text.substr(start, end - start));
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
    start = end + 1;
  }
  return values;
}

template <typename Value, typename Parse>
void add_list(CLI::App& app, const std::string& option, const std::string& type,
              const std::string& text, std::vector<Value>& values, std::vector<Value> all,
              Parse parse) {
  add_value(app, option, type, text,
            [&values, all = std::move(all), parse](const std::string& given) {
              values = parse_list(given, all, parse);
            });
}

void add_counts(CLI::App& app, const std::string& option, const std::string& text,
                std::vector<std::uint32_t>& values, std::uint32_t low, std::uint32_t high) {
  add_list(app, option, "N,...", text, values, {},
           [low, high](const std::string& part) { return parse_count(part, low, high); });
}

void add_axes(CLI::App& app, BenchAblationCommand& command) {
  add_list(app, "--rays", "NAME,...",
           "Kinds of rays: shadow, reflection1, reflection2 and ao [all]", command.rays,
           all_lab_rays(), lab_rays_from_string);
  add_list(app, "--keys", "NAME,...", "Sort keys of the rays [all]", command.keys, all_keys(),
           [](const std::string& name) { return key_from_string(name); });
  add_list(app, "--key-bits", "32,64", "Bits of the keys that exist in both widths [32,64]",
           command.key_bits, {}, parse_key_bits);
  add_list(app, "--bounds", "NAME,...", "Bounding volumes for bundles of rays [all]",
           command.bounds, all_bounds(),
           [](const std::string& name) { return bound_from_string(name); });
  add_counts(app, "--levels", "Levels of the ray hierarchy, 1 to 8 [2]", command.levels, 1, 8);
  add_counts(app, "--branching", "Children of a node, 2 to 64 [8]", command.branching, 2, 64);
  add_value(app, "--mesh-culling", "on|off|both",
            "Test bounding spheres of meshes before their triangles [on]",
            [&command](const std::string& text) {
              command.mesh_culling =
                  text == "both" ? std::vector<bool>{false, true} : std::vector{parse_switch(text)};
            });
}

void add_files(CLI::App& app, BenchAblationCommand& command) {
  add_data_file(app, "--json", "FILE.json", "Write all figures as JSON", command.json_path);
  add_data_file(app, "--csv", "FILE.csv", "Write all figures as CSV, one measurement per line",
                command.csv_path);
}

void check_ablation(const BenchAblationCommand& command) {
  if (!command.scene.empty() && !command.scenes.empty())
    throw CLI::ValidationError("--scenes", "give either SCENE or a folder, not both");
}

}  // namespace

CLI::App* add_bench_ablation(CLI::App& bench, BenchAblationCommand& command) {
  command.rays = all_lab_rays();
  command.keys = all_keys();
  command.bounds = all_bounds();
  CLI::App* sub =
      bench.add_subcommand("ablation", "Count tests and measure times of every key and bound");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  sub->add_option(
      "SCENE", command.scene,
      "A scene: a file (" + scene_file_endings_text() + ") or builtin:NAME [the built-in scenes]");
  sub->add_option("--scenes", command.scenes, "Measure every scene in a folder")->type_name("DIR");
  add_axes(*sub, command);
  add_value(*sub, "--size", "WxH", "Size of the image [512x512]", [&command](const auto& text) {
    std::tie(command.width, command.height) = parse_size(text);
  });
  begin_group(*sub, kMeasurementGroup);
  add_threads(*sub, command.threads);
  add_count(*sub, "--repeat", command.repeat, 1, 1000,
            "Measurements of each case, of which the median time counts, 1 to 1000 [1]");
  sub->add_flag("--check", command.check, "Compare every hit with brute force");
  begin_group(*sub, kOutputGroup);
  add_files(*sub, command);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench ablation --size 128x128 --json ablation.json\n"
      "  raysheaf bench ablation model.glb --rays shadow --keys crsh --csv m.csv\n"
      "  raysheaf bench ablation model.glb --levels 1,2,3 --branching 4,8");
  sub->callback([&command] { check_ablation(command); });
  return sub;
}

}  // namespace raysheaf::app
