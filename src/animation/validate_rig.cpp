// Validates a rig before anything is moved by it.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "base/vec.h"
#include "raysheaf/error.h"
#include "raysheaf/rig.h"

namespace raysheaf {
namespace {

[[noreturn]] void fail(const std::string& place, const std::string& sentence) {
  throw Error(ErrorCode::kInvalidData, sentence, place);
}

std::string element(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

template <class Numbers>
void check_finite(const std::string& place, const Numbers& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i])) fail(element(place, i), "is not finite");
}

void check_vectors(const std::string& place, const std::vector<Vec3>& vectors, std::size_t count) {
  if (vectors.size() != count) {
    fail(place, "has " + std::to_string(vectors.size()) + " vectors, but the mesh has " +
                    std::to_string(count) + " vertices");
  }
  for (std::size_t i = 0; i < vectors.size(); ++i)
    if (!is_finite(vectors[i])) fail(element(place, i), "is not finite");
}

void check_index(const std::string& place, std::size_t index, std::size_t count, const char* what) {
  if (index >= count) {
    fail(place,
         "is " + std::to_string(index) + ", but there are " + std::to_string(count) + " " + what);
  }
}

void check_node(const RigNode& node, std::size_t i) {
  const std::string place = element("nodes", i);
  if (node.parent != kInvalidId && node.parent >= i)
    fail(place + ".parent",
         "is " + std::to_string(node.parent) + ", but parents must precede their children");
  check_finite(place + ".translation", node.translation);
  check_finite(place + ".rotation", node.rotation);
  check_finite(place + ".scale", node.scale);
  const auto& q = node.rotation;
  const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(squared > 0) || !std::isfinite(squared)) fail(place + ".rotation", "has no length");
  if (!node.matrix) return;
  for (const auto& row : *node.matrix) check_finite(place + ".matrix", row);
}

/// One entry for each item: a node or none.
void check_carried(const char* list, const std::vector<std::uint32_t>& nodes, std::size_t items,
                   std::size_t node_count) {
  if (nodes.size() != items) {
    fail(list, "has " + std::to_string(nodes.size()) + " entries, but the scene has " +
                   std::to_string(items));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i] != kInvalidId) check_index(element(list, i), nodes[i], node_count, "nodes");
}

void check_skin(const RigSkin& skin, std::size_t i, std::size_t node_count) {
  const std::string place = element("skins", i);
  if (skin.joints.empty()) fail(place + ".joints", "is empty");
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    check_index(element(place + ".joints", j), skin.joints[j], node_count, "nodes");
  if (skin.inverse_bind.size() != skin.joints.size()) {
    fail(place + ".inverse_bind", "has " + std::to_string(skin.inverse_bind.size()) +
                                      " matrices for " + std::to_string(skin.joints.size()) +
                                      " joints");
  }
  for (std::size_t j = 0; j < skin.inverse_bind.size(); ++j) {
    for (const auto& row : skin.inverse_bind[j].m)
      check_finite(element(place + ".inverse_bind", j), row);
  }
}

void check_pull(const RigShape& shape, const std::string& place, const RigSkin& skin) {
  const std::size_t wanted = shape.positions.size() * shape.joints_per_vertex;
  if (shape.joints_per_vertex == 0) fail(place + ".joints_per_vertex", "is 0, but there is a skin");
  if (shape.joints.size() != wanted || shape.joint_weights.size() != wanted)
    fail(place + ".joints", "there must be " + std::to_string(wanted) + " joints and weights");
  for (std::size_t i = 0; i < wanted; ++i) {
    check_index(element(place + ".joints", i), shape.joints[i], skin.joints.size(),
                "joints in the skin");
    const float weight = shape.joint_weights[i];
    if (!std::isfinite(weight) || weight < 0)
      fail(element(place + ".joint_weights", i), "is negative or not finite");
  }
}

void check_shape(const RigShape& shape, std::size_t i, const Rig& rig,
                 const SceneDescription& scene) {
  const std::string place = element("shapes", i);
  check_index(place + ".mesh", shape.mesh, scene.meshes.size(), "meshes");
  const Mesh& mesh = scene.meshes[shape.mesh];
  const std::size_t vertices = mesh.positions.size();
  check_vectors(place + ".positions", shape.positions, vertices);
  check_vectors(place + ".normals", shape.normals, mesh.normals.size());
  if (shape.weights.size() != shape.targets.size()) {
    fail(place + ".weights", "has " + std::to_string(shape.weights.size()) + " weights for " +
                                 std::to_string(shape.targets.size()) + " targets");
  }
  check_finite(place + ".weights", shape.weights);
  for (std::size_t t = 0; t < shape.targets.size(); ++t) {
    const MorphTarget& target = shape.targets[t];
    const std::string here = element(place + ".targets", t);
    if (!target.positions.empty()) check_vectors(here + ".positions", target.positions, vertices);
    if (!target.normals.empty())
      check_vectors(here + ".normals", target.normals, shape.normals.size());
  }
  if (shape.skin != kInvalidId) {
    check_index(place + ".skin", shape.skin, rig.skins.size(), "skins");
    check_pull(shape, place, rig.skins[shape.skin]);
  } else if (shape.joints_per_vertex != 0) {
    fail(place + ".joints_per_vertex", "is not 0, but there is no skin");
  }
  for (std::size_t t = 0; t < shape.flat_triangles.size(); ++t)
    check_index(element(place + ".flat_triangles", t), shape.flat_triangles[t],
                mesh.normals.empty() ? 0 : mesh.triangles.size(), "triangles with normals");
}

void check_curve(const Curve& curve, const std::string& place, std::size_t width) {
  if (curve.times.empty()) fail(place + ".times", "is empty");
  check_finite(place + ".times", curve.times);
  for (std::size_t k = 0; k < curve.times.size(); ++k) {
    if (curve.times[k] < 0) fail(element(place + ".times", k), "is negative");
    if (k > 0 && !(curve.times[k] > curve.times[k - 1])) {
      fail(element(place + ".times", k), "is " + std::to_string(curve.times[k]) +
                                             ", not later than the previous key, " +
                                             std::to_string(curve.times[k - 1]));
    }
  }
  const std::size_t a_key = curve.interpolation == Interpolation::kCubicSpline ? 3 * width : width;
  if (curve.values.size() != a_key * curve.times.size()) {
    fail(place + ".values", "has " + std::to_string(curve.values.size()) + " numbers, but " +
                                std::to_string(curve.times.size()) + " keys of " +
                                std::to_string(a_key) + " need " +
                                std::to_string(a_key * curve.times.size()));
  }
  check_finite(place + ".values", curve.values);
}

void check_channel(const RigChannel& channel, const std::string& place, const RigClip& clip,
                   const Rig& rig) {
  check_index(place + ".curve", channel.curve, clip.curves.size(), "curves");
  std::size_t width = channel.path == RigPath::kRotation ? 4 : 3;
  if (channel.path == RigPath::kWeights) {
    check_index(place + ".target", channel.target, rig.shapes.size(), "shapes");
    width = rig.shapes[channel.target].targets.size();
  } else {
    check_index(place + ".target", channel.target, rig.nodes.size(), "nodes");
    if (rig.nodes[channel.target].matrix)
      fail(place + ".target",
           element("nodes", channel.target) + " has a matrix, so no curve can drive it");
  }
  check_curve(clip.curves[channel.curve],
              place.substr(0, place.find('.')) + "." + element("curves", channel.curve), width);
}

}  // namespace

void validate(const Rig& rig, const SceneDescription& scene) {
  for (std::size_t i = 0; i < rig.nodes.size(); ++i) check_node(rig.nodes[i], i);
  if (!rig.nodes.empty() || !rig.instance_nodes.empty()) {
    check_carried("instance_nodes", rig.instance_nodes, scene.instances.size(), rig.nodes.size());
    check_carried("camera_nodes", rig.camera_nodes, scene.cameras.size(), rig.nodes.size());
    check_carried("light_nodes", rig.light_nodes, scene.lights.size(), rig.nodes.size());
  }
  for (std::size_t i = 0; i < rig.skins.size(); ++i) check_skin(rig.skins[i], i, rig.nodes.size());
  std::vector<char> shaped(scene.meshes.size(), 0);
  for (std::size_t i = 0; i < rig.shapes.size(); ++i) {
    check_shape(rig.shapes[i], i, rig, scene);
    if (std::exchange(shaped[rig.shapes[i].mesh], 1) != 0)
      fail(element("shapes", i) + ".mesh", "is also that of an earlier shape");
  }
  for (std::size_t c = 0; c < rig.clips.size(); ++c) {
    const RigClip& clip = rig.clips[c];
    std::set<std::pair<RigPath, std::uint32_t>> driven;
    for (std::size_t i = 0; i < clip.channels.size(); ++i) {
      const RigChannel& channel = clip.channels[i];
      const std::string place = element(element("clips", c) + ".channels", i);
      check_channel(channel, place, clip, rig);
      if (!driven.insert({channel.path, channel.target}).second)
        fail(place, "drives the same target as an earlier channel");
    }
  }
}

}  // namespace raysheaf
