#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "options.h"
#include "raysheaf/io.h"
#include "verify/report.h"

namespace raysheaf::app {
namespace {

constexpr std::uint64_t kLongEdgeRays = 1'000'000'000, kLongExactRays = 10'000'000;

VerifyReport verified(const VerifyCommand& command) {
  VerifyOptions options = command.options;
  options.rounds = command.rounds;
  options.seconds = command.seconds;
  if (command.is_long) {
    options.edge_rays = kLongEdgeRays;
    options.exact_rays = kLongExactRays;
  }
  ProgressBar bar(stderr, !command.quiet);
  options.progress = [&bar](const Progress& progress) {
    bar.update(progress.stage, progress.done, progress.total);
    return !interrupted();
  };
  return verify(options);
}

}  // namespace

int run(const VerifyCommand& command) {
  catch_interrupts();
  const std::string json =
      command.json_path.empty() ? command.json_path : writable_path(command.json_path);
  const VerifyReport report = verified(command);
  print(verify_text(report));
  if (!json.empty()) write_text(verify_json(report), json);
  return report.kept() ? kSuccess : kFailed;
}

}  // namespace raysheaf::app
