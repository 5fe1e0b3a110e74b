#include <filesystem>

#include "compare/compare.h"
#include "compare/files.h"
#include "compare/page.h"
#include "compare/plots.h"
#include "console.h"
#include "outputs.h"
#include "progress_bar.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

/// The path from the page to the plot.
std::string link_to_plot(const BenchCompareCommand& command) {
  if (command.plot_path.empty()) return "";
  const fs::path page = fs::absolute(command.markdown_path).parent_path();
  return fs::absolute(command.plot_path).lexically_relative(page).generic_string();
}

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
  const std::string json = files.open(command.json_path), page = files.open(command.markdown_path);
  const std::string plot = files.open(command.plot_path);
  const CompareReport report = measured(command);
  print(compare_text(report));
  if (!json.empty()) write_text(compare_json(report), json);
  if (!plot.empty()) write_text(command.growth ? growth_svg(report) : compare_svg(report), plot);
  if (!page.empty()) write_text(compare_page(report, link_to_plot(command)), page);
  return kSuccess;
}

}  // namespace raysheaf::app
