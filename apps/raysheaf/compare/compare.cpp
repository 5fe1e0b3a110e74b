// All scenes, modes and kinds; and the growth.
#include "compare/compare.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "compare/case.h"
#include "compare/frames.h"
#include "compare/scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

std::uint64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::vector<CompareScene> chosen_scenes(const BenchCompareCommand& command,
                                        std::vector<std::string>* notes) {
  if (command.scene_names.empty()) return default_compare_scenes(command.scenes, notes);
  return compare_scenes_from_strings(command.scene_names, command.scenes);
}

/// Counts measurements for the progress bar.
class Progress {
 public:
  Progress(const TellCompare& tell, std::uint64_t total) : tell_(tell), total_(total) {}
  /// Something that is no measurement.
  void prepare(const std::string& what) const { tell_(what, done_, total_); }
  void measure(const std::string& what) { tell_(what, done_++, total_); }
  void leave_out(std::uint64_t count) { done_ += count; }

 private:
  const TellCompare& tell_;
  std::uint64_t done_ = 0, total_;
};

class Session {
 public:
  Session(const BenchCompareCommand& command, const TellCompare& tell)
      : command_(command),
        kinds_(command.kinds.empty() ? all_compare_kinds() : command.kinds),
        modes_(command.modes.empty() ? all_compare_modes() : command.modes),
        setting_{Context({Device::kCpu, command.threads}), nullptr, command.runs},
        device_(setting_.context.threads()),
        tell_(tell) {
    setting_.peer = &device_;
    report_.command = command;
    report_.peer = peer_name();
    report_.threads = setting_.context.threads();
  }

  CompareReport scenes() {
    const std::vector<CompareScene> scenes = chosen_scenes(command_, &report_.notes);
    Progress progress(tell_, scenes.size() * modes_.size() * kinds_.size());
    for (const CompareScene& scene : scenes) {
      progress.prepare("preparing " + scene.name);
      CompareFrames frames(load_compare_scene(scene, report_.threads), moves());
      frames.make_rays(kinds_, command_.width, command_.height, report_.threads);
      for (const CompareMode mode : modes_)
        measure(frames, scene.name, mode, progress, &report_.cases);
    }
    return finished();
  }

  /// Along the triangles at the size of the picture, and along the rays in one hall.
  CompareReport growth() {
    const std::vector<double> triangles = decades(), rays = decades();
    Progress progress(tell_, (triangles.size() + rays.size()) * modes_.size() * kinds_.size());
    for (const double count : triangles)
      grow("triangles", static_cast<std::uint64_t>(count), command_.width, command_.height,
           progress);
    for (const double count : rays) {
      const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(count)));
      grow("rays", std::min(command_.most, kTrianglesForRays), side, side, progress);
    }
    return finished();
  }

 private:
  static constexpr std::uint32_t kTrianglesForRays = 100'000;

  [[nodiscard]] bool moves() const {
    return std::any_of(modes_.begin(), modes_.end(),
                       [](CompareMode mode) { return mode != CompareMode::kStatic; });
  }

  /// Two points a decade from 10 000 on.
  [[nodiscard]] std::vector<double> decades() const {
    std::vector<double> all;
    for (int i = 0;; ++i) {
      const double count = std::round(1e4 * std::pow(10, i / 2.0));
      if (count > command_.most * 1.01) return all;
      all.push_back(count);
    }
  }

  void grow(const std::string& along, std::uint64_t triangles, std::uint32_t width,
            std::uint32_t height, Progress& progress) {
    progress.prepare(fmt::format("preparing a hall of {} triangles", triangles));
    CompareFrames frames(hall_scene(triangles, report_.threads), moves());
    frames.make_rays(kinds_, width, height, report_.threads);
    std::vector<CompareCase> cases;
    for (const CompareMode mode : modes_) measure(frames, "hall", mode, progress, &cases);
    for (CompareCase& c : cases) report_.growth.push_back({along, std::move(c)});
  }

  void measure(const CompareFrames& frames, const std::string& scene, CompareMode mode,
               Progress& progress, std::vector<CompareCase>* cases) {
    progress.prepare(fmt::format("{}, {}: trying the peer's ways", scene, to_string(mode)));
    CompareBench bench(setting_, frames, mode, kinds_);
    for (const CompareKind kind : kinds_) {
      progress.measure(fmt::format("{}, {}, {}", scene, to_string(mode), to_string(kind)));
      if (has_no_rays(frames, kind)) {
        report_.notes.push_back(
            fmt::format("{} has no {} rays at this size", scene, to_string(kind)));
        continue;
      }
      cases->push_back(bench.measure(kind));
      cases->back().scene = scene;
    }
  }

  static bool has_no_rays(const CompareFrames& frames, CompareKind kind) {
    for (std::size_t i = 0; i < frames.frame_count(); ++i)
      if (frames.rays(i, kind).empty()) return true;
    return false;
  }

  CompareReport finished() {
    std::sort(report_.notes.begin(), report_.notes.end());
    report_.notes.erase(std::unique(report_.notes.begin(), report_.notes.end()),
                        report_.notes.end());
    report_.peak_bytes = peak_bytes();
    return std::move(report_);
  }

  const BenchCompareCommand& command_;
  const std::vector<CompareKind> kinds_;
  const std::vector<CompareMode> modes_;
  CompareSetting setting_;
  PeerDevice device_;
  const TellCompare& tell_;
  CompareReport report_;
};

}  // namespace

CompareReport measure_compare(const BenchCompareCommand& command, const TellCompare& tell) {
  Session session(command, tell);
  return command.growth ? session.growth() : session.scenes();
}

}  // namespace raysheaf::app
