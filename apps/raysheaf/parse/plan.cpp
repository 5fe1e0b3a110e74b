#include "parse/commands.h"

#include <tuple>

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_bench_plan(CLI::App& bench, BenchPlanCommand& command) {
  CLI::App* sub =
      bench.add_subcommand("plan", "Measure what dual chooses against its other choices");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  add_compared_scenes(*sub, command.scenes, command.scene_names, command.kinds, command.modes);
  add_value(
      *sub, "--size", "WxH", "Size of the image that the rays come from [512x512]",
      [&command](const auto& text) { std::tie(command.width, command.height) = parse_size(text); });
  begin_group(*sub, kMeasurementGroup);
  add_threads(*sub, command.threads);
  add_count(*sub, "--runs", command.runs, 1, 1000, "Rounds, whose median counts [9]");
  sub->add_flag("--check", command.check,
                "Fail if a plan is more than 10 % slower than the best choice");
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--json", "FILE.json", "Write all figures as JSON", command.json_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench plan --scene builtin:office\n"
      "  raysheaf bench plan --scenes DIR --kind shadow --json plan.json");
  return sub;
}

}  // namespace raysheaf::app
