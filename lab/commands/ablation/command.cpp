#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/ablation/ablation.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

AblationReport measured(const BenchAblationCommand& command) {
  ProgressBar bar(stderr, !command.quiet);
  return measure_ablation(command,
                          [&bar](const std::string& what, std::uint64_t done, std::uint64_t total) {
                            stop_if_interrupted();
                            bar.update(what, done, total);
                          });
}

}  // namespace

int run(const BenchAblationCommand& command) {
  catch_interrupts();
  OutputFiles files;
  files.reads_scene(command.scene);
  const std::string json = files.open(command.json_path), csv = files.open(command.csv_path);
  const AblationReport report = measured(command);
  print(ablation_text(report));
  if (!json.empty()) write_text(ablation_json(report), json);
  if (!csv.empty()) write_text(ablation_csv(report), csv);
  return kSuccess;
}

}  // namespace raysheaf::app
