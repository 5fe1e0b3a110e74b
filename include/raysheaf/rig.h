// What moves in a scene, as plain data: a tree of nodes that carry instances, cameras and lights,
// meshes that change their shape with skins and morph targets, and curves over time that drive
// them. As glTF 2.0 has it (sections 3.6 to 3.11 and appendix C); what the glTF loader fills, and
// what a program may fill itself.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

enum class Interpolation : std::uint8_t {
  kStep,         ///< the value of the last key
  kLinear,       ///< rotations along the great arc between them
  kCubicSpline,  ///< Hermite's, from values and tangents
};

/// Values at times. Before the first key its value holds, after the last one that one's.
struct Curve {
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;  ///< seconds, strictly ascending, one at least
  /// As many a key as what it drives has numbers; of a cubic spline three times as many: the
  /// tangent that arrives, the value, the tangent that leaves, in units a second.
  std::vector<float> values;
};

/// A place, relative to its parent's: first scaled, then rotated, then moved; or one matrix.
struct RigNode {
  std::string name;
  std::uint32_t parent = kInvalidId;  ///< stands before its children
  std::array<double, 3> translation{0, 0, 0};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< quaternion x, y, z, w, of any length but 0
  std::array<double, 3> scale{1, 1, 1};
  /// Three rows of four, in place of the three above; curves cannot drive the node then.
  std::optional<std::array<std::array<double, 4>, 3>> matrix;
};

/// Nodes that pull vertices along.
struct RigSkin {
  std::string name;
  std::vector<std::uint32_t> joints;  ///< nodes
  std::vector<Affine> inverse_bind;   ///< from the mesh to each joint at rest; one a joint
};

/// What a mesh's vertices are moved by, times the target's weight.
struct MorphTarget {
  std::vector<Vec3> positions;  ///< one a vertex, or empty: none move
  std::vector<Vec3> normals;    ///< likewise
};

/// A mesh that changes its shape: first its targets move the vertices, then its skin.
struct RigShape {
  std::uint32_t mesh = 0;                ///< whose positions and normals are written
  std::vector<Vec3> positions, normals;  ///< at rest; normals: one a vertex, or none
  std::vector<MorphTarget> targets;
  std::vector<float> weights;       ///< one a target, where no curve drives them
  std::uint32_t skin = kInvalidId;  ///< its instances have no place of their own then
  std::uint32_t joints_per_vertex = 0;
  /// Of each vertex: places in `RigSkin::joints`, and how much each pulls. They need not sum to 1:
  /// they are divided by their sum.
  std::vector<std::uint32_t> joints;
  std::vector<float> joint_weights;
  /// Triangles whose normals are those of their planes although the mesh has normals; their
  /// vertices are theirs alone.
  std::vector<std::uint32_t> flat_triangles;
};

enum class RigPath : std::uint8_t { kTranslation, kRotation, kScale, kWeights };

/// A curve drives a node's place, or a shape's weights.
struct RigChannel {
  RigPath path = RigPath::kTranslation;
  std::uint32_t target = 0;  ///< a node; of weights a shape
  std::uint32_t curve = 0;   ///< of the clip
};

/// Channels that play together.
struct RigClip {
  std::string name;
  std::vector<Curve> curves;
  std::vector<RigChannel> channels;
};

struct Rig {
  std::vector<RigNode> nodes;
  /// The node of each instance, camera and light, or kInvalidId: it stays as the scene has it.
  std::vector<std::uint32_t> instance_nodes, camera_nodes, light_nodes;
  std::vector<RigSkin> skins;
  std::vector<RigShape> shapes;
  std::vector<RigClip> clips;
};

/// Throws `Error` (kInvalidData) that names the first field with which the rig cannot move `scene`:
/// indices out of range, arrays of unequal length, numbers that are not finite, times that do not
/// ascend.
void validate(const Rig& rig, const SceneDescription& scene);

/// Brings the scene to the rig's rest: every node where it stands without a curve.
void pose(const Rig& rig, SceneDescription& scene);

}  // namespace raysheaf
