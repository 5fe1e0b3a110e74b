#include "parse/scale.h"

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command) {
  CLI::App* sub =
      bench.add_subcommand("scale", "What streamed frames take, measured, fitted and carried on");
  add_value(*sub, "--triangles", "N", "The scene that is asked about, also with K, M or G [1G]",
            [&command](const auto& text) { command.triangles = parse_amount(text); });
  add_count(*sub, "--machines", command.machines, 2, 65536, "How many, 2 to 65536 [64]");
  add_count(*sub, "--cores", command.cores, 1, 1024, "Of a machine, 1 to 1024 [16]");
  add_count(*sub, "--disk", command.disk_mb_s, 1, 1'000'000,
            "What a machine reads, MB a second [2000]");
  add_count(*sub, "--network", command.network_mb_s, 1, 1'000'000,
            "What a machine sends, MB a second [1250]");
  add_value(*sub, "--measured", "N",
            "Triangles of the largest hall that is rendered, 100K to 200M; its file lies in TMPDIR "
            "meanwhile [16M]",
            [&command](const std::string& text) {
              const std::uint64_t triangles = parse_amount(text);
              if (triangles < 100'000 || triangles > 200'000'000)
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not from 100K to 200M");
              command.measured_triangles = triangles;
            });
  add_count(*sub, "--side", command.side, 32, 4096, "Pixels along the picture, 32 to 4096 [512]");
  add_count(*sub, "--threads", command.threads, 0, 1024, "Threads, up to 1024; 0 is all cores [0]");
  sub->add_option(
         "--mpirun", command.mpirun,
         "What starts processes, with its options: runs of one and of two are held against "
         "what is expected of them [mpirun, bound to no core, where there is one]")
      ->type_name("COMMAND");
  sub->add_option("--json", command.json_path, "All measurements")->type_name("FILE.json");
  sub->add_option("--markdown", command.markdown_path, "A page")->type_name("FILE.md");
  sub->add_flag("-q,--quiet", command.quiet, "No progress bar");
  sub->footer(
      "Examples:\n"
      "  raysheaf bench scale --measured 1M --side 128\n"
      "  raysheaf bench scale --triangles 1G --machines 64 --markdown scale.md");
  return sub;
}

}  // namespace raysheaf::app
