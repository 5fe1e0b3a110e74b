#include "parse/commands.h"

#include "apps/support/values.h"
#include "lab/commands/ablation/ablation.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_bench_gpu(CLI::App& bench, BenchGpuCommand& command) {
  CLI::App* sub = bench.add_subcommand("gpu", "Measure the stages of ray queries on a CUDA device");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  sub->add_option("--scenes", command.scenes, "Folder of scenes [the built-in scenes]")
      ->type_name("DIR");
  sub->add_option("--scene", command.scene_names,
                  "A scene: a known name, builtin:NAME, hall:TRIANGLES or a file [all]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  DeviceBenchOptions& options = command.options;
  add_words(
      *sub, "--rays",
      "Kind of rays: shadow, reflection1, reflection2 or ao; may be given more than once [all]",
      "NAME", options.rays, lab_rays_from_string);
  add_value(
      *sub, "--size", "WxH", "Size of the image that the rays come from [512x512]",
      [&options](const auto& text) { std::tie(options.width, options.height) = parse_size(text); });
  begin_group(*sub, kMeasurementGroup);
  add_count(*sub, "--runs", options.runs, 1, 1000, "Runs, whose median time counts [9]");
  add_threads(*sub, options.threads,
              "Threads of the CPU for comparison, up to 1024; 0 uses all cores [0]");
  sub->add_flag("--counts", command.counts,
                "Only count nodes, triangles and iterations of warps per ray, without a device");
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--json", "FILE.json", "Write all figures as JSON", command.json_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench gpu --scene builtin:atrium\n"
      "  raysheaf bench gpu --scenes DIR --size 2048x2048 --json gpu.json\n"
      "  raysheaf bench gpu --counts --scene builtin:office");
  return sub;
}

}  // namespace raysheaf::app
