#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "ablation/ablation.h"
#include "ablation/files.h"
#include "ablation/page.h"
#include "ablation/plots.h"
#include "console.h"
#include "outputs.h"
#include "progress_bar.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

/// The path from the page to the plots.
std::string link_to_plots(const BenchAblationCommand& command) {
  if (command.svg_path.empty()) return "";
  const fs::path page = fs::absolute(command.markdown_path).parent_path();
  return fs::absolute(command.svg_path).lexically_relative(page).generic_string();
}

void write_plots(const AblationReport& report) {
  const std::string& path = report.command.svg_path;
  for (const std::string& scene : report.scenes) {
    write_text(ablation_tests_svg(report, scene), writable_path(plot_path(path, scene, "tests")));
    write_text(ablation_time_svg(report, scene), writable_path(plot_path(path, scene, "time")));
  }
}

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
  const std::string page = files.open(command.markdown_path);
  if (!command.svg_path.empty()) (void)writable_path(command.svg_path);
  const AblationReport report = measured(command);
  print(ablation_text(report));
  if (!json.empty()) write_text(ablation_json(report), json);
  if (!csv.empty()) write_text(ablation_csv(report), csv);
  if (!command.svg_path.empty()) write_plots(report);
  if (!page.empty()) write_text(ablation_page(report, link_to_plots(command)), page);
  return kSuccess;
}

}  // namespace raysheaf::app
