#include "parse/gpu.h"

#include "ablation/ablation.h"
#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

CLI::App* add_bench_gpu(CLI::App& bench, BenchGpuCommand& command) {
  CLI::App* sub = bench.add_subcommand("gpu", "Time the stages of ray queries on a CUDA device");
  sub->add_option("--scenes", command.scenes, "Folder of scenes [the built-in scenes]")
      ->type_name("DIR");
  sub->add_option("--scene", command.scene_names,
                  "A scene: a known name, builtin:NAME, hall:TRIANGLES or a file [all]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  DeviceBenchOptions& options = command.options;
  add_words(*sub, "--rays", "shadow, reflection1, reflection2 or ao; may be repeated [all]", "NAME",
            options.rays, lab_rays_from_string);
  add_value(
      *sub, "--size", "WxH", "Size of the picture that rays come from [512x512]",
      [&options](const auto& text) { std::tie(options.width, options.height) = parse_size(text); });
  add_count(*sub, "--runs", options.runs, 1, 1000, "Runs whose median counts [9]");
  add_count(*sub, "--threads", options.threads, 0, 1024,
            "Of the CPU beside it, up to 1024; 0 is all cores [0]");
  sub->add_flag("--counts", command.counts,
                "Only count nodes, triangles and turns of warps a ray; needs no device");
  sub->add_option("--json", command.json_path, "All figures as JSON")->type_name("FILE.json");
  sub->add_flag("-q,--quiet", command.quiet, "No progress bar");
  sub->footer(
      "Examples:\n"
      "  raysheaf bench gpu --scene builtin:atrium\n"
      "  raysheaf bench gpu --scenes DIR --size 2048x2048 --json gpu.json\n"
      "  raysheaf bench gpu --counts --scene builtin:office");
  return sub;
}

}  // namespace raysheaf::app
