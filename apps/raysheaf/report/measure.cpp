#include "report/measure.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "raysheaf/error.h"

namespace raysheaf::app {
namespace {

constexpr Method kAllMethods[] = {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10,
                                  Method::kDual};

bool asked_for(const ReportCommand& command, Method method) {
  return command.methods.empty() ||
         std::find(command.methods.begin(), command.methods.end(), method) != command.methods.end();
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

std::uint64_t brute_force_tests(const FrameStatistics& statistics) {
  std::uint64_t all = 0;
  for (const BatchStatistics& batch : statistics.batches) all += batch.brute_force_tests();
  return all;
}

/// The counts that brute force would have: its rays are those of any other method.
MethodReport counted_without_running(const FrameStatistics& other) {
  MethodReport report;
  report.method = Method::kBrute;
  report.ran = false;
  report.counted = other;
  report.counted.method = to_string(Method::kBrute);
  report.counted.key = to_string(method_settings(Method::kBrute).key);
  report.counted.bound = "none";
  report.counted.raster_ms = report.counted.shade_ms = report.counted.total_ms = 0;
  for (BatchStatistics& batch : report.counted.batches) {
    BatchStatistics plain;
    plain.kind = batch.kind;
    plain.bounce = batch.bounce;
    plain.rays = batch.rays;
    plain.triangles = batch.triangles;
    plain.final_tests = batch.brute_force_tests();
    plain.hits = batch.hits;
    batch = plain;
  }
  report.times = report.counted;
  return report;
}

class Runs {
 public:
  Runs(const SceneDescription& scene, const ReportCommand& command,
       const std::function<bool(const Progress&)>& progress)
      : scene_(scene), command_(command), progress_(progress) {}

  Report run() {
    report_.branching = command_.options.branching;
    // Brute force runs last: by then the number of its tests is known.
    for (const Method method : kAllMethods)
      if (method != Method::kBrute && asked_for(command_, method)) add(method);
    if (asked_for(command_, Method::kBrute)) add_brute();
    return std::move(report_);
  }

 private:
  void add_brute() {
    const bool by_name = !command_.methods.empty();
    if (!by_name && brute_force_tests(report_.methods.front().counted) > kMostBruteForceTests) {
      report_.methods.insert(report_.methods.begin(),
                             counted_without_running(report_.methods.front().counted));
      return;
    }
    add(Method::kBrute);
    std::rotate(report_.methods.begin(), report_.methods.end() - 1, report_.methods.end());
  }

  void add(Method method) {
    MethodReport one;
    one.method = method;
    RenderResult result = rendered(method, true, "counting");
    one.counted = result.statistics;
    // Counting costs brute force nothing, and it is slow enough to run only once.
    one.times =
        method == Method::kBrute ? one.counted : rendered(method, false, "timing").statistics;
    one.tests = std::move(result.tests);
    if (report_.picture.beauty.empty()) {
      report_.picture = std::move(result);
    } else if (!same_bits(result.beauty, report_.picture.beauty)) {
      throw Error(ErrorCode::kInternal, "the image differs from that of another method",
                  to_string(method));
    }
    report_.methods.push_back(std::move(one));
  }

  RenderResult rendered(Method method, bool counts, const std::string& what) {
    RenderOptions options = command_.options;
    options.samples = 1;
    options.method = method;
    options.count_pixel_tests = counts;
    options.bundle_samples = counts ? kBundleSamples : 0;
    const std::string before = std::string(to_string(method)) + ", " + what + ": ";
    options.progress = [&](const Progress& p) {
      return progress_({before + std::string(p.stage), p.done, p.total});
    };
    return render(scene_, options);
  }

  const SceneDescription& scene_;
  const ReportCommand& command_;
  const std::function<bool(const Progress&)>& progress_;
  Report report_;
};

}  // namespace

Report measure(const SceneDescription& scene, const ReportCommand& command,
               const std::function<bool(const Progress&)>& progress) {
  return Runs(scene, command, progress).run();
}

}  // namespace raysheaf::app
