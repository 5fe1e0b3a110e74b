// Collects what deforms a mesh along with its vertices: joints, weights and morph targets.
#pragma once

#include <string>
#include <vector>

#include "io/gltf.h"

namespace raysheaf::io {

/// The accessors that deform a primitive.
struct ShapeSource {
  std::vector<int> joints;
  std::vector<int> targets;  ///< POSITION and NORMAL of each target; -1: missing
};

class ShapeReader {
 public:
  /// `joint_count` is that of the skin; 0: the mesh has no skin.
  ShapeReader(AccessorReader& accessors, std::size_t joint_count, Warnings& warnings)
      : accessors_(accessors), joint_count_(joint_count), warnings_(warnings) {}

  /// Throws if the mesh has a skin but the primitive has no joints, or if primitives have different
  /// numbers of targets.
  [[nodiscard]] ShapeSource source(const JsonValue& primitive, const std::string& place);
  /// Reads the data of the last `count` vertices, from `base` on.
  void read(const ShapeSource& source, std::size_t base, std::size_t count, bool normals,
            const std::string& place);
  /// Appends a copy of the data of vertex `v`.
  void repeat(std::uint32_t v);
  /// The triangle's normals follow its plane.
  void add_flat(std::uint32_t triangle) { shape_.flat_triangles.push_back(triangle); }

  /// The deformation data of the finished mesh; without targets and joints if nothing deforms it.
  [[nodiscard]] RigShape take(const Mesh& mesh);

 private:
  void read_joints(const ShapeSource& source, std::size_t base, std::size_t count,
                   const std::string& place);
  void check_joint(float joint, float weight, const std::string& place, std::size_t set,
                   std::size_t vertex) const;
  void widen(std::uint32_t joints_per_vertex);
  /// Charges the budget for the data of so many vertices.
  void charge(std::size_t vertices);

  AccessorReader& accessors_;
  const std::size_t joint_count_;
  Warnings& warnings_;
  RigShape shape_;
  bool any_primitive_ = false;
  std::string place_;  ///< of the primitive that was read last
};

}  // namespace raysheaf::io
