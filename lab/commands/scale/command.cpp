#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/scale/report.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {

int run(const BenchScaleCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string json = files.open(command.json_path);
  ScaleReport report;
  {
    ProgressBar bar(stderr, !command.quiet);
    report = measure_scale(command, [&bar](std::uint64_t done, std::uint64_t total) {
      stop_if_interrupted();
      bar.update("measurements", done, total);
    });
  }
  print(scale_text(report));
  if (!json.empty()) write_text(scale_json(report), json);
  return kSuccess;
}

}  // namespace raysheaf::app
