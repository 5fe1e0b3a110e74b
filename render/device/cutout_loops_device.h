// Loops over a batch for rays that pass through holes of materials. For sources that include a
// device.
#pragma once

#include "exec/device.h"
#include "intersect/triangle_body.h"
#include "methods/dual/dual.h"
#include "render/device/staged_scene.h"
#include "render/rays/cutout_body.h"

namespace raysheaf {

/// `SurfaceReader::alpha_at` (render/surface/surface_reader.h), and the decision based on it.
RAYSHEAF_HD inline bool staged_is_cut_away(const StagedSceneView& scene, const Ray& ray,
                                           std::uint32_t triangle, bool blends) {
  const StagedMesh& mesh = scene.meshes.data[scene.mesh_of_triangle.data[triangle]];
  const PlacedMaterial& material =
      placed_material_of(scene, staged_material(scene, mesh, triangle));
  if (!is_cutout(material, material.alpha, blends, mesh.has_alphas)) return false;
  float alpha = material.alpha;
  if (mesh.has_uvs || mesh.has_alphas) {
    const Vec3* const corner = scene.corners.data + std::uint64_t{3} * triangle;
    const Vec2 at = clamped_barycentrics(ray, corner[0], corner[1], corner[2]);
    const StagedTriangle vertices =
        scene.triangles.data[mesh.first_index + (triangle - mesh.first_triangle)];
    if (mesh.has_alphas) {
      float alphas[3];
      for (int k = 0; k < 3; ++k)
        alphas[k] = scene.alphas.data[mesh.first_alpha + vertices.vertex[k]];
      alpha *= mixed(alphas, at.x, at.y);
    }
    if (mesh.has_uvs)
      alpha *= look_up(scene.textures, material.base_color_texture, scene.textures.as_is,
                       mixed(staged_uv(scene, mesh, vertices), at.x, at.y))
                   .w;
  }
  return is_cut_away(material, alpha, blends || mesh.has_alphas, ray, triangle);
}

template <class Device>
void flag_cut_away_on(Device& device, StagedSceneView scene, bool blends, View<const Ray> rays,
                      const std::uint32_t* triangles, std::uint8_t* flags) {
  device.for_each("trace: holes", rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t triangle = triangles[i];
    flags[i] =
        triangle != kInvalidId && staged_is_cut_away(scene, rays.data[i], triangle, blends) ? 1 : 0;
  });
}

/// Rays that are still passing holes, their last hits, and their places among all rays.
struct RaysOnWay {
  View<const Ray> rays;
  const IndexedHit* hits;
  const std::uint32_t* places;
};

/// Turns hits in holes into misses in `all`, and flags the rays that continue behind them.
template <class Device>
void pass_holes_on(Device& device, StagedSceneView scene, bool blends, RaysOnWay on_way,
                   IndexedHit* all, std::uint8_t* flags) {
  device.for_each("trace: holes", on_way.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Ray ray = on_way.rays.data[i];
    const IndexedHit hit = on_way.hits[i];
    flags[i] = 0;
    if (hit.triangle == kInvalidId || !staged_is_cut_away(scene, ray, hit.triangle, blends)) return;
    all[on_way.places[i]] = IndexedHit{};
    flags[i] = just_behind(hit.t) <= ray.t_max ? 1 : 0;
  });
}

/// The rays named in `kept`, continued from behind their last hits.
template <class Device>
void rays_behind_on(Device& device, RaysOnWay on_way, View<const std::uint32_t> kept, Ray* rays,
                    std::uint32_t* places) {
  device.for_each("trace: holes", kept.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t from = kept.data[i];
    Ray ray = on_way.rays.data[from];
    ray.t_min = just_behind(on_way.hits[from].t);
    rays[i] = ray;
    places[i] = on_way.places[from];
  });
}

template <class Device>
void place_hits_on(Device& device, View<const IndexedHit> hits, const std::uint32_t* places,
                   IndexedHit* all) {
  device.for_each("trace: holes", hits.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { all[places[i]] = hits.data[i]; });
}

template <class Device>
void place_triangles_on(Device& device, View<const IndexedHit> hits, const std::uint32_t* places,
                        std::uint32_t* triangles) {
  device.for_each("trace: holes", hits.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    triangles[places[i]] = hits.data[i].triangle;
  });
}

template <class Device>
void place_occluded_on(Device& device, View<const IndexedHit> hits, const std::uint32_t* places,
                       std::uint8_t* occluded) {
  device.for_each("trace: holes", hits.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    occluded[places[i]] = hits.data[i].triangle != kInvalidId ? 1 : 0;
  });
}

}  // namespace raysheaf
