// Measures all scenes, modes and kinds, and the growth.
#include "lab/commands/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/commands/compare/case.h"
#include "lab/commands/compare/frames.h"
#include "lab/commands/compare/scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "system/process.h"

namespace raysheaf::app {
namespace {

/// Counts measurements for the progress bar.
class Progress {
 public:
  Progress(const Tell& tell, std::uint64_t total) : tell_(tell), total_(total) {}
  /// Reports work that is not a measurement.
  void prepare(const std::string& what) const { tell_(what, done_, total_); }
  void measure(const std::string& what) { tell_(what, done_++, total_); }

 private:
  const Tell& tell_;
  std::uint64_t done_ = 0, total_;
};

class Session {
 public:
  Session(const BenchCompareCommand& command, const Tell& tell)
      : command_(command),
        kinds_(command.kinds.empty() ? all_compare_kinds() : command.kinds),
        modes_(command.modes.empty() ? all_compare_modes() : command.modes),
        sizes_(command.sizes.empty() ? std::vector<ImageSize>{{512, 512}} : command.sizes),
        setting_{Context({Device::kCpu, command.threads}), {}, command.runs},
        peers_(open_peers(setting_.context.threads())),
        tell_(tell) {
    for (const std::unique_ptr<PeerDevice>& peer : peers_) {
      setting_.peers.push_back(peer.get());
      report_.peer += (report_.peer.empty() ? "Embree " : " and Embree ") + peer->version();
    }
    report_.command = command;
    report_.threads = setting_.context.threads();
  }

  CompareReport scenes() {
    const std::vector<CompareScene> scenes =
        chosen_compare_scenes(command_.scene_names, command_.scenes, &report_.notes);
    Progress progress(tell_, scenes.size() * sizes_.size() * modes_.size() * kinds_.size());
    for (const CompareScene& scene : scenes) {
      progress.prepare("preparing " + scene.name);
      CompareFrames frames(load_compare_scene(scene, report_.threads), moves());
      for (const ImageSize& size : sizes_) {
        frames.make_rays(kinds_, size.first, size.second, report_.threads);
        if (command_.ground > 0) frames.set_ground(command_.ground);
        for (const CompareMode mode : modes_)
          measure(frames, scene.name, size, mode, progress, &report_.cases);
      }
    }
    return finished();
  }

  /// Measures growing numbers of triangles at the given image size, and growing numbers of rays in
  /// one hall.
  CompareReport growth() {
    const std::vector<double> triangles = decades(), rays = decades();
    Progress progress(tell_, (triangles.size() + rays.size()) * modes_.size() * kinds_.size());
    for (const double count : triangles)
      grow("triangles", static_cast<std::uint64_t>(count), sizes_.front(), progress);
    for (const double count : rays) {
      const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(count)));
      grow("rays", std::min(command_.most, kTrianglesForRays), {side, side}, progress);
    }
    return finished();
  }

 private:
  static constexpr std::uint32_t kTrianglesForRays = 100'000;

  [[nodiscard]] bool moves() const {
    return std::any_of(modes_.begin(), modes_.end(),
                       [](CompareMode mode) { return mode != CompareMode::kStatic; });
  }

  /// Two points per decade from 10 000 on.
  [[nodiscard]] std::vector<double> decades() const {
    std::vector<double> all;
    for (int i = 0;; ++i) {
      const double count = std::round(1e4 * std::pow(10, i / 2.0));
      if (count > command_.most * 1.01) return all;
      all.push_back(count);
    }
  }

  void grow(const std::string& along, std::uint64_t triangles, const ImageSize& size,
            Progress& progress) {
    progress.prepare(fmt::format("preparing a hall of {} triangles", triangles));
    CompareFrames frames(hall_scene(triangles, report_.threads), moves());
    frames.make_rays(kinds_, size.first, size.second, report_.threads);
    std::vector<CompareCase> cases;
    for (const CompareMode mode : modes_) measure(frames, "hall", size, mode, progress, &cases);
    for (CompareCase& c : cases) report_.growth.push_back({along, std::move(c)});
  }

  void measure(const CompareFrames& frames, const std::string& scene, const ImageSize& size,
               CompareMode mode, Progress& progress, std::vector<CompareCase>* cases) {
    CompareCase named;
    named.scene = scene;
    named.size = size;
    named.one_of_sizes = sizes_.size() > 1;
    const std::string label = label_of(named);
    progress.prepare(fmt::format("{}, {}: trying the ways of the peers", label, to_string(mode)));
    CompareBench bench(setting_, frames, mode, kinds_);
    for (const CompareKind kind : kinds_) {
      progress.measure(fmt::format("{}, {}, {}", label, to_string(mode), to_string(kind)));
      if (has_no_rays(frames, kind)) {
        report_.notes.push_back(
            fmt::format("{} has no {} rays at this size", label, to_string(kind)));
        continue;
      }
      cases->push_back(bench.measure(kind));
      cases->back().scene = scene;
      cases->back().size = size;
      cases->back().one_of_sizes = named.one_of_sizes;
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
    report_.peak_bytes = system::peak_memory_bytes();
    return std::move(report_);
  }

  const BenchCompareCommand& command_;
  const std::vector<CompareKind> kinds_;
  const std::vector<CompareMode> modes_;
  const std::vector<ImageSize> sizes_;
  CompareSetting setting_;
  std::vector<std::unique_ptr<PeerDevice>> peers_;
  const Tell& tell_;
  CompareReport report_;
};

}  // namespace

CompareReport measure_compare(const BenchCompareCommand& command, const Tell& tell) {
  Session session(command, tell);
  return command.growth ? session.growth() : session.scenes();
}

}  // namespace raysheaf::app
