#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/compare/compare.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

CompareReport measured(const BenchCompareCommand& command) {
  ProgressBar bar(stderr, !command.quiet);
  return measure_compare(command,
                         [&bar](const std::string& what, std::uint64_t done, std::uint64_t total) {
                           stop_if_interrupted();
                           bar.update(what, done, total);
                         });
}

}  // namespace

int run(const BenchCompareCommand& command) {
  catch_interrupts();
  OutputFiles files;
  for (const std::string& scene : command.scene_names) files.reads(scene);
  const std::string csv = files.open(command.csv_path);
  const CompareReport report = measured(command);
  print(compare_text(report));
  if (!csv.empty()) write_text(compare_csv(report), csv);
  return kSuccess;
}

}  // namespace raysheaf::app
