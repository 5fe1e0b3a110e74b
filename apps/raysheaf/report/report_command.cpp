#include <fmt/format.h>

#include <chrono>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "apps/support/scene_argument.h"
#include "raysheaf/error.h"
#include "render/viewpoint.h"
#include "report/page.h"

namespace raysheaf::app {
namespace {

Report measured_with_progress(const SceneDescription& scene, const ReportCommand& command) {
  ProgressBar bar(stderr, !command.quiet);
  return measure(scene, command, [&bar](const Progress& progress) {
    bar.update(progress.stage, progress.done, progress.total);
    return !interrupted();
  });
}

}  // namespace

int run(const ReportCommand& given) {
  ReportCommand command = given;
  catch_interrupts();
  const std::string target = writable_path(command.output);
  const auto start = std::chrono::steady_clock::now();
  SceneDescription scene = scene_from_argument(command.scene, command.load);
  if (command.options.camera.empty() && !scene.cameras.empty() &&
      !shows(scene.cameras.front(), scene))
    replace_first_camera(framing_camera(scene), &scene, &command.options);
  add_missing_camera_and_light(scene);
  const std::chrono::duration<double, std::milli> load = std::chrono::steady_clock::now() - start;
  stop_if_interrupted();
  if (!command.quiet) {
    tell_warnings(scene.warnings);
  }
  Report report = measured_with_progress(scene, command);
  report.load_ms = load.count();
  const std::string html = to_html(make_page(command, scene, report));
  stop_if_interrupted();
  write_text(html, target);
  if (!command.quiet)
    tell(fmt::format("wrote {} ({:.1f} MB)", printable(command.output),
                     static_cast<double>(html.size()) * 1e-6));
  return kSuccess;
}

}  // namespace raysheaf::app
