#include "console.h"
#include "outputs.h"
#include "progress_bar.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "scale/report.h"

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
