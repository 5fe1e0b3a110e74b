#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "apps/support/console.h"
#include "apps/support/exit_code.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "lab/commands/ablation/ablation.h"
#include "lab/commands/compare/scenes.h"
#include "lab/commands/gpu/counts.h"
#include "raysheaf/context.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

struct SceneReport {
  std::string scene;
  DeviceBenchReport report;
};

double grays_per_s(std::uint64_t rays, double ms) {
  return ms > 0 ? static_cast<double>(rays) / ms * 1e-6 : 0;
}

std::string text_of(const std::vector<DeviceStage>& stages) {
  std::string text;
  for (const DeviceStage& stage : stages)
    text += fmt::format("    {:<24} {:>9.4f} ms{}\n", stage.name, stage.ms,
                        stage.floor_ms > 0
                            ? fmt::format(", {:.1f} times its floor of {:.4f} ms ({})",
                                          stage.ms / stage.floor_ms, stage.floor_ms, stage.floor_of)
                            : std::string());
  return text;
}

Json json_of(const std::vector<DeviceStage>& stages) {
  Json all = Json::array();
  for (const DeviceStage& stage : stages)
    all.push_back({{"stage", stage.name},
                   {"ms", stage.ms},
                   {"floor_ms", stage.floor_ms > 0 ? Json(stage.floor_ms) : Json(nullptr)},
                   {"floor_of", stage.floor_of.empty() ? Json(nullptr) : Json(stage.floor_of)}});
  return all;
}

std::string text_of(const SceneReport& scene) {
  const DeviceBenchReport& report = scene.report;
  std::string text = fmt::format(
      "{}: {} triangles on {}; a copy within its memory runs at {:.0f} GB/s, {:.0f} Gops/s; its "
      "kernels {} read pageable memory of the host; the CPU has {} threads\n",
      printable(scene.scene), report.triangles, report.device, report.copy_gb_per_s,
      report.gigaops_per_s, report.reads_host_memory ? "can" : "cannot", report.threads);
  for (const DeviceBenchBatch& batch : report.batches) {
    text += fmt::format(
        "  {}: {} rays, {} hits, {} that differ from the CPU; ms: keys to hits {:.3f} ({:.3f} "
        "Grays/s), sum of its stages {:.3f}, of all stages {:.3f}, call {:.3f}, with other "
        "triangles {:.3f}, CPU {:.3f}; hierarchy refitted in {:.3f} instead of built, with moved "
        "triangles {:.3f}\n",
        to_string(batch.rays), batch.count, batch.hits, batch.different, batch.keys_to_hits_ms,
        grays_per_s(batch.count, batch.keys_to_hits_ms), batch.trace_ms, batch.device_ms,
        batch.call_ms, batch.frame_ms, batch.cpu_ms, batch.refit_ms, batch.refit_frame_ms);
    text += text_of(batch.stages) + "   refitted:\n" + text_of(batch.refit_stages);
  }
  return text;
}

Json json_of(const SceneReport& scene) {
  Json batches = Json::array();
  for (const DeviceBenchBatch& batch : scene.report.batches) {
    batches.push_back({{"rays", to_string(batch.rays)},
                       {"count", batch.count},
                       {"hits", batch.hits},
                       {"different", batch.different},
                       {"keys_to_hits_ms", batch.keys_to_hits_ms},
                       {"device_ms", batch.device_ms},
                       {"trace_ms", batch.trace_ms},
                       {"call_ms", batch.call_ms},
                       {"frame_ms", batch.frame_ms},
                       {"refit_ms", batch.refit_ms},
                       {"refit_frame_ms", batch.refit_frame_ms},
                       {"cpu_ms", batch.cpu_ms},
                       {"grays_per_s", grays_per_s(batch.count, batch.keys_to_hits_ms)},
                       {"stages", json_of(batch.stages)},
                       {"refit_stages", json_of(batch.refit_stages)}});
  }
  return {{"scene", scene.scene},
          {"triangles", scene.report.triangles},
          {"device", scene.report.device},
          {"copy_gb_per_s", scene.report.copy_gb_per_s},
          {"gigaops_per_s", scene.report.gigaops_per_s},
          {"reads_host_memory", scene.report.reads_host_memory},
          {"cpu_threads", scene.report.threads},
          {"batches", batches}};
}

/// Calls `measure(name, description)` for each scene.
template <class Measure>
void for_each_scene(const BenchGpuCommand& command, const Measure& measure) {
  std::vector<std::string> notes;
  const std::vector<CompareScene> scenes =
      chosen_compare_scenes(command.scene_names, command.scenes, &notes);
  for (const std::string& note : notes)
    if (!command.quiet) tell(printable(note));
  ProgressBar bar(stderr, !command.quiet);
  std::size_t done = 0;
  for (const CompareScene& scene : scenes) {
    stop_if_interrupted();
    bar.update(scene.name, done++, scenes.size());
    measure(scene.name, load_compare_scene(scene, command.options.threads));
  }
}

std::vector<SceneReport> measured(const BenchGpuCommand& command) {
  std::vector<SceneReport> reports;
  for_each_scene(command, [&](const std::string& name, const SceneDescription& scene) {
    reports.push_back({name, bench_device(scene, command.options)});
  });
  return reports;
}

std::vector<SceneWalks> counted(const BenchGpuCommand& command) {
  std::vector<SceneWalks> walks;
  for_each_scene(command, [&](const std::string& name, const SceneDescription& scene) {
    walks.push_back({name, count_device_walks(scene, command.options)});
  });
  return walks;
}

void write(const Json& json, const std::string& path) {
  if (!path.empty())
    write_text(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", path);
}

}  // namespace

int run(const BenchGpuCommand& command) {
  std::optional<Context> device;  // without a device this throws one sentence at once
  if (!command.counts) device.emplace(ContextOptions{Device::kCuda, command.options.threads});
  catch_interrupts();
  OutputFiles files;
  for (const std::string& scene : command.scene_names) files.reads(scene);
  const std::string json = files.open(command.json_path);
  if (command.counts) {
    const std::vector<SceneWalks> walks = counted(command);
    print(counts_table(walks));
    write(counts_json(walks), json);
    return kSuccess;
  }
  Json all = Json::array();
  std::uint64_t different = 0;
  for (const SceneReport& scene : measured(command)) {
    print(text_of(scene));
    all.push_back(json_of(scene));
    for (const DeviceBenchBatch& batch : scene.report.batches) different += batch.different;
  }
  write(all, json);
  if (different != 0)
    throw Error(ErrorCode::kInternal,
                std::to_string(different) + " answers of the device differ from those of the CPU",
                "bench gpu");
  return kSuccess;
}

}  // namespace raysheaf::app
