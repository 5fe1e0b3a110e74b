// The camera of a picture: the scene's, the command line's, or one that frames the scene.
#pragma once

#include "options.h"
#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

/// The viewpoint of the command line, in the shape of its picture.
[[nodiscard]] Viewpoint viewpoint_of(const RenderCommand& command);

/// Gives the animation the camera of the command line, which `command` then names, or else one that
/// frames the scene; and magnifies what cameras see. A scene without lights is
/// lit for the camera of the command line. `blocks`: those of a
/// block file, or null. Throws `Error` (kInvalidArgument) whose place is the option.
void set_camera(RenderCommand* command, const GeometrySource* blocks, Animation& animation);

/// The library's names of fields as those of options: "look_at" is "--look-at".
[[nodiscard]] Error with_option_names(const Error& error);

}  // namespace raysheaf::app
