// Names of views and axes, and the validation of viewpoints.
#include "raysheaf/cameras.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/trigonometry.h"
#include "base/vec.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

constexpr std::array<std::string_view, 7> kViewNames{"front", "back",   "left", "right",
                                                     "top",   "bottom", "iso"};
constexpr std::array<std::string_view, 6> kAxisNames{"x", "y", "z", "-x", "-y", "-z"};

template <class Name, std::size_t kCount>
Name named(const std::array<std::string_view, kCount>& names, std::string_view name,
           const char* field) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<Name>(found - names.begin());
  std::string sentence = "'" + std::string(name) + "' is none of ";
  for (std::size_t i = 0; i < kCount; ++i) sentence += (i == 0 ? "" : ", ") + std::string(names[i]);
  throw Error(ErrorCode::kInvalidArgument, sentence, field);
}

[[noreturn]] void refuse_viewpoint(const char* field, const char* sentence) {
  throw Error(ErrorCode::kInvalidArgument, sentence, field);
}

void check_zoom(float zoom) {
  if (!(zoom > 0 && std::isfinite(zoom))) refuse_viewpoint("zoom", "must be a number above 0");
}

}  // namespace

ViewSide view_from_string(std::string_view name) {
  return named<ViewSide>(kViewNames, name, "view");
}

UpAxis up_axis_from_string(std::string_view name) {
  return named<UpAxis>(kAxisNames, name, "up");
}

Vec3 direction_of(UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return {1, 0, 0};
    case UpAxis::kZ:
      return {0, 0, 1};
    case UpAxis::kMinusX:
      return {-1, 0, 0};
    case UpAxis::kMinusY:
      return {0, -1, 0};
    case UpAxis::kMinusZ:
      return {0, 0, -1};
    case UpAxis::kY:
      break;
  }
  return {0, 1, 0};
}

void validate(const Viewpoint& v) {
  check_zoom(v.zoom);
  if (!(v.aspect_ratio > 0 && std::isfinite(v.aspect_ratio)))
    refuse_viewpoint("aspect_ratio", "must be a number above 0");
  if (v.fov && !(*v.fov > 0 && *v.fov < std::numbers::pi_v<float>))
    refuse_viewpoint("fov", "must be above 0 and below 180 degrees");
  if (v.fov && v.orthographic)
    refuse_viewpoint("fov", "has no meaning for an orthographic camera: use zoom instead");
  if (v.position && !is_finite(*v.position)) refuse_viewpoint("camera_position", "must be finite");
  if (v.look_at && !is_finite(*v.look_at)) refuse_viewpoint("look_at", "must be finite");
  if (v.view && v.position)
    refuse_viewpoint("view", "and camera_position both set the camera's position: give only one");
  if (v.look_at && !v.position)
    refuse_viewpoint("look_at", "needs camera_position: without it the camera looks at the model");
  if (v.position && v.look_at && *v.position == *v.look_at)
    refuse_viewpoint("look_at", "is the same point as camera_position");
}

Camera zoomed(Camera camera, float zoom) {
  check_zoom(zoom);
  if (zoom == 1) return camera;
  if (camera.orthographic) {
    camera.y_mag /= zoom;
  } else {
    camera.y_fov =
        static_cast<float>(2 * portable::angle_of(portable::tangent(camera.y_fov / 2.0) / zoom, 1));
  }
  const float seen = camera.orthographic
                         ? camera.y_mag
                         : static_cast<float>(portable::tangent(camera.y_fov / 2.0));
  if (seen > 0 && std::isnormal(seen)) return camera;
  refuse_viewpoint("zoom", zoom > 1 ? "is too large: nothing is seen" : "is too small");
}

}  // namespace raysheaf
