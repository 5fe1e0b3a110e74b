#include "parse/commands.h"

#include <array>
#include <numbers>

#include "apps/support/values.h"
#include "parse/parts.h"
#include "render/viewpoint.h"

namespace raysheaf::app {
namespace {

/// Each of these options replaces the cameras of the scene.
constexpr std::array<const char*, 6> kOwnCamera{"--view",    "--up",  "--camera-position",
                                                "--look-at", "--fov", "--orthographic"};

[[noreturn]] void refuse_view(const std::string& option, const std::string& sentence) {
  throw CLI::ValidationError(option, sentence);
}

}  // namespace

void add_common_viewpoint(CLI::App& app, ViewOptions& view) {
  Viewpoint& v = view.viewpoint;
  begin_group(app, kCommonGroup);
  add_value(app, "--view", "front|back|left|right|top|bottom|iso",
            "Side of the model that the camera sees [the front, from above and from the right]",
            [&v](const auto& text) { v.view = view_from_string(text); });
  add_value(app, "--up", "x|y|z|-x|-y|-z", "Axis of the model that points up [y]",
            [&v](const auto& text) { v.up = up_axis_from_string(text); });
}

void add_viewpoint(CLI::App& app, ViewOptions& view) {
  Viewpoint& v = view.viewpoint;
  begin_group(app, kCameraGroup);
  add_value(app, "--camera-position", "X,Y,Z",
            "Position of the camera [the nearest one that sees the whole model]",
            [&v](const auto& text) { v.position = parse_point(text); });
  add_value(app, "--look-at", "X,Y,Z",
            "Point that the camera of --camera-position looks at [the middle of the model]",
            [&v](const auto& text) { v.look_at = parse_point(text); });
  add_value(app, "--fov", "DEGREES", "Vertical field of view, between 0 and 180 [40]",
            [&v](const auto& text) {
              const float degrees = parse_positive(text);
              if (!(degrees < 180))
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is not below 180");
              v.fov = degrees * std::numbers::pi_v<float> / 180;
            });
  app.add_flag("--orthographic", v.orthographic, "Use parallel rays instead of a perspective");
  add_value(app, "--zoom", "X", "Magnification about the middle of the image, for any camera [1]",
            [&v](const auto& text) { v.zoom = parse_positive(text); });
}

void check_viewpoint(const CLI::App& app, RenderCommand& command) {
  ViewOptions& view = command.view;
  std::string own;
  for (const char* option : kOwnCamera)
    if (own.empty() && app.count(option) > 0) own = option;
  view.is_own = !own.empty();
  if (view.is_own && !command.options.camera.empty())
    refuse_view(own,
                "it replaces the scene's cameras, and --camera names one of them: give only one");
  if (!command.frames.camera_path.empty()) {
    if (own.empty() && app.count("--zoom") > 0) own = "--zoom";
    if (!own.empty()) refuse_view(own, "it contradicts --camera-path: give only one of them");
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
