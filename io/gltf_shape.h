// What changes a mesh's shape, gathered with its vertices: joints, weights and morph targets.
#pragma once

#include <string>
#include <vector>

#include "io/gltf.h"

namespace raysheaf::io {

/// The accessors of what changes a primitive's shape.
struct ShapeSource {
  std::vector<int> joints;   ///< JOINTS_0, WEIGHTS_0, JOINTS_1, ...
  std::vector<int> targets;  ///< POSITION and NORMAL of each target; -1: none
};

class ShapeReader {
 public:
  /// `joint_count`: of the skin; 0: there is none.
  ShapeReader(AccessorReader& accessors, std::size_t joint_count, Warnings& warnings)
      : accessors_(accessors), joint_count_(joint_count), warnings_(warnings) {}

  /// Throws where the skin finds no joints, or where primitives have targets of unequal number.
  [[nodiscard]] ShapeSource source(const JsonValue& primitive, const std::string& place);
  /// Of `count` vertices from `base` on, which are the last.
  void read(const ShapeSource& source, std::size_t base, std::size_t count, bool normals,
            const std::string& place);
  /// The next vertex moves as vertex `v` does.
  void repeat(std::uint32_t v);
  /// The triangle's normals are those of its plane.
  void add_flat(std::uint32_t triangle) { shape_.flat_triangles.push_back(triangle); }

  /// The shape of the finished mesh; one without targets and joints where nothing changes it.
  [[nodiscard]] RigShape take(const Mesh& mesh);

 private:
  void read_joints(const ShapeSource& source, std::size_t base, std::size_t count,
                   const std::string& place);
  void check_joint(float joint, float weight, const std::string& place, std::size_t set,
                   std::size_t vertex) const;
  void widen(std::uint32_t joints_per_vertex);
  /// What such vertices take beside the mesh.
  void charge(std::size_t vertices);

  AccessorReader& accessors_;
  const std::size_t joint_count_;
  Warnings& warnings_;
  RigShape shape_;
  bool any_primitive_ = false;
  std::string place_;  ///< of the primitive that was read last
};

}  // namespace raysheaf::io
