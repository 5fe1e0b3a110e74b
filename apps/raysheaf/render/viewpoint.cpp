#include "render/viewpoint.h"

#include <algorithm>

#include "raysheaf/backdrop.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/studio.h"
#include "render/frames_command.h"
#include "render/stream.h"

namespace raysheaf::app {
namespace {

/// Whether images at several times must fit together.
bool is_moving(const RenderCommand& command) {
  return wants_frames(command) || command.frames.time.has_value();
}

Camera camera_for(const RenderCommand& command, const GeometrySource* blocks,
                  Animation& animation) {
  const Viewpoint viewpoint = viewpoint_of(command);
  if (blocks != nullptr) return framing_camera(*blocks, viewpoint);
  if (is_moving(command)) return framing_camera(animation, viewpoint);
  return framing_camera(animation.scene(), viewpoint);
}

/// A name that no camera of the scene has.
std::string new_camera_name(const SceneDescription& scene) {
  std::string name = "viewpoint";
  const auto is_taken = [&](const Camera& camera) { return camera.name == name; };
  while (std::any_of(scene.cameras.begin(), scene.cameras.end(), is_taken)) name += "'";
  return name;
}

/// Whether an automatic camera replaces the first camera of the file, because none was chosen and
/// it does not show the scene.
bool hides_scene(const RenderCommand& command, const GeometrySource* blocks, Animation& animation) {
  const std::vector<Camera>& cameras = animation.scene().cameras;
  if (!command.options.camera.empty() || !command.frames.camera_path.empty() || cameras.empty())
    return false;
  if (blocks != nullptr) return !shows(cameras.front(), *blocks);
  return is_moving(command) ? !first_camera_shows(animation)
                            : !shows(cameras.front(), animation.scene());
}

}  // namespace

void replace_first_camera(Camera camera, SceneDescription* scene, RenderOptions* options) {
  scene->warnings.emplace_back(
      "the first camera shows the scene in less than half of the image's width and height: an "
      "automatic camera replaces it, unless --camera 0 is given");
  options->camera = camera.name = new_camera_name(*scene);
  scene->cameras.push_back(std::move(camera));
  if (needs_light(*scene) || has_studio_lights(*scene))
    scene->lights = studio_lights(*scene, scene->cameras.back());
}

Viewpoint viewpoint_of(const RenderCommand& command) {
  Viewpoint viewpoint = command.view.viewpoint;
  const RenderOptions& options = command.options;
  if (options.width != 0)
    viewpoint.aspect_ratio = static_cast<float>(options.width) / static_cast<float>(options.height);
  viewpoint.all_around = command.frames.turntable != 0;
  return viewpoint;
}

void set_camera(RenderCommand* command, const GeometrySource* blocks, Animation& animation) {
  SceneDescription& scene = animation.scene();
  try {
    // After the others, because animations refer to cameras by their numbers. Packing has already
    // added it.
    if (command->view.is_own) {
      const bool is_packed = blocks != nullptr && !is_block_file(command->scene);
      if (!is_packed) scene.cameras.push_back(camera_for(*command, blocks, animation));
      command->options.camera = scene.cameras.back().name = new_camera_name(scene);
      if (needs_light(scene)) scene.lights = studio_lights(scene, scene.cameras.back());
    } else if (hides_scene(*command, blocks, animation)) {
      replace_first_camera(camera_for(*command, blocks, animation), &scene, &command->options);
    } else if (scene.cameras.empty()) {
      scene.cameras.push_back(camera_for(*command, blocks, animation));
    } else if (command->view.viewpoint.zoom != 1) {
      for (Camera& camera : scene.cameras) camera = zoomed(camera, command->view.viewpoint.zoom);
    }
  } catch (const Error& error) {
    throw with_option_names(error);
  }
}

Ground ground_of(const RenderCommand& command, Animation& animation) {
  const UpAxis up = command.view.viewpoint.up;
  return is_moving(command) ? ground_under(animation, up) : Ground{up, std::nullopt};
}

Error with_option_names(const Error& error) {
  if (error.code() != ErrorCode::kInvalidArgument || error.place().empty()) return error;
  const auto spelt = [](std::string field) {
    std::replace(field.begin(), field.end(), '_', '-');
    return "--" + field;
  };
  std::string sentence = error.sentence();
  for (const char* field : {"camera_position", "look_at"}) {
    const std::size_t at = sentence.find(field);
    if (at != sentence.npos) sentence.replace(at, std::string(field).size(), spelt(field));
  }
  return Error(error.code(), sentence, spelt(error.place()));
}

}  // namespace raysheaf::app
