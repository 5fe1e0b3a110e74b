// A camera that fills an image with a scene, and lights for scenes without lights.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "base/trigonometry.h"
#include "base/vec.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/studio.h"
#include "scene/flatten_body.h"
#include "scene/studio_places.h"
#include "scene/subject.h"

namespace raysheaf {
namespace {

using FineVec3 = std::array<double, 3>;

/// The fraction of the image's width or height that a model may fill.
constexpr double kFilledPart = 0.92;

FineVec3 in_double(Vec3 v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}
Vec3 in_float(const FineVec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
double dot3(const FineVec3& a, const FineVec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// a + s b.
FineVec3 moved_along(const FineVec3& a, double s, const FineVec3& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
FineVec3 cross3(const FineVec3& a, const FineVec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
FineVec3 unit3(const FineVec3& v) {
  const double n = std::sqrt(dot3(v, v));
  return {v[0] / n, v[1] / n, v[2] / n};
}

/// The directions right, up and back of a camera whose back is along `back`.
std::array<FineVec3, 3> axes_from(const FineVec3& back, const FineVec3& up) {
  const FineVec3 right = unit3(cross3(up, back));
  return {right, cross3(back, right), back};
}

/// The directions of the model's right side, up and front.
std::array<FineVec3, 3> model_axes(UpAxis up) {
  switch (up) {
    case UpAxis::kX:
      return {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
    case UpAxis::kZ:
      return {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}};
    case UpAxis::kMinusX:
      return {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}};
    case UpAxis::kMinusY:
      return {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}};
    case UpAxis::kMinusZ:
      return {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
    case UpAxis::kY:
      break;
  }
  return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/// The direction to the eye, and up in the image, along `model_axes`.
struct Sight {
  FineVec3 back, up{0, 1, 0};
};
Sight sight_of(const std::optional<ViewSide>& view) {
  if (!view) return {{0.6, 0.45, 1}};
  switch (*view) {
    case ViewSide::kFront:
      return {{0, 0, 1}};
    case ViewSide::kBack:
      return {{0, 0, -1}};
    case ViewSide::kLeft:
      return {{-1, 0, 0}};
    case ViewSide::kRight:
      return {{1, 0, 0}};
    case ViewSide::kTop:
      return {{0, 1, 0}, {0, 0, -1}};
    case ViewSide::kBottom:
      return {{0, -1, 0}, {0, 0, 1}};
    case ViewSide::kIso:
      break;
  }
  return {{1, 1, 1}};
}

std::array<FineVec3, 3> viewing_axes(const Viewpoint& viewpoint) {
  const std::array<FineVec3, 3> model = model_axes(viewpoint.up);
  const auto in_world = [&](const FineVec3& v) {
    FineVec3 sum{0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i) sum = moved_along(sum, v[i], model[i]);
    return sum;
  };
  const Sight sight = sight_of(viewpoint.view);
  return axes_from(unit3(in_world(sight.back)), in_world(sight.up));
}

Affine camera_frame_at(const std::array<FineVec3, 3>& axes, const FineVec3& eye) {
  const Vec3 x = in_float(axes[0]), y = in_float(axes[1]), z = in_float(axes[2]);
  const Vec3 at = in_float(eye);
  Affine a;
  a.m[0] = {x.x, y.x, z.x, at.x};
  a.m[1] = {x.y, y.y, z.y, at.y};
  a.m[2] = {x.z, y.z, z.z, at.z};
  return a;
}

/// The directions that limit a view: with x, y, z along right, up and back, and t the tangent of
/// half an angle of view, a point p is in the view of an eye e if
///
///   |x_p - x_e| <= t_x (z_e - z_p)     that is     (+-x + t_x z) of p  <=  (+-x + t_x z) of e
///
/// and the same along y. The strongest limits follow from the farthest points along each direction.
/// An orthographic view is the case t = 0.
std::array<FineVec3, 6> limits(const std::array<FineVec3, 3>& axes, double tan_x, double tan_y) {
  const FineVec3 &right = axes[0], &up = axes[1], &back = axes[2];
  const auto along = [&](const FineVec3& axis, double sign, double t) {
    FineVec3 sum{0, 0, 0};
    return moved_along(moved_along(sum, sign, axis), t, back);
  };
  return {along(right, 1, tan_x), along(right, -1, tan_x), along(up, 1, tan_y),
          along(up, -1, tan_y),   along(back, 1, 0),       along(back, -1, 0)};
}

}  // namespace

ViewFit::Reach::Reach() {
  along.fill(-std::numeric_limits<double>::infinity());
}

ViewFit::ViewFit(const Viewpoint& viewpoint) : viewpoint_(viewpoint) {
  validate(viewpoint);
  const double tan_half = portable::tangent(double{viewpoint.fov.value_or(kFramingFov)} / 2);
  tan_y_ = viewpoint.orthographic ? 0 : kFilledPart * tan_half;
  tan_x_ = tan_y_ * viewpoint.aspect_ratio;
  axes_ = viewing_axes(viewpoint);
  limits_ = limits(axes_, tan_x_, tan_y_);
}

void ViewFit::enlarge(Reach* reach, Vec3 point) const {
  reach->box.min = min(reach->box.min, point);
  reach->box.max = max(reach->box.max, point);
  const FineVec3 p = in_double(point);
  for (std::size_t i = 0; i < limits_.size(); ++i)
    reach->along[i] = std::max(reach->along[i], dot3(limits_[i], p));
}

void ViewFit::add(const std::array<Vec3, 3>& triangle) {
  const bool shows = !has_no_area(triangle[0], triangle[1], triangle[2]);
  for (const Vec3 p : triangle) enlarge(shows ? &with_area_ : &all_, p);
}

void ViewFit::add(const SceneDescription& scene) {
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& t : mesh.triangles) {
      if (std::max({t[0], t[1], t[2]}) >= mesh.positions.size()) continue;
      add({transform_point(instance.to_world, mesh.positions[t[0]]),
           transform_point(instance.to_world, mesh.positions[t[1]]),
           transform_point(instance.to_world, mesh.positions[t[2]])});
    }
  }
}

void ViewFit::add(const Box& box) {
  if (!(box.min.x <= box.max.x)) return;
  for (const Vec3 p : corners_of(box)) enlarge(&with_area_, p);
}

const Box& ViewFit::bounds() const {
  return with_area_.box.min.x <= with_area_.box.max.x ? with_area_.box : all_.box;
}

/// Each corner of the box moves on a circle. From its centre, the circle extends along a direction
/// d by the radius times the part of d that lies in the circle's plane.
ViewFit::Reach ViewFit::turned(const Reach& reach) const {
  Reach around;
  around.box = reach.box;
  const FineVec3 axis = in_double(direction_of(viewpoint_.up));
  const FineVec3 center = in_double(subject_of(reach.box).center);
  for (const Vec3 corner : corners_of(reach.box)) {
    const FineVec3 spoke = moved_along(in_double(corner), -1, center);
    const double height = dot3(spoke, axis);
    const FineVec3 level = moved_along(spoke, -height, axis);
    const double radius = std::sqrt(dot3(level, level));
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      const double slope = dot3(limits_[i], axis);
      const FineVec3 flat = moved_along(limits_[i], -slope, axis);
      around.along[i] = std::max(around.along[i], dot3(limits_[i], center) + height * slope +
                                                      radius * std::sqrt(dot3(flat, flat)));
    }
  }
  return around;
}

Camera ViewFit::camera() const {
  Camera camera;
  Reach reach = with_area_.box.min.x <= with_area_.box.max.x ? with_area_ : all_;
  const Subject subject = subject_of(reach.box);
  // The scene is empty or unbounded: the camera looks at a sphere around the origin.
  if (!(length(reach.box.max - reach.box.min) <= 4 * subject.radius)) {
    reach = Reach();
    const Vec3 r{subject.radius, subject.radius, subject.radius};
    for (const Vec3 p : corners_of({subject.center - r, subject.center + r})) enlarge(&reach, p);
  }
  if (viewpoint_.position) {
    camera = placed(reach);
  } else {
    camera = automatic(viewpoint_.all_around ? turned(reach) : reach);
  }
  return zoomed(camera, viewpoint_.zoom);
}

Camera ViewFit::automatic(const Reach& reach) const {
  // A rod seen end-on must be in front of the eye, and not nearer than a float32 position can
  // resolve.
  constexpr double kLeastPart = 1e-4, kLeastExtent = 1e-6;
  const double radius = subject_of(reach.box).radius;
  const Vec3 far = max(abs(reach.box.min), abs(reach.box.max));
  const double least = std::max(kLeastPart * radius, kLeastExtent * double{max_component(far)});
  const auto& [right_most, left_most, up_most, down_most, near_most, far_most] = reach.along;
  const double wide = (right_most + left_most) / 2, high = (up_most + down_most) / 2;
  Camera camera;
  camera.name = "framing";
  camera.orthographic = viewpoint_.orthographic;
  camera.aspect_ratio = viewpoint_.aspect_ratio;
  camera.y_fov = viewpoint_.fov.value_or(kFramingFov);
  double z = near_most;  // of the eye
  if (viewpoint_.orthographic) {
    const double half = std::max({high, wide / viewpoint_.aspect_ratio, kLeastPart * radius});
    camera.y_mag = static_cast<float>(half / kFilledPart);
    z += 2 * radius;
  } else {
    z = std::max({wide / tan_x_, high / tan_y_, near_most + least});
  }
  const double x = (right_most - left_most) / 2, y = (up_most - down_most) / 2;
  FineVec3 eye{0, 0, 0};
  eye = moved_along(moved_along(moved_along(eye, x, axes_[0]), y, axes_[1]), z, axes_[2]);
  camera.to_world = camera_frame_at(axes_, eye);
  camera.z_near = static_cast<float>((z - near_most) / 2);
  camera.z_far = static_cast<float>((z + far_most) * 2);
  return camera;
}

Camera ViewFit::placed(const Reach& reach) const {
  const Subject subject = subject_of(reach.box);
  const FineVec3 eye = in_double(*viewpoint_.position);
  const FineVec3 back =
      moved_along(eye, -1, in_double(viewpoint_.look_at.value_or(subject.center)));
  const double distance = std::sqrt(dot3(back, back));
  if (!(distance > 0)) {
    throw Error(ErrorCode::kInvalidArgument,
                "is the middle of the model: set look_at to another point", "camera_position");
  }
  const FineVec3 up = in_double(direction_of(viewpoint_.up)), side = cross3(up, back);
  if (!(std::sqrt(dot3(side, side)) > 1e-6 * distance)) {
    throw Error(ErrorCode::kInvalidArgument, "is parallel to the viewing direction: choose another",
                "up");
  }
  const std::array<FineVec3, 3> axes = axes_from(unit3(back), up);
  double half = 1e-3 * subject.radius, nearest = std::numeric_limits<double>::infinity();
  double farthest = 0;
  for (const Vec3 corner : corners_of(reach.box)) {
    const FineVec3 p = moved_along(in_double(corner), -1, eye);
    half = std::max(
        {half, std::fabs(dot3(p, axes[1])), std::fabs(dot3(p, axes[0])) / viewpoint_.aspect_ratio});
    nearest = std::min(nearest, -dot3(p, axes[2]));
    farthest = std::max(farthest, -dot3(p, axes[2]));
  }
  Camera camera;
  camera.name = "framing";
  camera.to_world = camera_frame_at(axes, eye);
  camera.orthographic = viewpoint_.orthographic;
  camera.y_fov = viewpoint_.fov.value_or(kFramingFov);
  camera.y_mag = static_cast<float>(half / kFilledPart);
  // An eye inside the model must see surfaces close to it.
  camera.z_near = static_cast<float>(std::max(nearest / 2, 1e-4 * subject.radius));
  camera.z_far = static_cast<float>(std::max(2 * farthest, 4.0 * subject.radius));
  return camera;
}

Camera framing_camera(const SceneDescription& scene, const Viewpoint& viewpoint) {
  ViewFit fit(viewpoint);
  fit.add(scene);
  return fit.camera();
}

Camera framing_camera(const SceneDescription& scene) {
  return framing_camera(scene, Viewpoint{});
}

Sighting::Sighting(const Camera& camera)
    : near_(camera.z_near > 0 ? camera.z_near : 0),
      far_(camera.z_far),
      orthographic_(camera.orthographic) {
  eye_ = in_double(column(camera.to_world, 3));
  for (int i = 0; i < 3; ++i) axes_[i] = unit3(in_double(column(camera.to_world, i)));
  const double high = orthographic_ ? camera.y_mag : portable::tangent(camera.y_fov / 2.0);
  const double wide = high * (camera.aspect_ratio > 0 ? camera.aspect_ratio : 1);
  for (double& x : axes_[0]) x /= wide;
  for (double& x : axes_[1]) x /= high;
}

Sighting::Corner Sighting::corner_of(Vec3 point) const {
  const FineVec3 p = moved_along(in_double(point), -1, eye_);
  const double depth = -dot3(p, axes_[2]);
  return {dot3(p, axes_[0]), dot3(p, axes_[1]), orthographic_ ? 1 : depth, depth};
}

double Sighting::inside(std::size_t plane, const Corner& corner) const {
  switch (plane) {
    case 0:
      return corner.depth - near_;
    case 1:
      return far_ - corner.depth;
    case 2:
      return corner.w + corner.x;
    case 3:
      return corner.w - corner.x;
    case 4:
      return corner.w + corner.y;
    default:
      return corner.w - corner.y;
  }
}

Sighting::Polygon Sighting::clipped(const Polygon& polygon, std::size_t plane) const {
  Polygon rest;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Corner& p = polygon.corners[i];
    const Corner& q = polygon.corners[(i + 1) % polygon.count];
    const double of_p = inside(plane, p), of_q = inside(plane, q);
    if (of_p >= 0) rest.corners[rest.count++] = p;
    if ((of_p >= 0) == (of_q >= 0)) continue;
    const double part = of_p / (of_p - of_q);
    const auto between = [part](double a, double b) { return a + part * (b - a); };
    rest.corners[rest.count++] = {between(p.x, q.x), between(p.y, q.y), between(p.w, q.w),
                                  between(p.depth, q.depth)};
  }
  return rest;
}

void Sighting::add(std::span<const Vec3> corners) {
  is_empty_ = false;
  Polygon polygon;
  for (const Vec3 corner : corners) polygon.corners[polygon.count++] = corner_of(corner);
  for (std::size_t plane = 0; plane < kPlanes && polygon.count > 0; ++plane)
    polygon = clipped(polygon, plane);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Corner& p = polygon.corners[i];
    if (!(p.w > 0)) continue;  // the eye itself
    left_ = std::min(left_, p.x / p.w);
    right_ = std::max(right_, p.x / p.w);
    low_ = std::min(low_, p.y / p.w);
    top_ = std::max(top_, p.y / p.w);
  }
}

bool Sighting::spans_enough() const {
  constexpr double kLeastPart = 0.5;
  // The image reaches from -1 to 1.
  return std::max(right_ - left_, top_ - low_) >= 2 * kLeastPart;
}

bool shows(const Camera& camera, const SceneDescription& scene) {
  Sighting sighting(camera);
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& t : mesh.triangles) {
      if (std::max({t[0], t[1], t[2]}) >= mesh.positions.size()) continue;
      sighting.add(std::array{transform_point(instance.to_world, mesh.positions[t[0]]),
                              transform_point(instance.to_world, mesh.positions[t[1]]),
                              transform_point(instance.to_world, mesh.positions[t[2]])});
      if (sighting.spans_enough()) return true;
    }
  }
  return sighting.suffices();
}

Light showing_light(const SceneDescription& scene, const Camera& camera) {
  const Subject subject = subject_of(world_bounds(scene));
  const Vec3 eye = column(camera.to_world, 3);
  const float distance = length(eye - subject.center);
  // A camera inside the scene may be close to a wall: there the light stays close to the camera.
  const float offset = distance > subject.radius ? 0.5f * distance : 0.05f * subject.radius;
  const Vec3 up = normalized(column(camera.to_world, 1), {0, 1, 0});
  const Vec3 left = -normalized(column(camera.to_world, 0), {1, 0, 0});
  Light light;
  light.name = "showing";
  light.position = eye + (up + left * 0.7f) * offset;
  // White that faces the light at the scene's centre has a radiance of 1: intensity / (pi d^2).
  const float reach = std::max(length(light.position - subject.center), 0.5f * subject.radius);
  const float intensity = std::numbers::pi_v<float> * reach * reach;
  light.intensity = {intensity, intensity, intensity};
  return light;
}

namespace {

constexpr const char* kKeyLight = "studio key";
constexpr const char* kFillLight = "studio fill";
constexpr const char* kRimLight = "studio rim";
constexpr const char* kInnerLight = "studio";

}  // namespace

std::vector<Light> studio_lights(const SceneDescription& scene, const Camera& camera) {
  const Box box = world_bounds(scene);
  const Vec3 eye = column(camera.to_world, 3);
  if (!camera.orthographic && max(box.min, eye) == eye && min(box.max, eye) == eye) {
    Light light = showing_light(scene, camera);
    light.name = kInnerLight;
    return {light};
  }
  const auto from = [&](const char* name, Vec3 place, float white) {
    Light light;
    light.name = name;
    light.type = Light::Type::kDirectional;
    light.direction = -normalized(transform_vector(camera.to_world, place));
    // White that faces the light has this radiance.
    const float lux = std::numbers::pi_v<float> * white;
    light.intensity = {lux, lux, lux};
    return light;
  };
  return {from(kKeyLight, kKeyPlace, 1), from(kFillLight, kFillPlace, 0.25f),
          from(kRimLight, kRimPlace, 0.8f)};
}

bool has_studio_lights(const SceneDescription& scene) {
  const auto is_ours = [](const Light& light) {
    const std::string_view name = light.name;
    return name == kKeyLight || name == kFillLight || name == kRimLight || name == kInnerLight;
  };
  return scene.environment.empty() && !scene.lights.empty() &&
         std::all_of(scene.lights.begin(), scene.lights.end(), is_ours);
}

bool needs_light(const SceneDescription& scene) {
  if (!scene.lights.empty() || !scene.environment.empty()) return false;
  const auto unlit = [](const Material& material) { return material.unlit; };
  return scene.materials.empty() ||
         !std::all_of(scene.materials.begin(), scene.materials.end(), unlit);
}

void add_missing_camera_and_light(SceneDescription& scene) {
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (needs_light(scene)) scene.lights = studio_lights(scene, scene.cameras.front());
}

}  // namespace raysheaf
