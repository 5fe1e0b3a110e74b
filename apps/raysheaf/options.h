// The parsed command line. No parser is included here.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "compare/words.h"
#include "raysheaf/block_file.h"
#include "raysheaf/context.h"
#include "raysheaf/device_bench.h"
#include "raysheaf/io.h"
#include "raysheaf/lab.h"
#include "raysheaf/render.h"
#include "raysheaf/studio.h"
#include "raysheaf/verify.h"
#include "raysheaf/viewpoint.h"
#include "render/frames.h"
#include "text/command_text.h"

namespace raysheaf::app {

/// Exit codes, as docs/command-line.md documents them; `interrupted_code()` is that of an
/// interrupt.
enum ExitCode : int {
  kSuccess = 0,
  kFailed = 1,
  kUsage = 2,
};

/// Changes to the light of a scene; an empty field changes nothing.
struct LightOptions {
  std::optional<float> size;  ///< radius of point and spot lights
  std::string environment;    ///< a file
  std::optional<float> intensity, rotation_degrees;
};

/// The viewpoint of the image.
struct ViewOptions {
  Viewpoint viewpoint;
  bool is_own = false;  ///< the camera of the command line replaces those of the scene
};

/// How the processes that mpirun started share an image.
enum class Share : std::uint8_t {
  kAuto,      ///< frames, if there are enough; geometry for streaming; otherwise rays
  kRays,      ///< each has the whole scene and traces a part of every batch
  kGeometry,  ///< each streams a part of the blocks past all rays
  kNone,      ///< each process runs independently
};

struct RenderCommand {
  std::string scene;
  LoadOptions load;
  std::vector<std::string> pictures;  ///< the ending of each name selects its format
  std::string stats_path, heatmap_path;
  Device device = Device::kCpu;
  bool explain = false, quiet = false;
  bool stream = false;  ///< block files always stream
  std::uint64_t memory_bytes = std::uint64_t{2} << 30;
  Share share = Share::kAuto;
  FramesOptions frames;
  RenderOptions options;
  LightOptions light;
  ViewOptions view;
  std::optional<Rgba> background;  ///< behind the scene, instead of the sky
};

struct ReportCommand {
  std::string scene;
  LoadOptions load;
  std::string output;           ///< HTML
  std::vector<Method> methods;  ///< empty: all, `brute` only if it takes seconds
  bool quiet = false;
  RenderOptions options;           ///< `method` is not used
  std::vector<std::string> words;  ///< of the command line, after "report"
};

struct PackCommand {
  std::string scene, output;
  LoadOptions load;
  BlockFileOptions file;
  std::uint32_t block_triangles = kBlockTriangles;
  bool quiet = false;
};

struct InfoCommand {
  std::string scene;
  LoadOptions load;
  bool all = false, json = false;
};

struct SceneCommand {
  bool list = false;
  std::string name, output;
  std::uint64_t triangles = 1'000'000;  ///< of the hall
  bool compress = false;                ///< of block files
  std::uint32_t threads = 0;            ///< of the hall
};

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
  std::uint32_t most = 10'000'000;  ///< largest number of rays and triangles of the growth
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

struct VerifyCommand {
  VerifyOptions options;  ///< without `rounds`, counts of rays and `progress`
  std::uint32_t rounds = 0;
  bool is_long = false, quiet = false;
  std::string json_path;
};

struct ViewCommand {
  std::string scene;
  LoadOptions load;
  std::string script_path, screenshot_path, settings_path;
  std::uint32_t width = 0, height = 0;  ///< 0: as in the settings
  std::uint32_t threads = 0;
};

struct CompletionCommand {
  std::string shell;
  CommandText raysheaf;
};

struct ManualCommand {
  std::string folder;
  CommandText raysheaf;
};

using Command =
    std::variant<RenderCommand, ReportCommand, ViewCommand, InfoCommand, SceneCommand, PackCommand,
                 VerifyCommand, BenchPaperCommand, BenchAblationCommand, BenchCompareCommand,
                 BenchGpuCommand, BenchScaleCommand, CompletionCommand, ManualCommand>;

/// Each returns an exit code, or throws `Error`.
int run(const RenderCommand& command);
int run(const ReportCommand& command);
int run(const ViewCommand& command);
int run(const InfoCommand& command);
int run(const SceneCommand& command);
int run(const PackCommand& command);
int run(const VerifyCommand& command);
int run(const BenchPaperCommand& command);
int run(const BenchAblationCommand& command);
int run(const BenchCompareCommand& command);
int run(const BenchGpuCommand& command);
int run(const BenchScaleCommand& command);
int run(const CompletionCommand& command);
int run(const ManualCommand& command);

}  // namespace raysheaf::app
