// A rig: everything that moves in a scene, as plain data. It has a tree of nodes that carry
// instances, cameras and lights; meshes that skins and morph targets deform; and curves over time
// that drive both. It follows glTF 2.0 (sections 3.6 to 3.11 and appendix C). The glTF loader fills
// it, and a program may fill it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

enum class Interpolation : std::uint8_t {
  kStep,         ///< the value of the previous key
  kLinear,       ///< linear; rotations along the great arc
  kCubicSpline,  ///< Hermite interpolation of values and tangents
};

/// Values at times. Before the first key and after the last, the nearest key's value holds.
struct Curve {
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;  ///< seconds, strictly ascending, at least one
  /// For each key as many numbers as its target has. A cubic spline has three times as many: the
  /// incoming tangent, the value, the outgoing tangent, with tangents in units per second.
  std::vector<float> values;
};

/// A transform relative to the parent's: scale, then rotation, then translation; or one matrix.
struct RigNode {
  std::string name;
  std::uint32_t parent = kInvalidId;  ///< precedes its children
  std::array<double, 3> translation{0, 0, 0};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< quaternion x, y, z, w, of any length except 0
  std::array<double, 3> scale{1, 1, 1};
  /// Three rows of four, instead of the three above; curves then cannot drive the node.
  std::optional<std::array<std::array<double, 4>, 3>> matrix;
};

/// Nodes (joints) that move vertices.
struct RigSkin {
  std::string name;
  std::vector<std::uint32_t> joints;  ///< nodes
  std::vector<Affine> inverse_bind;   ///< from the mesh to each joint at rest; one for each joint
};

/// Displacements of a mesh's vertices, multiplied by the target's weight.
struct MorphTarget {
  std::vector<Vec3> positions;  ///< one for each vertex, or empty: no vertex moves
  std::vector<Vec3> normals;    ///< one for each vertex, or empty
};

/// A mesh that changes its shape: first its targets move the vertices, then its skin.
struct RigShape {
  std::uint32_t mesh = 0;                ///< whose positions and normals are written
  std::vector<Vec3> positions, normals;  ///< at rest; normals: one for each vertex, or none
  std::vector<MorphTarget> targets;
  std::vector<float> weights;  ///< one for each target, used if no curve drives them
  /// With a skin, the transforms of the mesh's instances are not used.
  std::uint32_t skin = kInvalidId;
  std::uint32_t joints_per_vertex = 0;
  /// For each vertex: indices into `RigSkin::joints`, and the joints' weights. Weights need not sum
  /// to 1: they are divided by their sum.
  std::vector<std::uint32_t> joints;
  std::vector<float> joint_weights;
  /// Triangles with flat normals in a mesh that has vertex normals; no other triangle shares their
  /// vertices.
  std::vector<std::uint32_t> flat_triangles;
};

/// The shape of a mesh at a time, before its vertices are moved there.
struct MeshPose {
  const RigShape* shape = nullptr;  ///< stays at its address, unchanged
  std::vector<float> weights;       ///< one a target
  std::vector<Affine>
      joints;  ///< one a joint of its skin: from the mesh at rest to where instances take it up
};

enum class RigPath : std::uint8_t { kTranslation, kRotation, kScale, kWeights };

/// A curve that drives a node's transform or a shape's weights.
struct RigChannel {
  RigPath path = RigPath::kTranslation;
  std::uint32_t target = 0;  ///< a node; for weights, a shape
  std::uint32_t curve = 0;   ///< index into the clip's curves
};

/// Channels that play together.
struct RigClip {
  std::string name;
  std::vector<Curve> curves;
  std::vector<RigChannel> channels;
};

struct Rig {
  std::vector<RigNode> nodes;
  /// The node of each instance, camera and light; kInvalidId: it keeps the scene's transform.
  std::vector<std::uint32_t> instance_nodes, camera_nodes, light_nodes;
  std::vector<RigSkin> skins;
  std::vector<RigShape> shapes;
  std::vector<RigClip> clips;
};

/// Throws `Error` (kInvalidData) naming the first field with which the rig cannot move `scene`:
/// indices out of range, arrays of unequal length, numbers that are not finite, times that do not
/// ascend.
void validate(const Rig& rig, const SceneDescription& scene);

/// Brings the scene to the rig's rest pose, in which no curve drives any node.
void pose(const Rig& rig, SceneDescription& scene);

}  // namespace raysheaf
