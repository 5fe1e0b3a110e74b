#include "lab/commands/scale/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "apps/support/stoppable_sink.h"
#include "apps/support/timer.h"
#include "raysheaf/block_file.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/context.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "system/files.h"

namespace raysheaf::app {
namespace {

namespace fs = std::filesystem;

/// A folder that is removed at the end of the scope.
class WorkFolder {
 public:
  WorkFolder() {
    path_ = system::make_temporary_folder();
    if (path_.empty())
      throw Error(ErrorCode::kIo, "cannot make a folder there", fs::temp_directory_path().string());
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }
  [[nodiscard]] std::string file(std::uint64_t triangles) const {
    return (path_ / ("hall-" + std::to_string(triangles) + ".rsb")).string();
  }

 private:
  fs::path path_;
};

void write_hall(const std::string& path, std::uint64_t triangles, std::uint32_t threads) {
  BlockFileWriter file(path);
  StoppableSink sink(&file);
  const SceneDescription rest = hall_in_blocks(triangles, &sink, threads);
  file.finish(rest);
}

/// Renders a frame twice and returns the faster run, from the system's cache.
ScaleSample measure(const BlockFile& file, std::uint32_t side, std::uint32_t threads) {
  ScaleSample best;
  for (int turn = 0; turn < 2; ++turn) {
    RenderOptions options;
    options.width = options.height = side;
    options.threads = threads;
    options.primary = Primary::kTrace;
    options.progress = [](const Progress&) { return !interrupted(); };
    StreamStatistics s;
    StreamOptions stream;
    stream.statistics = &s;
    const Timer clock;
    const RenderResult result = render(file, options, stream);
    ScaleSample sample;
    sample.seconds = clock.seconds();
    if (turn > 0 && sample.seconds >= best.seconds) continue;
    sample.triangles = static_cast<double>(file.triangle_count());
    sample.pixels = static_cast<double>(side) * side;
    sample.batches = static_cast<std::uint32_t>(result.statistics.batches.size());
    for (const BatchStatistics& batch : result.statistics.batches)
      sample.rays += static_cast<double>(batch.rays);
    sample.blocks = s.blocks;
    sample.read_blocks = s.read_blocks;
    const double cores = threads;
    sample.cost.decode_s = 1e-3 * s.read_ms;
    sample.cost.cull_s = 1e-3 * s.cull_ms * cores;
    sample.cost.trace_s = 1e-3 * s.trace_ms * cores;
    sample.cost.shading_s = 1e-3 * s.shading_ms * cores;
    const double streamed = 1e-3 * (s.wait_ms + s.cull_ms + s.trace_ms + s.shading_ms);
    sample.cost.rest_s = std::max(0.0, sample.seconds - streamed) * cores;
    sample.cost.bytes = static_cast<double>(s.read_bytes);
    best = sample;
  }
  return best;
}

/// Rays of the scene's first camera through a square of the image, from `low` to `high` on both
/// sides.
std::vector<Ray> eye_rays(const Camera& camera, float low, float high, std::uint32_t side) {
  const auto& m = camera.to_world.m;
  const float half = std::tan(camera.y_fov / 2);
  std::vector<Ray> rays;
  rays.reserve(std::size_t{side} * side);
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const auto at = [&](std::uint32_t k) {
      const float part =
          low + (high - low) * (static_cast<float>(k) + 0.5f) / static_cast<float>(side);
      return (2 * part - 1) * half;
    };
    const float x = at(i % side), y = at(i / side);
    const auto axis = [&](std::size_t r) { return m[r][0] * x + m[r][1] * y - m[r][2]; };
    rays.push_back({{m[0][3], m[1][3], m[2][3]}, 0, {axis(0), axis(1), axis(2)}});
  }
  return rays;
}

double bytes_of(const BlockFile& file, const std::vector<Ray>& rays, std::uint32_t threads) {
  StreamStatistics s;
  StreamOptions options;
  options.statistics = &s;
  options.threads = threads;
  std::vector<Hit> hits(rays.size());
  stop_if_interrupted();
  closest_hit(file, rays, hits, options);
  return static_cast<double>(s.read_bytes);
}

/// How the bytes that rays need shrink if quarters of the image share them.
double sharing_of(const BlockFile& file, std::uint32_t side, std::uint32_t threads) {
  const Camera& camera = file.scene().cameras.front();
  const double whole = bytes_of(file, eye_rays(camera, 0, 1, side), threads);
  const double quarter = (bytes_of(file, eye_rays(camera, 0, 0.5f, side / 2), threads) +
                          bytes_of(file, eye_rays(camera, 0.5f, 1, side / 2), threads)) /
                         2;
  return std::clamp(std::log(quarter / whole) / std::log(0.25), 0.0, 1.0);
}

/// By one process and by two, which have all threads together. The default command may be missing;
/// one that was given must exist.
void run_ranks(const std::string& path, const WorkFolder& folder, std::uint32_t side,
               const std::function<void()>& step, ScaleReport* report) {
  const std::string& asked = report->asked.mpirun;
  try {
    for (const std::uint32_t ranks : {1u, 2u}) {
      step();
      report->rank_runs.push_back(measure_ranks(asked.empty() ? "mpirun --bind-to none" : asked,
                                                path, folder.path(), side, ranks,
                                                std::max(1u, report->threads / ranks)));
    }
  } catch (const Error& error) {
    if (!asked.empty() || error.code() != ErrorCode::kUnsupported) throw;
    report->rank_runs.clear();
    report->no_rank_runs = error.what();
  }
}

}  // namespace

ScaleReport measure_scale(const BenchScaleCommand& command, const Tell& tell) {
  ScaleReport report;
  report.asked = command;
  ContextOptions context;
  context.threads = command.threads;
  report.threads = Context(context).threads();
  const std::uint64_t most = command.triangles;
  const std::uint32_t side = command.side;
  constexpr std::uint64_t kSteps = 13;
  std::uint64_t done = 0;
  const auto step = [&] { tell("measurements", done++, kSteps); };
  const WorkFolder folder;
  for (const std::uint64_t triangles : {most / 8, most / 2, most}) {
    step();
    const std::string path = folder.file(triangles);
    write_hall(path, triangles, report.threads);
    const BlockFile file(path);
    if (triangles == most / 2) {
      step();
      report.check = measure(file, side / 4 * 3, report.threads);
      run_ranks(path, folder, side / 4 * 3, step, &report);
      continue;
    }
    for (const std::uint32_t s : {side / 2, side}) {
      step();
      report.samples.push_back(measure(file, s, 1));
    }
    if (triangles != most) continue;
    step();
    report.together = measure(file, side, report.threads);
    step();
    report.sharing = sharing_of(file, side, report.threads);
    for (const BlockInfo& block : file.blocks()) {
      report.geometry_bytes += static_cast<double>(block.geometry_bytes);
      report.shading_bytes += static_cast<double>(block.shading_bytes);
    }
    report.geometry_bytes /= static_cast<double>(file.triangle_count());
    report.shading_bytes /= static_cast<double>(file.triangle_count());
  }
  tell("measurements", kSteps, kSteps);
  return report;
}

}  // namespace raysheaf::app
