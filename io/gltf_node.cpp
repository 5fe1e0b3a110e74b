#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "io/gltf.h"
#include "io/gltf_json.h"
#include "io/linear.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

std::string node_place(int node) {
  return "nodes[" + std::to_string(node) + "]";
}

/// The validation rules have checked the array's length.
template <std::size_t kCount>
bool read_numbers(const JsonValue& object, const char* name, std::array<double, kCount>& numbers) {
  const auto items = object.items(name);
  for (std::size_t i = 0; i < items.size(); ++i) numbers[i] = items[i].get<double>();
  return !items.empty();
}

void set_matrix(const std::array<double, 16>& m, const std::string& place, RigNode& node) {
  const double row = std::fabs(m[3]) + std::fabs(m[7]) + std::fabs(m[11]) + std::fabs(m[15] - 1);
  if (!(row <= 1e-6)) {
    refuse("is not affine: its last row is not 0 0 0 1", place + ".matrix");
  }
  auto& rows = node.matrix.emplace();
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) rows[r][c] = m[4 * c + r];
  }
}

RigNode rig_node(const JsonValue& source, const std::string& place, std::uint32_t parent) {
  RigNode node;
  node.name = source.get("name", std::string());
  node.parent = parent;
  std::array<double, 16> matrix;
  if (read_numbers(source, "matrix", matrix)) {
    set_matrix(matrix, place, node);
    return node;
  }
  if (read_numbers(source, "rotation", node.rotation)) {
    double squared = 0;
    for (const double x : node.rotation) squared += x * x;
    if (!(squared > 0) || !std::isfinite(squared)) refuse("has no length", place + ".rotation");
  }
  read_numbers(source, "scale", node.scale);
  read_numbers(source, "translation", node.translation);
  return node;
}

/// Each node's parent, or -1. Throws if a node has two parents or is its own ancestor.
std::vector<int> parents_of(std::span<const JsonValue> nodes) {
  std::vector<int> parents(nodes.size(), -1);
  for (int n = 0; n < static_cast<int>(nodes.size()); ++n) {
    for (const JsonValue& child : nodes[static_cast<std::size_t>(n)].items("children")) {
      int& parent = parents[child.get<std::size_t>()];
      if (parent >= 0) {
        refuse("the node has two parents, " + node_place(parent) + " and " + node_place(n),
               node_place(child.get<int>()));
      }
      parent = n;
    }
  }
  return parents;
}

void check_cycles(const std::vector<int>& parents) {
  // The index of the walk towards the root that visited a node first.
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

/// The roots of the scene to show. Some exporters (UniGLTF) list nodes in the scene that have a
/// parent outside it: these are detached from their parents, as viewers do.
std::vector<int> root_nodes(const GltfModel& model, std::vector<int>& parents, Warnings& warnings) {
  std::vector<int> roots;
  const auto scenes = model.list("scenes");
  if (scenes.empty()) {
    for (std::size_t n = 0; n < parents.size(); ++n) {
      if (parents[n] < 0) roots.push_back(static_cast<int>(n));
    }
    return roots;
  }
  const auto scene = model.root().get("scene", std::size_t{0});
  std::vector<bool> named(parents.size(), false);
  for (const JsonValue& item : scenes[scene].items("nodes")) {
    const int node = item.get<int>();
    if (named[static_cast<std::size_t>(node)])
      refuse(node_place(node) + " is listed twice", "scenes[" + std::to_string(scene) + "].nodes");
    named[static_cast<std::size_t>(node)] = true;
    roots.push_back(node);
  }
  // Whether the scene lists a node or one of its ancestors. Results are cached along each walk, so
  // that all walks together visit each node once.
  std::vector<std::optional<bool>> known(parents.size());
  const auto is_below_another = [&](int node) {
    std::vector<int> walk;
    bool below = false;
    for (int up = parents[static_cast<std::size_t>(node)]; up >= 0 && !below;
         up = parents[static_cast<std::size_t>(up)]) {
      const auto u = static_cast<std::size_t>(up);
      below = named[u] || known[u].value_or(false);
      if (known[u]) break;
      walk.push_back(up);
    }
    for (const int passed : walk) known[static_cast<std::size_t>(passed)] = below;
    return below;
  };
  if (std::erase_if(roots, is_below_another) != 0)
    warnings.once("The scene names nodes that are below others it names; they are shown once.");
  for (const int node : roots) {
    int& parent = parents[static_cast<std::size_t>(node)];
    if (parent >= 0)
      warnings.once(
          "The scene names nodes whose parent it does not show; they are shown without it.");
    parent = -1;
  }
  return roots;
}

Light::Type light_type(const std::string& type, const std::string& place) {
  if (type == "point") return Light::Type::kPoint;
  if (type == "spot") return Light::Type::kSpot;
  if (type == "directional") return Light::Type::kDirectional;
  refuse("is not point, spot or directional", place + ".type");
}

[[noreturn]] void refuse_number(double number, const char* must_be, const std::string& place) {
  refuse("is " + std::to_string(number) + ", but must be " + must_be, place);
}

/// A number in an object's extras, or 0 if there is none.
float extra_number(const JsonValue& object, const char* name, const std::string& place) {
  const JsonValue* extras = object.find("extras");
  const JsonValue* found = extras == nullptr ? nullptr : extras->find(name);
  const float number = found == nullptr || !found->is_number() ? 0 : found->get<float>();
  if (!(number >= 0 && std::isfinite(number)))
    refuse_number(number, "0 or more", place + ".extras." + name);
  return number;
}

/// Reads a light's size, which KHR_lights_punctual does not have: `extras.radius` of point and spot
/// lights, `extras.width` and `extras.height` (along the node's x and y) of spot lights
/// (docs/light.md).
void read_size(const JsonValue& source, const std::string& place, Light& light) {
  if (light.type == Light::Type::kDirectional) return;
  light.radius = extra_number(source, "radius", place);
  if (light.type != Light::Type::kSpot) return;
  const float width = extra_number(source, "width", place);
  const float height = extra_number(source, "height", place);
  if (width == 0 && height == 0) return;
  if (width == 0 || height == 0)
    refuse_number(0, "above 0", place + (width == 0 ? ".extras.width" : ".extras.height"));
  light.type = Light::Type::kRectangle;
  light.width = width;
  light.height = height;
}

/// A rectangular light has no cone.
void read_spot(const JsonValue& spot, const std::string& place, Light& light) {
  constexpr float kRightAngle = std::numbers::pi_v<float> / 2;
  light.inner_angle = spot.get("innerConeAngle", 0.0f);
  light.outer_angle = spot.get("outerConeAngle", kRightAngle / 2);
  if (light.type == Light::Type::kRectangle) return;
  if (!(light.outer_angle > 0 && light.outer_angle <= kRightAngle))
    refuse_number(light.outer_angle, "above 0 and at most pi/2", place + ".outerConeAngle");
  if (!(light.inner_angle >= 0 && light.inner_angle <= light.outer_angle))
    refuse_number(light.inner_angle, "from 0 to outerConeAngle", place + ".innerConeAngle");
}

Light read_punctual_light(const GltfModel& model, std::size_t index) {
  const JsonValue& source = gltf_lights(model.root())[index];
  Light light;
  light.name = source.get("name", std::string());
  const std::string place = element("extensions.KHR_lights_punctual.lights", index);
  light.type = light_type(source.at("type").get<std::string>(), place);
  std::array<double, 3> color{1, 1, 1};
  read_numbers(source, "color", color);
  for (const double part : color)
    if (part < 0) refuse("is negative", place + ".color");
  const auto intensity = source.get("intensity", 1.0);
  light.intensity = narrow(Double3{color[0], color[1], color[2]} * intensity);
  if (intensity < 0) refuse("is negative", place + ".intensity");
  const auto range = source.get("range", 0.0);
  if (range > 0) light.range = static_cast<float>(range);
  const bool has_cone = light.type == Light::Type::kSpot;
  read_size(source, place, light);
  if (has_cone) read_spot(source.at("spot"), place + ".spot", light);
  return light;
}

/// `place` is that of the lens `source`.
void read_planes(const JsonValue& source, const std::string& place, Camera& camera) {
  camera.z_near = source.at("znear").get<float>();
  const float far = source.get("zfar", 0.0f);
  camera.z_far = far > 0 ? far : std::numeric_limits<float>::infinity();
  if (camera.z_near < 0 || (camera.z_near == 0 && !camera.orthographic))
    refuse_number(camera.z_near, camera.orthographic ? "0 or more" : "above 0", place + ".znear");
  if (!(camera.z_far > camera.z_near))
    refuse_number(camera.z_far, "farther than znear", place + ".zfar");
}

Camera read_gltf_camera(const GltfModel& model, std::size_t index) {
  const JsonValue& source = model.list("cameras")[index];
  const std::string place = element("cameras", index);
  Camera camera;
  camera.name = source.get("name", std::string());
  const auto type = source.at("type").get<std::string>();
  camera.orthographic = type == "orthographic";
  const JsonValue& lens = source.at(type);
  if (camera.orthographic) {
    camera.y_mag = std::fabs(lens.at("ymag").get<float>());
    if (camera.y_mag == 0) refuse("is 0", place + ".orthographic.ymag");
    camera.aspect_ratio = std::fabs(lens.at("xmag").get<float>()) / camera.y_mag;
  } else {
    camera.y_fov = lens.at("yfov").get<float>();
    if (!(camera.y_fov > 0 && camera.y_fov < std::numbers::pi_v<float>))
      refuse_number(camera.y_fov, "between 0 and pi", place + ".perspective.yfov");
    camera.aspect_ratio = lens.get("aspectRatio", 0.0f);
  }
  if (!(camera.aspect_ratio > 0 && std::isfinite(camera.aspect_ratio))) camera.aspect_ratio = 0;
  read_planes(lens, place + "." + type, camera);
  camera.aperture = extra_number(source, "aperture", place);
  camera.focus = extra_number(source, "focus", place);
  return camera;
}

/// Reads what is attached to a node: a mesh, a camera, a light. A hidden node has only its camera.
void read_loads(const GltfModel& model, int index, std::uint32_t place, bool is_hidden,
                AccessorReader& accessors, SceneDescription& scene, Rig& rig, GltfNodes& nodes) {
  const JsonValue& node = model.list("nodes")[static_cast<std::size_t>(index)];
  const auto name = node.get("name", std::string());
  const JsonValue* const mesh = is_hidden ? nullptr : node.find("mesh");
  if (mesh != nullptr) {
    const JsonValue& shown = model.list("meshes")[mesh->get<std::size_t>()];
    const int skin = node.get("skin", -1);
    const std::string called = name.empty() ? shown.get("name", std::string()) : name;
    const auto add = [&](std::uint32_t at) {
      scene.instances.push_back({called, 0, {}});
      nodes.uses.push_back({mesh->get<int>(), skin, index});
      rig.instance_nodes.push_back(at);
    };
    std::vector<RigNode> places;
    if (skin < 0) places = instances_of_node(node, static_cast<std::size_t>(index), accessors);
    accessors.charge(std::max<std::size_t>(1, places.size()), sizeof(Instance) + called.size(),
                     node_place(index));
    for (RigNode& one : places) {
      one.parent = place;
      add(static_cast<std::uint32_t>(rig.nodes.size()));
      rig.nodes.push_back(std::move(one));
    }
    // The joints determine where a skinned mesh is, not its node (glTF 2.0, section 3.7.3.3).
    if (places.empty()) add(skin >= 0 ? kInvalidId : place);
  }
  if (const JsonValue* camera = node.find("camera")) {
    scene.cameras.push_back(read_gltf_camera(model, camera->get<std::size_t>()));
    if (scene.cameras.back().name.empty()) scene.cameras.back().name = name;
    rig.camera_nodes.push_back(place);
  }
  const JsonValue* const light = is_hidden ? nullptr : extension(node, "KHR_lights_punctual");
  if (light != nullptr) {
    scene.lights.push_back(read_punctual_light(model, light->at("light").get<std::size_t>()));
    if (scene.lights.back().name.empty()) scene.lights.back().name = name;
    rig.light_nodes.push_back(place);
  }
}

}  // namespace

GltfNodes read_nodes(const GltfModel& model, AccessorReader& accessors, SceneDescription& scene,
                     Rig& rig, Warnings& warnings) {
  const auto sources = model.list("nodes");
  std::vector<int> parents = parents_of(sources);
  check_cycles(parents);
  GltfNodes nodes;
  nodes.place_of.assign(sources.size(), kInvalidId);
  std::vector<int> stack;
  std::vector<bool> is_hidden(sources.size(), false);
  const auto walk = [&](const std::vector<int>& roots, bool shown) {
    stack.assign(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      const auto n = static_cast<std::size_t>(index);
      const auto place = static_cast<std::uint32_t>(rig.nodes.size());
      const std::uint32_t parent =
          parents[n] < 0 ? kInvalidId : nodes.place_of[static_cast<std::size_t>(parents[n])];
      rig.nodes.push_back(rig_node(sources[n], node_place(index), parent));
      nodes.place_of[n] = place;
      const JsonValue* const visibility = extension(sources[n], "KHR_node_visibility");
      is_hidden[n] = (visibility != nullptr && !visibility->get("visible", true)) ||
                     (parents[n] >= 0 && is_hidden[static_cast<std::size_t>(parents[n])]);
      if (shown) read_loads(model, index, place, is_hidden[n], accessors, scene, rig, nodes);
      const auto children = sources[n].items("children");
      for (std::size_t c = children.size(); c-- > 0;) {
        const int child = children[c].get<int>();
        if (parents[static_cast<std::size_t>(child)] == index) stack.push_back(child);
      }
    }
  };
  walk(root_nodes(model, parents, warnings), true);
  // Joints may lie outside the scene that is shown.
  std::vector<int> others;
  for (std::size_t n = 0; n < parents.size(); ++n) {
    if (parents[n] < 0 && nodes.place_of[n] == kInvalidId) others.push_back(static_cast<int>(n));
  }
  walk(others, false);
  return nodes;
}

}  // namespace raysheaf::io
