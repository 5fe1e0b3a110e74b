// The parsed command line. No parser is included here.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/support/exit_code.h"
#include "lab/commands/commands.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/block_file.h"
#include "raysheaf/cameras.h"
#include "raysheaf/context.h"
#include "raysheaf/io.h"
#include "raysheaf/render.h"
#include "raysheaf/studio.h"
#include "raysheaf/verify.h"
#include "render/frames.h"
#include "text/command_text.h"

namespace raysheaf::app {

/// The sun in a clear sky: the direction to it, or where it stands in the sky.
using Sun = std::variant<Vec3, SunPosition>;

/// Changes to the light of a scene; an empty field changes nothing.
struct LightOptions {
  std::optional<float> size;  ///< radius of point and spot lights
  std::string environment;    ///< a file
  std::optional<float> intensity, rotation_degrees;
  std::optional<Sun> sun;
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
  bool ground = false;             ///< catches the shadow
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

struct VerifyCommand {
  VerifyOptions options;  ///< without `rounds`, `seconds`, counts of rays and `progress`
  std::uint32_t rounds = 0, seconds = 0;
  bool is_long = false, quiet = false;
  std::string json_path;
};

struct ViewCommand {
  std::string scene;
  LoadOptions load;
  std::string script_path, screenshot_path, settings_path;
  std::uint32_t width = 0, height = 0;  ///< 0: as in the settings
  std::uint32_t threads = 0;
  std::optional<ViewSide> view;
  std::optional<UpAxis> up;  ///< none: as in the settings
  bool orthographic = false;
};

struct CompletionCommand {
  std::string shell;
  CommandText raysheaf;
};

struct ManualCommand {
  std::string folder;
  CommandText raysheaf;
};

using Command = std::variant<RenderCommand, ReportCommand, ViewCommand, InfoCommand, SceneCommand,
                             PackCommand, VerifyCommand, BenchPaperCommand, BenchAblationCommand,
                             BenchCompareCommand, BenchInstancesCommand, BenchPlanCommand,
                             BenchGpuCommand, BenchScaleCommand, CompletionCommand, ManualCommand>;

/// Each returns an exit code, or throws `Error`.
int run(const RenderCommand& command);
int run(const ReportCommand& command);
int run(const ViewCommand& command);
int run(const InfoCommand& command);
int run(const SceneCommand& command);
int run(const PackCommand& command);
int run(const VerifyCommand& command);
int run(const CompletionCommand& command);
int run(const ManualCommand& command);

}  // namespace raysheaf::app
