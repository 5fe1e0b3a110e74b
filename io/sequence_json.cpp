// Reads the JSON that describes a sequence of files.
#include <numbers>

#include "io/json_text.h"
#include "io/linear.h"
#include "io/refuse.h"
#include "io/sequence.h"

namespace raysheaf::io {
namespace {

std::span<const JsonValue> list(const JsonValue& value, const char* name) {
  const JsonValue* member = value.find(name);
  if (member == nullptr) return {};
  if (!member->is_array()) refuse("is not an array", name);
  return member->items();
}

std::string text_of(const JsonValue& value, const std::string& place) {
  if (!value.is_string()) refuse("is not a string", place);
  return value.get<std::string>();
}

/// Defaults for cameras that do not set these values themselves.
struct Lens {
  double y_fov_degrees = 60, z_near = 0.01;
};

Lens read_lens(const JsonValue& camera, Lens lens, const std::string& place) {
  const JsonValue* fov = camera.find("full_field_of_view_degrees");
  const JsonValue* hither = camera.find("hither");
  if (fov != nullptr) lens.y_fov_degrees = number_of(*fov, place + ".full_field_of_view_degrees");
  if (!(lens.y_fov_degrees > 0 && lens.y_fov_degrees < 180))
    refuse("must be between 0 and 180", place + ".full_field_of_view_degrees");
  if (hither != nullptr) lens.z_near = number_of(*hither, place + ".hither");
  if (!(static_cast<float>(lens.z_near) > 0)) refuse("must be above 0", place + ".hither");
  return lens;
}

Camera read_camera(const JsonValue& value, const Lens& usual, const std::string& place) {
  require_object(value, place);
  const Lens lens = read_lens(value, usual, place);
  const auto vector = [&](const char* name) {
    return widen(vector_of(member_of(value, name, place), place + "." + name));
  };
  const Double3 eye = vector("eye");
  const bool has_target = value.contains("target");
  const Double3 ahead = has_target ? vector("target") - eye : vector("direction");
  if (!(length(ahead) > 0))
    refuse("gives the camera no viewing direction",
           place + (has_target ? ".target" : ".direction"));
  const Double3 z = normalized(ahead * -1, {0, 0, 1});
  const Double3 up = value.contains("up") ? vector("up") : Double3{0, 1, 0};
  const Double3 side = cross(up, z);
  if (!(length(side) > 1e-9 * length(up)))
    refuse("runs along what the camera looks at", place + ".up");
  const Double3 x = normalized(side, {1, 0, 0});
  DoubleAffine frame;
  frame.columns = {x, cross(z, x), z, eye};
  Camera camera;
  camera.to_world = narrow(frame);
  camera.y_fov = static_cast<float>(lens.y_fov_degrees * std::numbers::pi / 180);
  camera.z_near = static_cast<float>(lens.z_near);
  return camera;
}

Light read_light(const JsonValue& value, const std::string& place) {
  require_object(value, place);
  Light light;
  light.position = vector_of(member_of(value, "position", place), place + ".position");
  light.intensity = vector_of(member_of(value, "color", place), place + ".color");
  if (light.intensity.x < 0 || light.intensity.y < 0 || light.intensity.z < 0)
    refuse("is negative", place + ".color");
  return light;
}

class SequenceReader {
 public:
  SequenceReader(const JsonValue& root, const SceneFile& from) : root_(root), from_(from) {}

  SequenceFiles read() {
    require_object(root_, "JSON root");
    if (const JsonValue* name = root_.find("name")) files_.name = text_of(*name, "name");
    if (const JsonValue* still = root_.find("static"))
      files_.still = resolve(from_, text_of(*still, "static"), false, "static");
    if (const JsonValue* camera = root_.find("camera_default")) read_still_camera(*camera);
    const auto lights = list(root_, "lights");
    for (std::size_t i = 0; i < lights.size(); ++i)
      files_.lights.push_back(read_light(lights[i], element("lights", i)));
    const auto frames = list(root_, "frames");
    for (std::size_t i = 0; i < frames.size(); ++i) read_frame(frames[i], i);
    if (files_.frames.empty()) refuse("there are no frames", "frames");
    return std::move(files_);
  }

 private:
  void read_still_camera(const JsonValue& camera) {
    files_.still_cameras.push_back(read_camera(camera, {}, "camera_default"));
    files_.still_cameras.back().name = "default";
    lens_ = read_lens(camera, {}, "camera_default");
  }

  void read_frame(const JsonValue& frame, std::size_t i) {
    const std::string place = element("frames", i);
    require_object(frame, place);
    const std::string file = text_of(member_of(frame, "file", place), place + ".file");
    files_.frames.push_back(resolve(from_, file, false, place + ".file"));
    const JsonValue *time = frame.find("time"), *camera = frame.find("camera");
    all_or_none(time != nullptr, i, files_.times.size(), "time", place);
    if (time != nullptr) {
      const double seconds = number_of(*time, place + ".time");
      if (!files_.times.empty() && !(seconds > files_.times.back()))
        refuse("is not later than that of the frame before", place + ".time");
      files_.times.push_back(seconds);
    }
    all_or_none(camera != nullptr, i, files_.cameras.size(), "camera", place);
    if (camera != nullptr) files_.cameras.push_back(read_camera(*camera, lens_, place + ".camera"));
  }

  static void all_or_none(bool has, std::size_t frame, std::size_t those_that_have,
                          const char* what, const std::string& place) {
    if (frame == 0 || has == (those_that_have == frame)) return;
    refuse(std::string("either every frame has a ") + what + ", or none", place);
  }

  const JsonValue& root_;
  const SceneFile& from_;
  SequenceFiles files_;
  Lens lens_;
};

}  // namespace

SequenceFiles read_sequence_json(const Bytes& file, const SceneFile& from) {
  return SequenceReader(JsonDocument(file).root(), from).read();
}

}  // namespace raysheaf::io
