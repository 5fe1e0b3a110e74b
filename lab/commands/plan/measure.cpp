#include "lab/commands/compare/frames.h"
#include "lab/commands/compare/scenes.h"
#include "lab/commands/plan/plan.h"
#include "raysheaf/context.h"

namespace raysheaf::app {
namespace {

PlanMode mode_of(CompareMode mode) {
  switch (mode) {
    case CompareMode::kRebuild:
      return PlanMode::kRebuild;
    case CompareMode::kRefit:
      return PlanMode::kRefit;
    case CompareMode::kStatic:
      break;
  }
  return PlanMode::kStatic;
}

std::vector<PlanFrame> frames_of(const CompareFrames& frames, CompareKind kind, CompareMode mode) {
  std::vector<PlanFrame> all;
  for (std::size_t frame = 0; frame < frames.frame_count(); ++frame) {
    PlanFrame& made = all.emplace_back();
    made.rays = frames.rays(frame, kind);
    for (const MeshView& mesh : frames.meshes(frame, mode == CompareMode::kRefit))
      made.meshes.push_back({mesh.positions, mesh.triangles});
  }
  return all;
}

}  // namespace

PlanReport measure_plans(const BenchPlanCommand& command, const Tell& tell) {
  PlanReport report;
  report.command = command;
  report.threads = Context({Device::kCpu, command.threads}).threads();
  const std::vector<CompareScene> scenes =
      chosen_compare_scenes(command.scene_names, command.scenes, &report.notes);
  const auto kinds = command.kinds.empty() ? all_compare_kinds() : command.kinds;
  const auto modes = command.modes.empty() ? all_compare_modes() : command.modes;
  const std::uint64_t total = scenes.size() * kinds.size() * modes.size();
  std::uint64_t done = 0;
  for (const CompareScene& scene : scenes) {
    tell("preparing " + scene.name, done, total);
    CompareFrames frames(load_compare_scene(scene, report.threads), true);
    frames.make_rays(kinds, command.width, command.height, report.threads);
    for (const CompareMode mode : modes) {
      for (const CompareKind kind : kinds) {
        const std::string name = scene.name + ", " + to_string(mode) + ", " + to_string(kind);
        tell(name, done++, total);
        if (frames.rays(0, kind).empty()) {
          report.notes.push_back(scene.name + " has no " + to_string(kind) + " rays at this size");
          continue;
        }
        report.cases.push_back({scene.name, kind, mode, frames.triangle_count(),
                                frames.rays(0, kind).size(),
                                try_plans(frames_of(frames, kind, mode), mode_of(mode),
                                          asks_for_any_hit(kind), report.threads, command.runs)});
      }
    }
  }
  return report;
}

}  // namespace raysheaf::app
