// Measures the cross product of all settings.
#include "lab/commands/ablation/ablation.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "apps/support/median.h"
#include "apps/support/scene_argument.h"
#include "apps/support/values.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

struct Source {
  std::string name, argument;
};

/// Figures are found by the scene's name, so bunny.obj and bunny.ply must count as two scenes.
void name_apart(std::vector<Source>& all) {
  std::set<std::string> names;
  for (const Source& source : all) names.insert(source.name);
  if (names.size() == all.size()) return;
  for (Source& source : all) source.name = fs::path(source.argument).filename().string();
}

std::vector<Source> sources_in(const std::string& folder) {
  std::error_code failed, ignored;
  std::vector<Source> all;
  for (fs::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed)) {
    if (i->is_directory(ignored)) continue;
    const std::string path = i->path().string();
    for (const std::string_view ending : scene_file_endings())
      if (has_ending(path, ending)) all.push_back({i->path().stem().string(), path});
  }
  if (failed) throw Error(ErrorCode::kIo, "cannot read this folder: " + failed.message(), folder);
  if (all.empty()) throw Error(ErrorCode::kIo, "this folder contains no scene", folder);
  std::sort(all.begin(), all.end(),
            [](const Source& a, const Source& b) { return a.argument < b.argument; });
  name_apart(all);
  return all;
}

std::vector<Source> sources(const BenchAblationCommand& command) {
  if (!command.scenes.empty()) return sources_in(command.scenes);
  const std::string builtin = "builtin:";
  if (command.scene.starts_with(builtin))
    return {{command.scene.substr(builtin.size()), command.scene}};
  if (!command.scene.empty()) return {{fs::path(command.scene).stem().string(), command.scene}};
  std::vector<Source> all;
  for (const std::string& name : builtin_scene_names()) all.push_back({name, builtin + name});
  return all;
}

/// Keys, then bounds, change fastest: measurements that are compared most are close together in
/// time.
std::vector<MethodSettings> combinations(const BenchAblationCommand& c) {
  std::vector<MethodSettings> all;
  MethodSettings s = method_settings(Method::kCrsh);
  for (const bool culling : c.mesh_culling) {
    for (const std::uint32_t levels : c.levels) {
      for (const std::uint32_t branching : c.branching) {
        for (const RayKey key : c.keys) {
          for (const std::uint32_t bits : c.key_bits) {
            if (!comes_in_both_widths(key) && bits != c.key_bits.front()) continue;
            for (const BundleBound bound : c.bounds) {
              s.mesh_culling = culling;
              s.levels = levels;
              s.branching = branching;
              s.key = key;
              s.key_bits = bits;
              s.bound = bound;
              all.push_back(s);
            }
          }
        }
      }
    }
  }
  return all;
}

StageTimes medians(const std::vector<StageTimes>& all) {
  StageTimes result;
  for (double StageTimes::*stage : {&StageTimes::raygen, &StageTimes::order, &StageTimes::hierarchy,
                                    &StageTimes::traverse, &StageTimes::intersect}) {
    std::vector<double> values;
    for (const StageTimes& times : all) values.push_back(times.*stage);
    result.*stage = median(std::move(values));
  }
  return result;
}

BatchStatistics measured(Laboratory& laboratory, LabRays rays, const MethodSettings& settings,
                         const BenchAblationCommand& command) {
  BatchStatistics counts;
  std::vector<StageTimes> times;
  for (std::uint32_t i = 0; i < command.repeat; ++i) {
    counts = laboratory.measure(rays, settings, command.check && i == 0);
    times.push_back(counts.times_ms);
  }
  counts.times_ms = medians(times);
  return counts;
}

template <typename Figure>
const AblationRow* least(const AblationReport& report, const std::string& scene, LabRays rays,
                         Figure figure) {
  const AblationRow* best = nullptr;
  for (const AblationRow& row : report.rows)
    if (row.is_of(scene, rays) && (best == nullptr || figure(row) < figure(*best))) best = &row;
  return best;
}

}  // namespace

AblationReport measure_ablation(const BenchAblationCommand& command, const Tell& tell) {
  AblationReport report;
  report.command = command;
  const std::vector<Source> scenes = sources(command);
  const std::vector<MethodSettings> settings = combinations(command);
  const std::uint64_t total = scenes.size() * command.rays.size() * settings.size();
  std::uint64_t done = 0;
  for (const Source& source : scenes) {
    tell("measurements", done, total);
    Laboratory laboratory(scene_from_argument(source.argument), command.width, command.height,
                          command.threads);
    report.scenes.push_back(source.name);
    for (const LabRays rays : command.rays) {
      const bool any = laboratory.ray_count(rays) > 0;
      for (const MethodSettings& s : settings) {
        tell("measurements", done++, total);
        if (any)
          report.rows.push_back({source.name, rays, s, measured(laboratory, rays, s, command)});
      }
    }
  }
  return report;
}

double AblationRow::trace_ms() const {
  return counts.times_ms.traverse + counts.times_ms.intersect;
}

double AblationRow::total_ms() const {
  return counts.times_ms.order + counts.times_ms.hierarchy + trace_ms();
}

const AblationRow* fewest_tests(const AblationReport& report, const std::string& scene,
                                LabRays rays) {
  return least(report, scene, rays,
               [](const AblationRow& row) { return row.counts.total_tests(); });
}

const AblationRow* least_time(const AblationReport& report, const std::string& scene,
                              LabRays rays) {
  return least(report, scene, rays, [](const AblationRow& row) { return row.total_ms(); });
}

}  // namespace raysheaf::app
