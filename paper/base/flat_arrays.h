// The triangles of a flat scene in one array for each coordinate, for methods that read every
// triangle.
//
// A triangle without area is a point here, which no ray hits. The arrays are padded to a whole
// number of SIMD blocks with triangles that no ray hits: each is a point in a sphere of radius
// `kPaddingRadius`.
#pragma once

#include "base/aligned.h"
#include "paper/base/triangle_view.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// 53 bytes a triangle.
class FlatArrays {
 public:
  /// O(triangles).
  FlatArrays(const Executor& executor, const FlatScene& scene);
  /// Reads again the triangles of `meshes` (indices in `scene.meshes`), which have moved.
  void move(const Executor& executor, const FlatScene& scene, View<const std::uint32_t> meshes);
  [[nodiscard]] TriangleView view() const;

 private:
  void read(const Executor& executor, const TriangleSource& source, std::uint32_t first,
            std::uint32_t count);
  void pad();

  std::uint32_t count_ = 0;
  AlignedVector<float> vertex_[3][3];  ///< [corner][axis]
  AlignedVector<float> sphere_[4];     ///< centre and radius of each triangle's bounding sphere
  std::vector<std::uint8_t> flags_;
  Box bounds_;
};

}  // namespace raysheaf
