#include "parse/commands.h"

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command) {
  CLI::App* sub = bench.add_subcommand(
      "scale", "Measure streamed frames, from which the time of larger scenes is predicted");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  add_value(*sub, "--measured", "N",
            "Triangles of the largest hall that is rendered, 100K to 200M; its file is in TMPDIR "
            "during the run [16M]",
            [&command](const std::string& text) {
              const std::uint64_t triangles = parse_amount(text);
              if (triangles < 100'000 || triangles > 200'000'000)
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not from 100K to 200M");
              command.triangles = triangles;
            });
  add_count(*sub, "--side", command.side, 32, 4096,
            "Width and height of the image in pixels, 32 to 4096 [512]");
  begin_group(*sub, kMeasurementGroup);
  add_threads(*sub, command.threads);
  sub->add_option(
         "--mpirun", command.mpirun,
         "Command that starts processes, with its options: runs of one and of two processes are "
         "compared [mpirun without binding to cores, if it is installed]")
      ->type_name("COMMAND");
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--json", "FILE.json", "Write all measurements as JSON", command.json_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench scale --measured 1M --side 128\n"
      "  raysheaf bench scale --threads 2 --json scale.json");
  return sub;
}

}  // namespace raysheaf::app
