#include "parse/viewpoint.h"

#include <array>
#include <numbers>

#include "parse/parts.h"
#include "render/viewpoint.h"
#include "values.h"

namespace raysheaf::app {
namespace {

/// Each makes a camera of the command line's own.
constexpr std::array<const char*, 6> kOwnCamera{"--view",    "--up",  "--camera-position",
                                                "--look-at", "--fov", "--orthographic"};

[[noreturn]] void refuse_view(const std::string& option, const std::string& sentence) {
  throw CLI::ValidationError(option, sentence);
}

}  // namespace

void add_viewpoint(CLI::App& app, ViewOptions& view) {
  Viewpoint& v = view.viewpoint;
  add_value(app, "--view", "front|back|left|right|top|bottom|iso",
            "The side of the model that is seen [from the front, above and to the right]",
            [&v](const auto& text) { v.view = view_from_string(text); });
  add_value(app, "--up", "x|y|z|-x|-y|-z", "The model's axis that points up [y]",
            [&v](const auto& text) { v.up = up_axis_from_string(text); });
  add_value(app, "--camera-position", "X,Y,Z",
            "Where the camera is [as near as the whole model can be seen from]",
            [&v](const auto& text) { v.position = parse_point(text); });
  add_value(app, "--look-at", "X,Y,Z",
            "Where the camera of --camera-position looks [the middle of the model]",
            [&v](const auto& text) { v.look_at = parse_point(text); });
  add_value(app, "--fov", "DEGREES", "Vertical field of view, between 0 and 180 [40]",
            [&v](const auto& text) {
              const float degrees = parse_positive(text);
              if (!(degrees < 180))
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not below 180");
              v.fov = degrees * std::numbers::pi_v<float> / 180;
            });
  app.add_flag("--orthographic", v.orthographic, "Without perspective");
  add_value(app, "--zoom", "X", "Magnifies the picture about its middle; of any camera [1]",
            [&v](const auto& text) { v.zoom = parse_positive(text); });
}

void check_viewpoint(const CLI::App& app, RenderCommand& command) {
  ViewOptions& view = command.view;
  std::string own;
  for (const char* option : kOwnCamera)
    if (own.empty() && app.count(option) > 0) own = option;
  view.is_own = !own.empty();
  if (view.is_own && !command.options.camera.empty())
    refuse_view(own, "makes a camera of its own, and --camera names one of the scene's: give one");
  if (!command.frames.camera_path.empty()) {
    if (own.empty() && app.count("--zoom") > 0) own = "--zoom";
    if (!own.empty()) refuse_view(own, "says what --camera-path already says");
  }
  command.frames.up = direction_of(view.viewpoint.up);
  try {
    validate(view.viewpoint);
  } catch (const Error& error) {
    const Error named = with_option_names(error);
    refuse_view(named.place(), named.sentence());
  }
}

}  // namespace raysheaf::app
