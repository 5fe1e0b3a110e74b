// The camera of an image: that of the scene, of the command line, or one that frames the scene.
#pragma once

#include "options.h"
#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// The viewpoint of the command line, with the aspect ratio of its image.
[[nodiscard]] Viewpoint viewpoint_of(const RenderCommand& command);

/// Uses `camera` because the scene's first one does not show it (`shows`): adds it after the
/// others, with a warning, lets the options name it, and lights a scene without lights for it.
void replace_first_camera(Camera camera, SceneDescription* scene, RenderOptions* options);

/// Gives the animation the camera of the command line, which `command` then names, or one that
/// frames the scene if it has none or its first one does not show it, and applies the
/// magnification. A scene without lights is lit for the new camera. `blocks`: those that stream, or
/// null. Throws `Error` (kInvalidArgument) whose place is the option.
void set_camera(RenderCommand* command, const GeometrySource* blocks, Animation& animation);

/// The ground of the command line, which stays in place while the scene moves.
[[nodiscard]] Ground ground_of(const RenderCommand& command, Animation& animation);

/// Translates the library's names of fields to options: "look_at" to "--look-at".
[[nodiscard]] Error with_option_names(const Error& error);

}  // namespace raysheaf::app
