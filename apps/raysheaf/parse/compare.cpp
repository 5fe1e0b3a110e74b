#include "parse/commands.h"

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {
namespace {

void add_choice(CLI::App& app, BenchCompareCommand& command) {
  add_compared_scenes(app, command.scenes, command.scene_names, command.kinds, command.modes);
  app.add_flag(
      "--growth", command.growth,
      "Measure time against triangles and against rays in generated halls, instead of scenes");
  add_value(app, "--ground", "LENGTH",
            "Put a square of two triangles below each scene, from -LENGTH to LENGTH [none]",
            [&command](const std::string& text) { command.ground = parse_positive(text); });
  add_count(app, "--most", command.most, 10'000, 10'000'000,
            "Largest numbers of rays and triangles of --growth, 10000 to 10000000 [10000000]");
}

void check_compare(const CLI::App& app, const BenchCompareCommand& command) {
  if (command.growth && !(command.scenes.empty() && command.scene_names.empty()))
    throw CLI::ValidationError("--growth", "it has its own scenes: omit --scene and --scenes");
  if (command.growth && command.sizes.size() > 1)
    throw CLI::ValidationError("--size", "--growth takes only one size");
  if (command.growth && command.ground != 0)
    throw CLI::ValidationError("--ground", "it is only for scenes, not for --growth");
  if (!command.growth && app.get_option("--most")->count() > 0)
    throw CLI::ValidationError("--most", "it is only for --growth");
}

}  // namespace

void add_compared_scenes(CLI::App& app, std::string& folder, std::vector<std::string>& scenes,
                         std::vector<CompareKind>& kinds, std::vector<CompareMode>& modes) {
  app.add_option("--scenes", folder, "Folder of scenes [the built-in scenes]")->type_name("DIR");
  add_words(app, "--scene", "A scene: a known name, builtin:NAME, hall:TRIANGLES or a file [all]",
            "NAME", scenes, [](const std::string& name) { return name; });
  add_words(app, "--kind", "Kind of rays: shadow, mirror, second, ao or random [all]", "NAME",
            kinds, compare_kind_from_string);
  add_words(app, "--mode", "How the scene moves: rebuild, refit or static [all]", "NAME", modes,
            compare_mode_from_string);
}

CLI::App* add_bench_compare(CLI::App& bench, BenchCompareCommand& command) {
  CLI::App* sub = bench.add_subcommand(
      "compare", "Measure the library against Embree 4 and Embree 3, alternating");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  add_choice(*sub, command);
  add_words(*sub, "--size",
            "Size of the image that the rays come from; may be given more than once [512x512]",
            "WxH", command.sizes, parse_size);
  begin_group(*sub, kMeasurementGroup);
  add_threads(*sub, command.threads);
  add_count(*sub, "--runs", command.runs, 1, 1000, "Pairs of runs, whose median ratio counts [9]");
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--csv", "FILE.csv", "Write all figures, a line for each case",
                command.csv_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench compare --scene builtin:office --mode rebuild\n"
      "  raysheaf bench compare --scene builtin:office --size 256x256 --size 2048x2048\n"
      "  raysheaf bench compare --scenes DIR --csv all.csv\n"
      "  raysheaf bench compare --growth --kind mirror --csv growth.csv");
  sub->callback([sub, &command] { check_compare(*sub, command); });
  return sub;
}

}  // namespace raysheaf::app
