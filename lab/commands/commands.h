// The commands of the laboratory, `raysheaf bench`, as parsed. No parser is included here.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "lab/commands/compare/words.h"
#include "raysheaf/device_bench.h"
#include "raysheaf/lab.h"
#include "raysheaf/method.h"

namespace raysheaf::app {

struct BenchPaperCommand {
  std::string words;   ///< the command without outputs, for pages
  std::string scenes;  ///< a folder; empty: the built-in scenes
  std::string json_path;
  std::vector<Method> methods;  ///< empty: all
  bool as_published = false, check = false, quiet = false;
  std::uint32_t width = 512, height = 512, threads = 0;
};

struct BenchAblationCommand {
  std::string words;          ///< the command without outputs, for pages
  std::string scene, scenes;  ///< one scene, or a folder of scenes; neither: the built-in scenes
  std::vector<LabRays> rays;
  std::vector<RayKey> keys;
  std::vector<BundleBound> bounds;
  std::vector<std::uint32_t> key_bits{32, 64}, levels{2}, branching{8};
  std::vector<bool> mesh_culling{true};
  std::uint32_t width = 512, height = 512, threads = 0, repeat = 1;
  bool check = false, quiet = false;
  std::string json_path, csv_path;
};

/// Width and height.
using ImageSize = std::pair<std::uint32_t, std::uint32_t>;

struct BenchCompareCommand {
  std::string words;                     ///< the command without outputs, for pages
  std::string scenes;                    ///< a folder; empty: the built-in scenes
  std::vector<std::string> scene_names;  ///< empty: all
  std::vector<CompareKind> kinds;        ///< empty: all
  std::vector<CompareMode> modes;        ///< empty: all
  std::vector<ImageSize> sizes;          ///< of the images that the rays come from; empty: 512x512
  std::uint32_t threads = 0, runs = 9;
  bool growth = false, quiet = false;
  float ground = 0;                 ///< half the side of a square below each scene; 0: none
  std::uint32_t most = 10'000'000;  ///< largest number of rays and triangles of the growth
  std::string csv_path;
};

/// So many instances of a mesh of at most so many triangles: "50x1024".
struct InstancesShape {
  std::uint32_t instances = 0, triangles = 0;
  bool operator==(const InstancesShape&) const = default;
};

enum class InstanceRays : std::uint8_t {
  kCamera,  ///< from a camera that sees all instances
  kRandom,  ///< origins all over the scene's box, uniform directions
};

struct BenchInstancesCommand {
  std::string words;                   ///< the command without outputs, for pages
  std::vector<InstancesShape> shapes;  ///< empty: those of docs/bench.md
  std::vector<std::uint32_t> rays;     ///< sizes of batches; empty: those of docs/bench.md
  std::vector<InstanceRays> kinds;     ///< empty: all
  std::vector<bool> moved;             ///< whether all instances move in each frame; empty: both
  std::uint32_t threads = 0, runs = 9;
  bool flat = false;  ///< measures the scene with its instances placed, too
  bool quiet = false;
  std::string csv_path;
};

struct BenchPlanCommand {
  std::string words;                     ///< the command without outputs, for pages
  std::string scenes;                    ///< a folder; empty: the built-in scenes
  std::vector<std::string> scene_names;  ///< empty: all
  std::vector<CompareKind> kinds;        ///< empty: all
  std::vector<CompareMode> modes;        ///< empty: all
  std::uint32_t width = 512, height = 512, threads = 0, runs = 9;
  bool check = false, quiet = false;
  std::string json_path;
};

struct BenchGpuCommand {
  std::string scenes;                    ///< a folder; empty: the built-in scenes
  std::vector<std::string> scene_names;  ///< empty: all
  DeviceBenchOptions options;
  bool counts = false;  ///< only counts, without times and without a device
  bool quiet = false;
  std::string json_path;
};

struct BenchScaleCommand {
  std::string words;                     ///< the command without outputs, for pages
  std::uint64_t triangles = 16'000'000;  ///< of the largest scene that is rendered
  std::uint32_t side = 512, threads = 0;
  std::string mpirun;  ///< command that starts processes; empty: mpirun, if it is installed
  bool quiet = false;
  std::string json_path;
};

/// Called before each measurement with its name, the number of those done and that of all. May
/// throw.
using Tell = std::function<void(const std::string& what, std::uint64_t done, std::uint64_t total)>;

/// Each returns an exit code, or throws `Error`.
int run(const BenchPaperCommand& command);
int run(const BenchAblationCommand& command);
int run(const BenchCompareCommand& command);
int run(const BenchInstancesCommand& command);
int run(const BenchPlanCommand& command);
int run(const BenchGpuCommand& command);
int run(const BenchScaleCommand& command);

}  // namespace raysheaf::app
