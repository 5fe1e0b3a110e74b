// The commands of `raysheaf bench` that measure with a progress bar, print a table and write files.
#include <fmt/format.h>

#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/ablation/ablation.h"
#include "lab/commands/compare/compare.h"
#include "lab/commands/instances/instances.h"
#include "lab/commands/paper/paper.h"
#include "lab/commands/plan/plan.h"
#include "lab/commands/scale/report.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

/// The report that `measure` makes of `command`. The user can interrupt it.
template <class Report, class Command>
Report with_bar(const Command& command, Report (*measure)(const Command&, const Tell&)) {
  ProgressBar bar(stderr, !command.quiet);
  return measure(command, [&bar](const std::string& what, std::uint64_t done, std::uint64_t total) {
    stop_if_interrupted();
    bar.update(what, done, total);
  });
}

void write_if_asked(const std::string& text, const std::string& path) {
  if (!path.empty()) write_text(text, path);
}

}  // namespace

int run(const BenchAblationCommand& command) {
  catch_interrupts();
  OutputFiles files;
  files.reads_scene(command.scene);
  const std::string json = files.open(command.json_path), csv = files.open(command.csv_path);
  const AblationReport report = with_bar(command, measure_ablation);
  print(ablation_text(report));
  write_if_asked(ablation_json(report), json);
  write_if_asked(ablation_csv(report), csv);
  return kSuccess;
}

int run(const BenchCompareCommand& command) {
  catch_interrupts();
  OutputFiles files;
  for (const std::string& scene : command.scene_names) files.reads(scene);
  const std::string csv = files.open(command.csv_path);
  const CompareReport report = with_bar(command, measure_compare);
  print(compare_text(report));
  write_if_asked(compare_csv(report), csv);
  return kSuccess;
}

int run(const BenchInstancesCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string csv = files.open(command.csv_path);
  const InstancesReport report = with_bar(command, measure_instances);
  print(instances_text(report));
  write_if_asked(instances_csv(report), csv);
  return kSuccess;
}

int run(const BenchPaperCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string json = files.open(command.json_path);
  if (command.scenes.empty() && !command.quiet)
    tell("without --scenes the built-in scenes are measured, for which no figures were published");
  const PaperReport report = with_bar(command, measure_paper);
  print(paper_text(report));
  write_if_asked(paper_json(report), json);
  return kSuccess;
}

int run(const BenchPlanCommand& command) {
  catch_interrupts();
  OutputFiles files;
  for (const std::string& scene : command.scene_names) files.reads(scene);
  const std::string json = files.open(command.json_path);
  const PlanReport report = with_bar(command, measure_plans);
  print(plan_text(report));
  write_if_asked(plan_json(report), json);
  if (!command.check || report.losing() == 0) return kSuccess;
  throw Error(ErrorCode::kInternal,
              fmt::format("{} of {} plans are more than {:.0f} % slower than the best choice",
                          report.losing(), report.cases.size(), 100 * (kMostPlanLoss - 1)),
              "plan");
}

int run(const BenchScaleCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string json = files.open(command.json_path);
  const ScaleReport report = with_bar(command, measure_scale);
  print(scale_text(report));
  write_if_asked(scale_json(report), json);
  return kSuccess;
}

}  // namespace raysheaf::app
