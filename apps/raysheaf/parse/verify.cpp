#include "parse/commands.h"

#include <algorithm>

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_verify(CLI::App& app, VerifyCommand& command) {
  CLI::App* sub = app.add_subcommand("verify", "Check the promises of raysheaf on this machine");
  add_words(
      *sub, "--only",
      "brute-force, determinism, watertight, bounds, exact, instances or history; may be given "
      "more than once [all]",
      "PROMISE", command.options.promises,
      [](const std::string& name) { return promise_from_string(name); });
  add_value(*sub, "--seed", "N", "Seed of the first round [1]",
            [&command](const auto& text) { command.options.seed = parse_seed(text); });
  add_count(*sub, "--rounds", command.rounds, 0, 1000000,
            "Rounds of each promise, up to 1000000; 0 runs for a minute or two in total [0]");
  add_count(*sub, "--seconds", command.seconds, 0, 1000000,
            "Run each promise for so many seconds, up to 1000000; 0 counts rounds [0]");
  sub->add_flag("--long", command.is_long,
                "Run 1 000 000 000 rays of watertight and 10 000 000 rays of exact");
  add_count(*sub, "--threads", command.options.threads, 0, 1024,
            "Most threads, up to 1024 and at most the number of cores; 0 uses all cores [0]");
  add_data_file(*sub, "--json", "FILE.json", "Write the report as JSON", command.json_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf verify\n"
      "  raysheaf verify --only watertight --long --json watertight.json\n"
      "  raysheaf verify --only history --seconds 600\n"
      "  raysheaf verify --only bounds --seed 17 --rounds 1");
  sub->callback([sub, &command] {
    const std::vector<Promise>& all = command.options.promises;
    const auto is_long = [](Promise p) {
      return p == Promise::kWatertight || p == Promise::kExact;
    };
    if (command.is_long && !all.empty() && std::none_of(all.begin(), all.end(), is_long))
      throw CLI::ValidationError("--long",
                                 "it is only for watertight and exact, which --only leaves out");
    if (command.is_long && !all.empty() && std::all_of(all.begin(), all.end(), is_long) &&
        sub->get_option("--rounds")->count() > 0)
      throw CLI::ValidationError("--rounds", "--long sets the number of rounds itself");
    if (command.seconds > 0 && (command.rounds > 0 || command.is_long))
      throw CLI::ValidationError("--seconds", "it excludes --rounds and --long");
  });
  return sub;
}

}  // namespace raysheaf::app
