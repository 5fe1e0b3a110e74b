#include <algorithm>
#include <cmath>
#include <limits>

#include "io/gltf.h"
#include "io/linear.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

std::string node_place(int node) {
  return "nodes[" + std::to_string(node) + "]";
}

void set_matrix(const std::vector<double>& m, const std::string& place, RigNode& node) {
  const double row = std::fabs(m[3]) + std::fabs(m[7]) + std::fabs(m[11]) + std::fabs(m[15] - 1);
  if (!(row <= 1e-6)) {
    refuse("is not affine: its last row is not 0 0 0 1", place + ".matrix");
  }
  auto& rows = node.matrix.emplace();
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) rows[r][c] = m[4 * c + r];
  }
}

RigNode rig_node(const tinygltf::Node& source, const std::string& place, std::uint32_t parent) {
  RigNode node;
  node.name = source.name;
  node.parent = parent;
  if (source.matrix.size() == 16) set_matrix(source.matrix, place, node);
  if (source.rotation.size() == 4) {
    std::copy(source.rotation.begin(), source.rotation.end(), node.rotation.begin());
    double squared = 0;
    for (const double x : source.rotation) squared += x * x;
    if (!(squared > 0) || !std::isfinite(squared)) refuse("has no length", place + ".rotation");
  }
  if (source.scale.size() == 3)
    std::copy(source.scale.begin(), source.scale.end(), node.scale.begin());
  if (source.translation.size() == 3)
    std::copy(source.translation.begin(), source.translation.end(), node.translation.begin());
  return node;
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
void read_size(const tinygltf::Light& source, Light& light) {
  if (light.type == Light::Type::kDirectional) return;
  light.radius = extra_number(source.extras, "radius");
  const float width = extra_number(source.extras, "width");
  const float height = extra_number(source.extras, "height");
  if (light.type != Light::Type::kSpot || (width == 0 && height == 0)) return;
  light.type = Light::Type::kRectangle;
  light.width = width;
  light.height = height;
}

Light read_light(const tinygltf::Model& model, std::size_t index) {
  const tinygltf::Light& source = model.lights[index];
  Light light;
  light.name = source.name;
  light.type = light_type(source.type,
                          "extensions.KHR_lights_punctual.lights[" + std::to_string(index) + "]");
  const Double3 color = source.color.size() == 3
                            ? Double3{source.color[0], source.color[1], source.color[2]}
                            : Double3{1, 1, 1};
  light.intensity = narrow(color * source.intensity);
  if (source.range > 0) light.range = static_cast<float>(source.range);
  light.inner_angle = static_cast<float>(source.spot.innerConeAngle);
  light.outer_angle = static_cast<float>(source.spot.outerConeAngle);
  read_size(source, light);
  return light;
}

Camera read_camera(const tinygltf::Model& model, std::size_t index) {
  const tinygltf::Camera& source = model.cameras[index];
  Camera camera;
  camera.name = source.name;
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

/// What hangs on a node: a mesh, a camera, a light.
void read_loads(const tinygltf::Model& model, int index, std::uint32_t place,
                SceneDescription& scene, Rig& rig, GltfNodes& nodes) {
  const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
  if (node.mesh >= 0) {
    const std::string& mesh_name = model.meshes[static_cast<std::size_t>(node.mesh)].name;
    scene.instances.push_back({node.name.empty() ? mesh_name : node.name, 0, {}});
    nodes.uses.push_back({node.mesh, node.skin, index});
    // The joints alone say where a skinned mesh is (glTF 2.0, section 3.7.3.3).
    rig.instance_nodes.push_back(node.skin >= 0 ? kInvalidId : place);
  }
  if (node.camera >= 0) {
    scene.cameras.push_back(read_camera(model, static_cast<std::size_t>(node.camera)));
    if (scene.cameras.back().name.empty()) scene.cameras.back().name = node.name;
    rig.camera_nodes.push_back(place);
  }
  if (const int light = light_of(node); light >= 0) {
    scene.lights.push_back(read_light(model, static_cast<std::size_t>(light)));
    if (scene.lights.back().name.empty()) scene.lights.back().name = node.name;
    rig.light_nodes.push_back(place);
  }
}

}  // namespace

GltfNodes read_nodes(const tinygltf::Model& model, SceneDescription& scene, Rig& rig) {
  const std::vector<int> parents = parents_of(model);
  check_cycles(parents);
  GltfNodes nodes;
  nodes.place_of.assign(model.nodes.size(), kInvalidId);
  std::vector<int> stack;
  const auto walk = [&](const std::vector<int>& roots, bool shown) {
    stack.assign(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      const auto n = static_cast<std::size_t>(index);
      const auto place = static_cast<std::uint32_t>(rig.nodes.size());
      const std::uint32_t parent =
          parents[n] < 0 ? kInvalidId : nodes.place_of[static_cast<std::size_t>(parents[n])];
      rig.nodes.push_back(rig_node(model.nodes[n], node_place(index), parent));
      nodes.place_of[n] = place;
      if (shown) read_loads(model, index, place, scene, rig, nodes);
      const std::vector<int>& children = model.nodes[n].children;
      stack.insert(stack.end(), children.rbegin(), children.rend());
    }
  };
  walk(root_nodes(model, parents), true);
  // Joints may stand outside the scene that is shown.
  std::vector<int> others;
  for (std::size_t n = 0; n < parents.size(); ++n) {
    if (parents[n] < 0 && nodes.place_of[n] == kInvalidId) others.push_back(static_cast<int>(n));
  }
  walk(others, false);
  return nodes;
}

}  // namespace raysheaf::io
