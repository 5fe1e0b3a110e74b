#include "parse/verify.h"

#include <algorithm>

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

CLI::App* add_verify(CLI::App& app, VerifyCommand& command) {
  CLI::App* sub = app.add_subcommand("verify", "Check on this machine what raysheaf promises");
  add_words(
      *sub, "--only",
      "brute-force, determinism, watertight, bounds or exact; may be given more than once [all]",
      "PROMISE", command.options.promises,
      [](const std::string& name) { return promise_from_string(name); });
  add_value(*sub, "--seed", "N", "Seed of the first round [1]",
            [&command](const auto& text) { command.options.seed = parse_seed(text); });
  add_count(*sub, "--rounds", command.rounds, 0, 1000000,
            "Rounds of each promise, up to 1000000; 0 takes a minute or two in all [0]");
  sub->add_flag("--long", command.is_long, "1 000 000 000 rays of watertight, 10 000 000 of exact");
  add_count(*sub, "--threads", command.options.threads, 0, 1024,
            "The most threads, up to 1024 and no more than cores; 0 is all [0]");
  sub->add_option("--json", command.json_path, "The report as JSON")->type_name("FILE.json");
  sub->add_flag("-q,--quiet", command.quiet, "No progress bar");
  sub->footer(
      "Examples:\n"
      "  raysheaf verify\n"
      "  raysheaf verify --only watertight --long --json watertight.json\n"
      "  raysheaf verify --only bounds --seed 17 --rounds 1");
  sub->callback([sub, &command] {
    const std::vector<Promise>& all = command.options.promises;
    const auto is_long = [](Promise p) {
      return p == Promise::kWatertight || p == Promise::kExact;
    };
    if (command.is_long && !all.empty() && std::none_of(all.begin(), all.end(), is_long))
      throw CLI::ValidationError("--long",
                                 "it is for watertight and exact, which --only leaves out");
    if (command.is_long && !all.empty() && std::all_of(all.begin(), all.end(), is_long) &&
        sub->get_option("--rounds")->count() > 0)
      throw CLI::ValidationError("--rounds", "--long makes as many as it takes");
  });
  return sub;
}

}  // namespace raysheaf::app
