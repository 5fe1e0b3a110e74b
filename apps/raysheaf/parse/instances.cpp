#include "apps/support/values.h"
#include "parse/commands.h"
#include "parse/parts.h"

namespace raysheaf::app {
namespace {

InstancesShape parse_shape(const std::string& text) {
  constexpr std::uint32_t kMostInstances = 1'000'000, kFewest = 16, kMostTriangles = 10'000'000;
  const std::size_t x = text.find('x');
  if (x == std::string::npos)
    throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not like 50x1024");
  return {parse_count(text.substr(0, x), 1, kMostInstances),
          parse_count(text.substr(x + 1), kFewest, kMostTriangles)};
}

template <class Value>
Value one_of(const std::string& text, const char* first, Value a, const char* second, Value b) {
  if (text != first && text != second)
    throw Error(ErrorCode::kInvalidArgument,
                "'" + text + "' is neither " + first + " nor " + second);
  return text == first ? a : b;
}

}  // namespace

CLI::App* add_bench_instances(CLI::App& bench, BenchInstancesCommand& command) {
  CLI::App* sub = bench.add_subcommand(
      "instances", "Measure instances that move or stand still, against Embree's, alternating");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  add_words(*sub, "--shape",
            "So many instances of a mesh of so many triangles; may be given more than once "
            "[50x1024, 400x20164, 10000x1024]",
            "NxM", command.shapes, parse_shape);
  add_words(*sub, "--rays", "Rays in a batch [10, 1000, 10000, 262144]", "N", command.rays,
            [](const std::string& text) { return parse_count(text, 1, 100'000'000); });
  add_words(*sub, "--kind", "Kind of rays: camera or random [both]", "NAME", command.kinds,
            [](const std::string& text) {
              return one_of(text, "camera", InstanceRays::kCamera, "random", InstanceRays::kRandom);
            });
  add_words(*sub, "--mode", "Whether all instances move in each frame: moved or still [both]",
            "NAME", command.moved,
            [](const std::string& text) { return one_of(text, "moved", true, "still", false); });
  sub->add_flag("--flat", command.flat,
                "Also measure the scene with its instances placed, which takes its memory");
  begin_group(*sub, kMeasurementGroup);
  add_threads(*sub, command.threads);
  add_count(*sub, "--runs", command.runs, 1, 1000, "Rounds, whose median ratio counts [9]");
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--csv", "FILE.csv", "Write all figures, a line for each case",
                command.csv_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench instances --shape 50x1024 --mode moved --threads 1\n"
      "  raysheaf bench instances --shape 400x20164 --mode still --flat --csv still.csv");
  return sub;
}

}  // namespace raysheaf::app
