#include "io/gltf_shape.h"

#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// A joint index and a weight.
constexpr std::size_t kJointBytes = sizeof(std::uint32_t) + sizeof(float);

}  // namespace

ShapeSource ShapeReader::source(const JsonValue& primitive, const std::string& place) {
  ShapeSource source;
  const JsonValue& attributes = primitive.at("attributes");
  for (int set = 0; joint_count_ > 0; ++set) {
    const std::string number = std::to_string(set);
    const int joints = attributes.get("JOINTS_" + number, -1);
    const int weights = attributes.get("WEIGHTS_" + number, -1);
    if (set > 0 && joints < 0 && weights < 0) break;
    if (joints < 0 || weights < 0) {
      refuse("a node shows the mesh with a skin, but there is no " +
                 std::string(joints < 0 ? "JOINTS_" : "WEIGHTS_") + number,
             place + ".attributes");
    }
    source.joints.insert(source.joints.end(), {joints, weights});
  }
  const auto targets = primitive.items("targets");
  for (const JsonValue& target : targets) {
    source.targets.insert(source.targets.end(),
                          {target.get("POSITION", -1), target.get("NORMAL", -1)});
    for (const JsonMember& member : target.members()) {
      if (member.name.starts_with("TEXCOORD"))
        warnings_.once("Texture coordinates of morph targets are left out.");
      if (member.name.starts_with("COLOR"))
        warnings_.once("Colours of morph targets are left out.");
    }
  }
  if (!any_primitive_) shape_.targets.resize(targets.size());
  any_primitive_ = true;
  if (targets.size() != shape_.targets.size()) {
    refuse("has " + std::to_string(targets.size()) + ", but the primitive before has " +
               std::to_string(shape_.targets.size()),
           place + ".targets");
  }
  return source;
}

void ShapeReader::read(const ShapeSource& source, std::size_t base, std::size_t count, bool normals,
                       const std::string& place) {
  place_ = place;
  widen(static_cast<std::uint32_t>(2 * source.joints.size()));
  charge(count);
  read_joints(source, base, count, place + ".attributes.");
  for (std::size_t t = 0; t < shape_.targets.size(); ++t) {
    const std::string target = place + ".targets[" + std::to_string(t) + "].";
    const auto append = [&](int accessor, const char* name, std::vector<Vec3>& moves) {
      moves.resize(base + count);
      if (accessor < 0) return;
      const std::vector<Vec3> values =
          as_vec3(accessors_.attribute(accessor, 3, count, target + name));
      std::copy(values.begin(), values.end(), moves.begin() + static_cast<std::ptrdiff_t>(base));
    };
    append(source.targets[2 * t], "POSITION", shape_.targets[t].positions);
    if (normals) append(source.targets[2 * t + 1], "NORMAL", shape_.targets[t].normals);
  }
}

void ShapeReader::read_joints(const ShapeSource& source, std::size_t base, std::size_t count,
                              const std::string& place) {
  if (source.joints.empty()) return;
  const std::size_t a_vertex = shape_.joints_per_vertex;
  shape_.joints.resize((base + count) * a_vertex, 0);
  shape_.joint_weights.resize((base + count) * a_vertex, 0);
  const auto named = [&place](const char* what, std::size_t set) {
    return place + what + std::to_string(set);
  };
  for (std::size_t set = 0; 2 * set < source.joints.size(); ++set) {
    const std::vector<float> joints =
        accessors_.attribute(source.joints[2 * set], 4, count, named("JOINTS_", set));
    const std::vector<float> weights =
        accessors_.attribute(source.joints[2 * set + 1], 4, count, named("WEIGHTS_", set));
    for (std::size_t i = 0; i < joints.size(); ++i) {
      check_joint(joints[i], weights[i], place, set, i / 4);
      const std::size_t to = (base + i / 4) * a_vertex + 4 * set + i % 4;
      // Joints with zero weight may have any index.
      shape_.joints[to] = weights[i] > 0 ? static_cast<std::uint32_t>(joints[i]) : 0;
      shape_.joint_weights[to] = weights[i];
    }
  }
}

void ShapeReader::check_joint(float joint, float weight, const std::string& place, std::size_t set,
                              std::size_t vertex) const {
  const std::string at = std::to_string(set) + "[" + std::to_string(vertex) + "]";
  if (weight < 0) refuse("is negative", place + "WEIGHTS_" + at);
  if (weight == 0 || (joint >= 0 && joint < static_cast<float>(joint_count_))) return;
  refuse("joint " + std::to_string(static_cast<std::int64_t>(joint)) +
             " is out of range: the skin has " + std::to_string(joint_count_) + " joints",
         place + "JOINTS_" + at);
}

void ShapeReader::widen(std::uint32_t joints_per_vertex) {
  const std::uint32_t before = shape_.joints_per_vertex;
  if (joints_per_vertex <= before) return;
  shape_.joints_per_vertex = joints_per_vertex;
  const std::size_t vertices = before == 0 ? 0 : shape_.joints.size() / before;
  accessors_.charge(vertices, kJointBytes * (joints_per_vertex - before), place_);
  std::vector<std::uint32_t> joints(vertices * joints_per_vertex, 0);
  std::vector<float> weights(joints.size(), 0);
  for (std::size_t i = 0; i < vertices * before; ++i) {
    const std::size_t to = i / before * joints_per_vertex + i % before;
    joints[to] = shape_.joints[i];
    weights[to] = shape_.joint_weights[i];
  }
  shape_.joints = std::move(joints);
  shape_.joint_weights = std::move(weights);
}

void ShapeReader::charge(std::size_t vertices) {
  if (joint_count_ == 0 && shape_.targets.empty()) return;
  constexpr std::size_t kPlaceAndNormal = 2 * sizeof(Vec3);  // in the rest pose, and in each target
  accessors_.charge(
      vertices,
      kPlaceAndNormal * (1 + shape_.targets.size()) + kJointBytes * shape_.joints_per_vertex,
      place_);
}

void ShapeReader::repeat(std::uint32_t v) {
  charge(1);
  const auto repeat_last = [](auto& values, std::size_t from) {
    const auto value = values[from];
    values.push_back(value);
  };
  for (MorphTarget& target : shape_.targets) {
    repeat_last(target.positions, v);
    if (!target.normals.empty()) repeat_last(target.normals, v);
  }
  for (std::size_t i = 0; i < shape_.joints_per_vertex; ++i) {
    repeat_last(shape_.joints, std::size_t{v} * shape_.joints_per_vertex + i);
    repeat_last(shape_.joint_weights, std::size_t{v} * shape_.joints_per_vertex + i);
  }
}

RigShape ShapeReader::take(const Mesh& mesh) {
  if (joint_count_ == 0 && shape_.targets.empty()) return {};
  shape_.positions = mesh.positions;
  shape_.normals = mesh.normals;
  return std::move(shape_);
}

}  // namespace raysheaf::io
