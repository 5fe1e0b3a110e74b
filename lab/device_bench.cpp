#include "lab/device_bench.h"
#include "backends/cuda.h"
#include "device/device_queries.h"
#include "queries/planned_queries.h"

#include <algorithm>
#include <cstring>

#include "exec/stopwatch.h"
#include "raysheaf/error.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

/// The bytes that a stage must at least read and write for each of its items.
struct Traffic {
  const char* stage;
  double bytes;
  bool of_rays;  ///< false: of triangles
};
constexpr Traffic kTraffic[] = {
    {"hierarchy: bounds", 36, false},    // reads three corners
    {"hierarchy: keys", 36 + 8, false},  // reads corners; writes a key
    {"hierarchy: sort", 8 + 8, false},   // keys, once
    {"hierarchy: triangles", 8 + 36 + 48, false},
    {"hierarchy: refit", 4 + 36 + 48, false},          // reads a number and its corners; writes the
                                                       // triangle
    {"hierarchy: nodes", 8 + 48 + 64 + 8, false},      // reads a key and a triangle; writes a node
                                                       // and two parents
    {"hierarchy: boxes", 48 + 48, false},              // reads a triangle; writes two boxes
    {"order: keys", 32 + 8, true},                     // reads a ray; writes a key and a number
    {"order: sort", 8 + 8, true},                      // pairs, once
    {"trace: any hits", 4 + 32 + 1, true},             // reads a number and a ray; writes a flag
    {"trace: closest hits", 4 + 32 + 4, true},         // reads a number and a ray; writes a place
    {"trace: values", 16 + 32 + 48 + 16, true},        // reads places, a ray and a triangle; writes
                                                       // a hit
    {"trace: candidates", 1 + 32 + 48 + 8 + 1, true},  // reads a flag, a ray, a triangle and places
};

/// The minimum operations of a test: of a ray with a box (`enters`) six differences, six products,
/// thirteen minima, maxima and comparisons; of a ray with a triangle that it misses, nine
/// differences, the shear's six products and six differences, three edge functions of three each,
/// and the comparison of their signs.
constexpr double kBoxOperations = 25, kTriangleOperations = 36;

/// The work of one batch.
struct Work {
  double rays, triangles;
  double operations = 0;  ///< of tracing
};

DeviceStage stage_of(const std::string& name, double ms, const Work& work,
                     const DeviceSpeed& rates) {
  DeviceStage stage{name, ms, 0, ""};
  for (const Traffic& traffic : kTraffic) {
    if (name != traffic.stage) continue;
    const double items = traffic.of_rays ? work.rays : work.triangles;
    stage.floor_ms = traffic.bytes * items / rates.bytes_per_ms;
    stage.floor_of = "bytes";
  }
  const double arithmetic =
      name == "trace: any hits" || name == "trace: closest hits" ? work.operations : 0;
  if (arithmetic / rates.operations_per_ms > stage.floor_ms) {
    stage.floor_ms = arithmetic / rates.operations_per_ms;
    stage.floor_of = "operations";
  }
  return stage;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_copy(const std::string& stage) {
  return stage.starts_with("copy:");
}

bool is_of_hierarchy(const std::string& stage) {
  return stage.starts_with("hierarchy:");
}

/// Times of the stages over several runs.
class StageTable {
 public:
  void add(const StageTime& time) {
    const auto at = std::find(names_.begin(), names_.end(), time.stage);
    const auto place = static_cast<std::size_t>(at - names_.begin());
    if (at == names_.end()) names_.push_back(time.stage), ms_.emplace_back();
    ms_[place].push_back(time.ms);
  }
  [[nodiscard]] std::vector<DeviceStage> medians(const Work& work, const DeviceSpeed& rates) const {
    std::vector<DeviceStage> stages;
    for (std::size_t s = 0; s < names_.size(); ++s)
      stages.push_back(stage_of(names_[s], median(ms_[s]), work, rates));
    return stages;
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> ms_;
};

/// One scene's triangles, for the CPU's engine and the device's.
class Bench {
 public:
  Bench(const DeviceBackend& backend, const SceneDescription& scene,
        const DeviceBenchOptions& options)
      : options_(options),
        executor_(options.threads),
        flat_(flatten(executor_, scene, mesh_bounds(executor_, scene))),
        there_(backend.make_queries()),
        rates_(backend.speed()) {
    source_ = flat_.source();
    source_.flags = nullptr;
  }

  [[nodiscard]] std::uint32_t threads() const { return executor_.threads(); }
  [[nodiscard]] std::uint32_t triangles() const { return flat_.triangle_count; }
  [[nodiscard]] const DeviceSpeed& rates() const { return rates_; }

  DeviceBenchBatch measure(LabRays kind, const std::vector<Ray>& rays) {
    DeviceBenchBatch batch;
    batch.rays = kind;
    batch.count = rays.size();
    if (rays.empty()) return batch;
    const bool any = kind == LabRays::kShadow;
    Answers here(rays.size()), there(rays.size()), refitted(rays.size());
    Times times, warming;
    Work work{static_cast<double>(rays.size()), static_cast<double>(triangles())};
    for (std::uint32_t run = 0; run <= options_.runs; ++run) {
      // The first run creates what is created once, loads kernels, and counts tests.
      const bool warms = run == 0;
      Times& into = warms ? warming : times;
      QueryReport report;
      into.cpu_ms.push_back(time_here(rays, any, &here));
      time_stages(rays, any, warms, &report, &there, &into);
      into.keys_to_hits_ms.push_back(there_->keys_to_hits_ms(rays, query_of(any), any));
      time_call(rays, any, &there, &into);
      time_refit(rays, any, &refitted, &into);
      if (warms)
        work.operations = kBoxOperations * static_cast<double>(report.ray_bound_tests) +
                          kTriangleOperations * static_cast<double>(report.triangle_tests);
    }
    batch.stages = times.stages.medians(work, rates_);
    batch.refit_stages = times.refit_stages.medians(work, rates_);
    batch.cpu_ms = median(times.cpu_ms);
    batch.call_ms = median(times.call_ms);
    batch.frame_ms = median(times.frame_ms);
    batch.device_ms = median(times.device_ms);
    batch.trace_ms = median(times.trace_ms);
    batch.keys_to_hits_ms = median(times.keys_to_hits_ms);
    batch.refit_ms = median(times.refit_ms);
    batch.refit_frame_ms = median(times.refit_frame_ms);
    for (std::size_t i = 0; i < rays.size(); ++i)
      batch.hits += any ? there.any[i] : there.closest[i].triangle != kInvalidId ? 1u : 0u;
    batch.different = differences(here, there, any) + differences(here, refitted, any);
    return batch;
  }

 private:
  struct Answers {
    explicit Answers(std::size_t count) : closest(count), any(count) {}
    std::vector<IndexedHit> closest;
    std::vector<std::uint8_t> any;
  };

  [[nodiscard]] static std::uint64_t differences(const Answers& a, const Answers& b, bool any) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < a.any.size(); ++i)
      count += any ? a.any[i] != b.any[i]
                   : std::memcmp(&a.closest[i], &b.closest[i], sizeof(IndexedHit)) != 0;
    return count;
  }

  /// Times of a batch's runs.
  struct Times {
    StageTable stages, refit_stages;
    std::vector<double> cpu_ms, call_ms, frame_ms, device_ms, trace_ms, keys_to_hits_ms, refit_ms,
        refit_frame_ms;
  };

  [[nodiscard]] double time_here(const std::vector<Ray>& rays, bool any, Answers* answers) {
    Stopwatch watch;
    here_.set_triangles(source_, false);
    ask_here(rays, any, answers);
    return watch.lap_ms();
  }
  /// Changes the triangles, and makes a call whose stages are timed, which slows it down.
  void time_stages(const std::vector<Ray>& rays, bool any, bool counts, QueryReport* report,
                   Answers* answers, Times* times) {
    there_->set_triangles(executor_, source_, false);
    ask_there(rays, any, counts, report, answers);
    double all = 0, without_tree = 0;
    for (const StageTime& time : there_->stage_times()) {
      times->stages.add(time);
      if (is_copy(time.stage)) continue;
      all += time.ms;
      if (!is_of_hierarchy(time.stage)) without_tree += time.ms;
    }
    times->device_ms.push_back(all);
    times->trace_ms.push_back(without_tree);
  }
  /// Changes the triangles, and makes an ordinary call.
  void time_call(const std::vector<Ray>& rays, bool any, Answers* answers, Times* times) {
    Stopwatch watch;
    there_->set_triangles(executor_, source_, false);
    const double moving = watch.lap_ms();
    ask_there(rays, any, false, nullptr, answers);
    const double call = watch.lap_ms();
    times->call_ms.push_back(call);
    times->frame_ms.push_back(moving + call);
  }
  /// Moves the same triangles twice, for an ordinary call and for one with timed stages.
  void time_refit(const std::vector<Ray>& rays, bool any, Answers* answers, Times* times) {
    Stopwatch watch;
    there_->set_triangles(executor_, source_, true);
    ask_there(rays, any, false, nullptr, answers);
    times->refit_frame_ms.push_back(watch.lap_ms());
    there_->set_triangles(executor_, source_, true);
    QueryReport report;
    ask_there(rays, any, false, &report, answers);
    double refit = 0;
    for (const StageTime& time : there_->stage_times()) {
      if (!is_of_hierarchy(time.stage)) continue;
      times->refit_stages.add(time);
      refit += time.ms;
    }
    times->refit_ms.push_back(refit);
  }

  void ask_here(const std::vector<Ray>& rays, bool any, Answers* answers) {
    if (any) {
      here_.any_hit(executor_, RaysInPlace(rays), {}, answers->any, nullptr);
    } else {
      here_.closest_hit(
          executor_, RaysInPlace(rays), {},
          [&](std::size_t begin, View<const IndexedHit> found) {
            std::copy(found.begin(), found.end(),
                      answers->closest.begin() + static_cast<std::ptrdiff_t>(begin));
          },
          nullptr);
    }
  }
  /// Shadow rays are in the order of pixels, one light after the other.
  [[nodiscard]] static DeviceQuery query_of(bool shadow) {
    DeviceQuery query;
    query.in_order = shadow;
    return query;
  }
  void ask_there(const std::vector<Ray>& rays, bool any, bool counts, QueryReport* report,
                 Answers* answers) {
    DeviceQuery query = query_of(any);
    query.count = counts;
    query.report = report;
    query.executor = &executor_;
    if (any) {
      there_->any_hit(rays, query, View<std::uint8_t>(answers->any));
    } else {
      there_->closest_hit(rays, query, View<IndexedHit>(answers->closest));
    }
  }

  const DeviceBenchOptions options_;
  const Executor executor_;
  const FlatScene flat_;
  std::vector<Vec3> corners_;
  TriangleRun run_;
  TriangleSource source_;
  PlannedQueries here_;
  const std::unique_ptr<DeviceQueries> there_;
  const DeviceSpeed rates_;
};

}  // namespace

std::vector<LabRays> kinds_of_rays(const DeviceBenchOptions& options) {
  if (!options.rays.empty()) return options.rays;
  return {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
          LabRays::kAmbientOcclusion};
}

DeviceBenchReport bench_device_on(const DeviceBackend& backend, const SceneDescription& scene,
                                  const DeviceBenchOptions& options) {
  if (options.runs < 1) throw Error(ErrorCode::kInvalidArgument, "must be at least 1", "runs");
  Laboratory laboratory(scene, options.width, options.height, options.threads);
  Bench bench(backend, scene, options);
  DeviceBenchReport report;
  report.device = backend.name();
  report.threads = bench.threads();
  report.triangles = bench.triangles();
  report.copy_gb_per_s = bench.rates().bytes_per_ms * 1e-6;
  report.gigaops_per_s = bench.rates().operations_per_ms * 1e-6;
  report.reads_host_memory = backend.reads_host_memory();
  for (const LabRays kind : kinds_of_rays(options))
    report.batches.push_back(bench.measure(kind, laboratory.rays(kind)));
  return report;
}

DeviceBenchReport bench_device(const SceneDescription& scene, const DeviceBenchOptions& options) {
  return bench_device_on(*open_cuda(), scene, options);
}

}  // namespace raysheaf
