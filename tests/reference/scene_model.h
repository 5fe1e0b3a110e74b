// A reference model of a scene: an array of triangles with brute force queries, simple and
// single-threaded.
#pragma once

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "base/vec.h"
#include "intersect/triangle_body.h"
#include "raysheaf/scene.h"

namespace raysheaf::test {

struct ModelMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

struct ModelInstance {
  MeshId mesh = 0;
  Affine transform;
  std::uint32_t mask = 0xffffffff;
};

/// Meshes and instances by id.
struct SceneModel {
  std::map<MeshId, ModelMesh> meshes;
  std::map<InstanceId, ModelInstance> instances;

  /// All hits of a ray, sorted by (t, geom_id, inst_id, prim_id).
  [[nodiscard]] std::vector<Hit> all_hits(const Ray& ray, std::uint32_t mask = 0xffffffff) const {
    std::vector<Hit> hits;
    const RaySetup setup = make_ray_setup(ray);
    for (const auto& [id, instance] : instances) {
      if ((instance.mask & mask) == 0) continue;
      const ModelMesh& mesh = meshes.at(instance.mesh);
      for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Vec3 corner[3];
        for (int k = 0; k < 3; ++k)
          corner[k] = transform_point(instance.transform, mesh.positions[mesh.triangles[i][k]]);
        TriangleHit hit;
        if (!intersect_triangle(setup, corner[0], corner[1], corner[2], &hit)) continue;
        hits.push_back({hit.t, hit.u, hit.v, i, instance.mesh, id});
      }
    }
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
      return std::tie(a.t, a.geom_id, a.inst_id, a.prim_id) <
             std::tie(b.t, b.geom_id, b.inst_id, b.prim_id);
    });
    return hits;
  }

  [[nodiscard]] std::uint64_t triangle_count() const {
    std::uint64_t count = 0;
    for (const auto& [id, instance] : instances) count += meshes.at(instance.mesh).triangles.size();
    return count;
  }
};

}  // namespace raysheaf::test
