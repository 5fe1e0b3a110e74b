#include "parse/scale.h"

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command) {
  CLI::App* sub = bench.add_subcommand(
      "scale", "Measure streamed frames and predict the time of larger scenes");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  add_value(*sub, "--triangles", "N", "Triangles of the scene to predict, also with K, M or G [1G]",
            [&command](const auto& text) { command.triangles = parse_amount(text); });
  add_count(*sub, "--machines", command.machines, 2, 65536,
            "Machines that share the work, 2 to 65536 [64]");
  add_count(*sub, "--cores", command.cores, 1, 1024, "Cores of each machine, 1 to 1024 [16]");
  add_count(*sub, "--disk", command.disk_mb_s, 1, 1'000'000,
            "MB per second that each machine reads [2000]");
  add_count(*sub, "--network", command.network_mb_s, 1, 1'000'000,
            "MB per second that each machine sends [1250]");
  begin_group(*sub, kMeasurementGroup);
  add_value(*sub, "--measured", "N",
            "Triangles of the largest hall that is rendered, 100K to 200M; its file is in TMPDIR "
            "during the run [16M]",
            [&command](const std::string& text) {
              const std::uint64_t triangles = parse_amount(text);
              if (triangles < 100'000 || triangles > 200'000'000)
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not from 100K to 200M");
              command.measured_triangles = triangles;
            });
  add_count(*sub, "--side", command.side, 32, 4096,
            "Width and height of the image in pixels, 32 to 4096 [512]");
  add_threads(*sub, command.threads);
  sub->add_option(
         "--mpirun", command.mpirun,
         "Command that starts processes, with its options: runs of one and of two processes are "
         "compared with the prediction [mpirun without binding to cores, if it is installed]")
      ->type_name("COMMAND");
  begin_group(*sub, kOutputGroup);
  sub->add_option("--json", command.json_path, "Write all measurements as JSON")
      ->type_name("FILE.json");
  sub->add_option("--markdown", command.markdown_path, "Write a page with tables")
      ->type_name("FILE.md");
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench scale --measured 1M --side 128\n"
      "  raysheaf bench scale --triangles 1G --machines 64 --markdown scale.md");
  return sub;
}

}  // namespace raysheaf::app
