#include <fmt/format.h>

#include "console.h"
#include "outputs.h"
#include "paper/json.h"
#include "paper/page.h"
#include "paper/paper.h"
#include "paper/sheets.h"
#include "progress_bar.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

std::string text_of(const PaperReport& report, bool times) {
  std::string text =
      fmt::format("{} scenes, {}x{} pixels, two levels of branching 8\n",
                  report.builtin ? "the built-in" : "the paper's", report.width, report.height);
  for (const Sheet& sheet : paper_sheets(report, times)) text += "\n" + sheet_text(sheet);
  for (const Sheet& sheet : combination_sheets(report)) text += "\n" + sheet_text(sheet);
  return text;
}

}  // namespace

int run(const BenchPaperCommand& command) {
  catch_interrupts();
  OutputFiles files;
  const std::string json = files.open(command.json_path);
  const std::string markdown = files.open(command.markdown_path);
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
  print(text_of(report, command.times));
  if (!json.empty()) write_text(paper_json(report), json);
  if (!markdown.empty()) write_text(paper_page(report, command.times), markdown);
  return kSuccess;
}

}  // namespace raysheaf::app
