#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/gltf.h"
#include "io/linear.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

std::string node_place(int node) {
  return "nodes[" + std::to_string(node) + "]";
}

[[noreturn]] void refuse(const std::string& sentence, const std::string& place) {
  throw Error(ErrorCode::kInvalidData, sentence, place);
}

DoubleAffine from_matrix(const std::vector<double>& m, const std::string& place) {
  const double row = std::fabs(m[3]) + std::fabs(m[7]) + std::fabs(m[11]) + std::fabs(m[15] - 1);
  if (!(row <= 1e-6)) {
    refuse("is not affine: its last row is not 0 0 0 1", place + ".matrix");
  }
  DoubleAffine result;
  for (std::size_t c = 0; c < 4; ++c) result.columns[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
  return result;
}

/// The columns of the rotation by the quaternion x, y, z, w.
DoubleAffine from_quaternion(const std::vector<double>& q, const std::string& place) {
  const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(n > 0) || !std::isfinite(n)) refuse("has no length", place + ".rotation");
  const double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
  DoubleAffine result;
  result.columns[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)};
  result.columns[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
  result.columns[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
  return result;
}

DoubleAffine local_transform(const tinygltf::Node& node, const std::string& place) {
  if (node.matrix.size() == 16) return from_matrix(node.matrix, place);
  DoubleAffine result;
  if (node.rotation.size() == 4) result = from_quaternion(node.rotation, place);
  if (node.scale.size() == 3) {
    for (std::size_t c = 0; c < 3; ++c) result.columns[c] = result.columns[c] * node.scale[c];
  }
  if (node.translation.size() == 3) {
    result.columns[3] = {node.translation[0], node.translation[1], node.translation[2]};
  }
  return result;
}

/// Each node's parent, or -1. A node has one parent, and nobody is their own ancestor.
std::vector<int> parents_of(const tinygltf::Model& model) {
  const int count = static_cast<int>(model.nodes.size());
  std::vector<int> parents(model.nodes.size(), -1);
  for (int n = 0; n < count; ++n) {
    for (const int child : model.nodes[static_cast<std::size_t>(n)].children) {
      int& parent = parents[static_cast<std::size_t>(child)];
      if (parent >= 0) {
        refuse("the node has two parents, " + node_place(parent) + " and " + node_place(n),
               node_place(child));
      }
      parent = n;
    }
  }
  return parents;
}

void check_cycles(const std::vector<int>& parents) {
  // The number of the walk towards the root that came by first.
  std::vector<int> walk_of(parents.size(), -1);
  for (int start = 0; start < static_cast<int>(parents.size()); ++start) {
    int node = start;
    while (node >= 0 && walk_of[static_cast<std::size_t>(node)] < 0) {
      walk_of[static_cast<std::size_t>(node)] = start;
      node = parents[static_cast<std::size_t>(node)];
    }
    if (node >= 0 && walk_of[static_cast<std::size_t>(node)] == start) {
      refuse("the node is its own ancestor", node_place(node));
    }
  }
}

std::vector<int> root_nodes(const tinygltf::Model& model, const std::vector<int>& parents) {
  std::vector<int> roots;
  if (model.scenes.empty()) {
    for (std::size_t n = 0; n < parents.size(); ++n) {
      if (parents[n] < 0) roots.push_back(static_cast<int>(n));
    }
    return roots;
  }
  const std::size_t scene = static_cast<std::size_t>(std::max(model.defaultScene, 0));
  std::vector<bool> seen(parents.size(), false);
  for (const int node : model.scenes[scene].nodes) {
    const auto n = static_cast<std::size_t>(node);
    const std::string place = "scenes[" + std::to_string(scene) + "].nodes";
    if (parents[n] >= 0) refuse(node_place(node) + " is not a root: it has a parent", place);
    if (seen[n]) refuse(node_place(node) + " is listed twice", place);
    seen[n] = true;
    roots.push_back(node);
  }
  return roots;
}

Light::Type light_type(const std::string& type, const std::string& place) {
  if (type == "point") return Light::Type::kPoint;
  if (type == "spot") return Light::Type::kSpot;
  if (type == "directional") return Light::Type::kDirectional;
  refuse("is not point, spot or directional", place + ".type");
}

/// A number of an object's extras, or 0 where there is none.
float extra_number(const tinygltf::Value& extras, const char* name) {
  if (!extras.IsObject() || !extras.Has(name)) return 0;
  const tinygltf::Value& value = extras.Get(name);
  return value.IsNumber() ? static_cast<float>(value.GetNumberAsDouble()) : 0;
}

/// A size, which KHR_lights_punctual knows nothing of: `extras.radius` of a point or a spot,
/// `extras.width` and `extras.height` (along the node's x and y) of a spot (docs/light.md).
void read_size(const tinygltf::Light& source, const DoubleAffine& to_world, Light& light) {
  if (light.type == Light::Type::kDirectional) return;
  light.radius = extra_number(source.extras, "radius");
  const float width = extra_number(source.extras, "width");
  const float height = extra_number(source.extras, "height");
  if (light.type != Light::Type::kSpot || (width == 0 && height == 0)) return;
  light.type = Light::Type::kRectangle;
  light.width = width;
  light.height = height;
  const Double3 z = normalized(to_world.columns[2], {0, 0, 1});
  const Double3 x = to_world.columns[0] - z * dot(z, to_world.columns[0]);
  const Double3 spare = std::fabs(z.x) < 0.9 ? Double3{1, 0, 0} : Double3{0, 1, 0};
  light.right = narrow(normalized(x, normalized(spare - z * dot(z, spare), {1, 0, 0})));
}

Light read_light(const tinygltf::Model& model, std::size_t index, const DoubleAffine& to_world) {
  const tinygltf::Light& source = model.lights[index];
  Light light;
  light.name = source.name;
  light.type = light_type(source.type,
                          "extensions.KHR_lights_punctual.lights[" + std::to_string(index) + "]");
  light.position = narrow(to_world.columns[3]);
  light.direction = narrow(normalized(to_world.columns[2] * -1, {0, 0, -1}));
  const Double3 color = source.color.size() == 3
                            ? Double3{source.color[0], source.color[1], source.color[2]}
                            : Double3{1, 1, 1};
  light.intensity = narrow(color * source.intensity);
  if (source.range > 0) light.range = static_cast<float>(source.range);
  light.inner_angle = static_cast<float>(source.spot.innerConeAngle);
  light.outer_angle = static_cast<float>(source.spot.outerConeAngle);
  read_size(source, to_world, light);
  return light;
}

/// The node's frame without scale: right-handed and orthonormal, -z where the node's -z points.
Affine camera_frame(const DoubleAffine& to_world) {
  const Double3 z = normalized(to_world.columns[2], {0, 0, 1});
  const Double3 up = to_world.columns[1] - z * dot(z, to_world.columns[1]);
  const Double3 spare = std::fabs(z.y) < 0.9 ? Double3{0, 1, 0} : Double3{1, 0, 0};
  const Double3 y = normalized(up, normalized(spare - z * dot(z, spare), {0, 1, 0}));
  DoubleAffine frame;
  frame.columns = {cross(y, z), y, z, to_world.columns[3]};
  return narrow(frame);
}

Camera read_camera(const tinygltf::Model& model, std::size_t index, const DoubleAffine& to_world) {
  const tinygltf::Camera& source = model.cameras[index];
  Camera camera;
  camera.name = source.name;
  camera.to_world = camera_frame(to_world);
  camera.orthographic = source.type == "orthographic";
  double near = source.perspective.znear, far = source.perspective.zfar;
  if (camera.orthographic) {
    near = source.orthographic.znear, far = source.orthographic.zfar;
    camera.y_mag = static_cast<float>(std::fabs(source.orthographic.ymag));
  } else {
    camera.y_fov = static_cast<float>(source.perspective.yfov);
  }
  camera.aperture = extra_number(source.extras, "aperture");
  camera.focus = extra_number(source.extras, "focus");
  camera.z_near = static_cast<float>(near);
  camera.z_far = far > 0 ? static_cast<float>(far) : std::numeric_limits<float>::infinity();
  return camera;
}

int light_of(const tinygltf::Node& node) {
  const auto it = node.extensions.find("KHR_lights_punctual");
  if (it == node.extensions.end() || !it->second.Has("light")) return -1;
  return it->second.Get("light").GetNumberAsInt();
}

void read_node(const tinygltf::Model& model, const tinygltf::Node& node,
               const DoubleAffine& to_world, SceneDescription& scene, Warnings& warnings) {
  if (node.mesh >= 0) {
    const std::string& mesh_name = model.meshes[static_cast<std::size_t>(node.mesh)].name;
    scene.instances.push_back({node.name.empty() ? mesh_name : node.name,
                               static_cast<std::uint32_t>(node.mesh), narrow(to_world)});
    if (node.skin >= 0) warnings.once("Skins are left out: meshes stay in their rest pose.");
  }
  if (node.camera >= 0) {
    scene.cameras.push_back(read_camera(model, static_cast<std::size_t>(node.camera), to_world));
    if (scene.cameras.back().name.empty()) scene.cameras.back().name = node.name;
  }
  if (const int light = light_of(node); light >= 0) {
    scene.lights.push_back(read_light(model, static_cast<std::size_t>(light), to_world));
    if (scene.lights.back().name.empty()) scene.lights.back().name = node.name;
  }
}

}  // namespace

void read_nodes(const tinygltf::Model& model, SceneDescription& scene, Warnings& warnings) {
  const std::vector<int> parents = parents_of(model);
  check_cycles(parents);
  std::vector<std::pair<int, DoubleAffine>> stack;
  const auto push = [&](const std::vector<int>& nodes, const DoubleAffine& to_world) {
    for (auto n = nodes.rbegin(); n != nodes.rend(); ++n) stack.emplace_back(*n, to_world);
  };
  push(root_nodes(model, parents), DoubleAffine{});
  while (!stack.empty()) {
    const auto [index, parent_to_world] = stack.back();
    stack.pop_back();
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const DoubleAffine to_world =
        compose(parent_to_world, local_transform(node, node_place(index)));
    read_node(model, node, to_world, scene, warnings);
    push(node.children, to_world);
  }
}

}  // namespace raysheaf::io
