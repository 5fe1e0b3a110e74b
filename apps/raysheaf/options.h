// What the command line asked for, after parsing. No parser in here.
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

/// Exit codes, as docs/command-line.md promises them; that of an interrupt is `interrupted_code()`.
enum ExitCode : int {
  kSuccess = 0,
  kFailed = 1,
  kUsage = 2,
};

/// Changes to a scene's light; none where a field is empty.
struct LightOptions {
  std::optional<float> size;  ///< radius of points and spots
  std::string environment;    ///< a file
  std::optional<float> intensity, rotation_degrees;
};

/// From where the picture is seen.
struct ViewOptions {
  Viewpoint viewpoint;
  bool is_own = false;  ///< the command line's camera counts, and none of the scene's
};

/// How the processes that mpirun started share a picture.
enum class Share : std::uint8_t {
  kAuto,      ///< frames, where there are enough; geometry of what streams; rays of all else
  kRays,      ///< each has the scene and traces a part of every batch
  kGeometry,  ///< each streams a part of the blocks past all rays
  kNone,      ///< not at all: each is a run of its own
};

struct RenderCommand {
  std::string scene;
  LoadOptions load;
  std::vector<std::string> pictures;  ///< PNG and OpenEXR, by their ending
  std::string stats_path, heatmap_path;
  Device device = Device::kCpu;
  bool explain = false, quiet = false;
  bool stream = false;  ///< block files stream in any case
  std::uint64_t memory_bytes = std::uint64_t{2} << 30;
  Share share = Share::kAuto;
  FramesOptions frames;
  RenderOptions options;
  LightOptions light;
  ViewOptions view;
  std::optional<Rgba> background;  ///< behind the scene, in place of the sky
};

struct ReportCommand {
  std::string scene;
  LoadOptions load;
  std::string output;           ///< HTML
  std::vector<Method> methods;  ///< empty: all, `brute` only as far as it takes seconds
  bool quiet = false;
  RenderOptions options;           ///< `method` is not used
  std::vector<std::string> words;  ///< of the command line, behind "report"
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
  bool json = false;
};

struct SceneCommand {
  bool list = false;
  std::string name, output;
  std::uint64_t triangles = 1'000'000;  ///< of the hall
  bool compress = false;                ///< of block files
  std::uint32_t threads = 0;            ///< of the hall
};

struct BenchPaperCommand {
  std::string scenes;  ///< a folder; empty: the built-in scenes
  std::string json_path, markdown_path;
  std::vector<Method> methods;  ///< empty: all there are
  bool as_published = false, check = false, quiet = false;
  bool times = true;  ///< in text and Markdown
  std::uint32_t width = 512, height = 512, threads = 0;
};

struct BenchAblationCommand {
  std::string scene, scenes;  ///< a scene, or a folder of scenes; neither: the built-in ones
  std::vector<LabRays> rays;
  std::vector<RayKey> keys;
  std::vector<BundleBound> bounds;
  std::vector<std::uint32_t> key_bits{32, 64}, levels{2}, branching{8};
  std::vector<bool> mesh_culling{true};
  std::uint32_t width = 512, height = 512, threads = 0, repeat = 1;
  bool check = false, quiet = false;
  std::string json_path, csv_path, svg_path, markdown_path;
};

/// Width and height.
using ImageSize = std::pair<std::uint32_t, std::uint32_t>;

struct BenchCompareCommand {
  std::string scenes;                    ///< a folder; empty: the built-in scenes
  std::vector<std::string> scene_names;  ///< empty: all there are
  std::vector<CompareKind> kinds;        ///< empty: all
  std::vector<CompareMode> modes;        ///< empty: all
  std::vector<ImageSize> sizes;          ///< of the pictures that rays come from; empty: 512x512
  std::uint32_t threads = 0, runs = 9;
  bool growth = false, quiet = false;
  std::uint32_t most = 10'000'000;  ///< rays and triangles that growth goes to
  std::string json_path, markdown_path, plot_path;
};

struct BenchGpuCommand {
  std::string scenes;                    ///< a folder; empty: the built-in scenes
  std::vector<std::string> scene_names;  ///< empty: all there are
  DeviceBenchOptions options;
  bool counts = false;  ///< nothing is timed, and no device is needed
  bool quiet = false;
  std::string json_path;
};

struct BenchScaleCommand {
  std::uint64_t triangles = 1'000'000'000;        ///< of the scene that is asked about
  std::uint64_t measured_triangles = 16'000'000;  ///< of the largest that is rendered
  std::uint32_t machines = 64, side = 512, threads = 0;
  std::uint32_t cores = 16, disk_mb_s = 2000, network_mb_s = 1250;  ///< of a machine
  std::string mpirun;  ///< what starts processes; empty: mpirun, where there is one
  bool quiet = false;
  std::string json_path, markdown_path;
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
  std::uint32_t width = 0, height = 0;  ///< 0: as the settings say
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

/// Each gives an exit code, or throws `Error`.
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
