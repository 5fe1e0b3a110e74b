#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/paper/paper.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
int run(const BenchPaperCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string json = files.open(command.json_path);
  if (command.scenes.empty() && !command.quiet)
    tell("without --scenes the built-in scenes are measured, for which no figures were published");
  PaperReport report;
  {
    ProgressBar bar(stderr, !command.quiet);
    report = measure_paper(command, [&bar](std::uint64_t done, std::uint64_t total) {
      stop_if_interrupted();
      bar.update("measurements", done, total);
    });
  }
  print(paper_text(report));
  if (!json.empty()) write_text(paper_json(report), json);
  return kSuccess;
}

}  // namespace raysheaf::app
