// Reads camera paths from JSON.
#include <cmath>
#include <numbers>

#include "io/file.h"
#include "io/json_text.h"
#include "io/refuse.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

using io::JsonValue;

CameraKey read_key(const JsonValue& value, const std::string& place) {
  io::require_object(value, place);
  CameraKey key;
  key.time = io::number_of(io::member_of(value, "time", place), place + ".time");
  key.position = io::vector_of(io::member_of(value, "position", place), place + ".position");
  key.look_at = io::vector_of(io::member_of(value, "look_at", place), place + ".look_at");
  if (const JsonValue* up = value.find("up")) key.up = io::vector_of(*up, place + ".up");
  if (const JsonValue* fov = value.find("fov"))
    key.y_fov = static_cast<float>(io::number_of(*fov, place + ".fov") * std::numbers::pi / 180);
  return key;
}

CameraPath read_path(const JsonValue& root) {
  io::require_object(root, "JSON root");
  CameraPath path;
  if (const JsonValue* smooth = root.find("smooth")) {
    if (!smooth->is_boolean())
      throw Error(ErrorCode::kInvalidData, "is not true or false", "smooth");
    path.smooth = smooth->get<bool>();
  }
  const JsonValue& keys = io::member_of(root, "keys", "");
  if (!keys.is_array()) throw Error(ErrorCode::kInvalidData, "is not an array", "keys");
  const auto items = keys.items();
  for (std::size_t k = 0; k < items.size(); ++k)
    path.keys.push_back(read_key(items[k], "keys[" + std::to_string(k) + "]"));
  try {
    validate(path);
  } catch (const Error& error) {
    // The file's field is called "fov", not "y_fov", and holds degrees.
    std::string place = error.place();
    const std::size_t fov = place.find(".y_fov");
    if (fov != place.npos) place.replace(fov, 6, ".fov");
    throw Error(error.code(), error.sentence(), place);
  }
  return path;
}

}  // namespace

CameraPath load_camera_path(const std::string& path) {
  return io::naming(path, [&] {
    return io::within_memory(
        path, [&] { return read_path(io::JsonDocument(io::read_file(path)).root()); });
  });
}

}  // namespace raysheaf
