#include "render/frame/cutouts.h"

#include <numeric>

#include "intersect/triangle_body.h"
#include "render/rays/cutout_body.h"
#include "render/surface/surface_reader.h"
#include "scene/cutout.h"
#include "scene/material_of.h"

namespace raysheaf {
namespace {

struct MaterialAt {
  std::uint32_t number;
  bool has_alphas;  ///< the mesh's vertices have alphas
};
MaterialAt material_at(const FlatScene& scene, TriangleAt at) {
  const Mesh& mesh = scene.description->meshes[scene.meshes[at.mesh].geom_id];
  return {material_of(mesh, at.prim), !mesh.alphas.empty()};
}

}  // namespace

RayBatch part_of(const RayBatch& batch, View<const std::uint32_t> places) {
  return part_of_batch(batch, [places]<class T>(const LargeVector<T>& column) {
    LargeVector<T> part(column.empty() ? 0 : places.size);
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = column[places[i]];
    return part;
  });
}

Cutouts::Cutouts(const Executor& executor, const SurfaceSource& source, bool blends)
    : executor_(executor), source_(source), blends_(blends) {
  const SceneDescription& description = *source.scene.description;
  for (const Material& material : description.materials)
    materials_.push_back(placed_material(material));
  any_ = has_cutouts(description, blends);
}

std::vector<std::uint32_t> Cutouts::cut_away(View<const Ray> rays,
                                             View<const std::uint32_t> triangles) const {
  std::vector<std::uint8_t> away(rays.size);
  executor_.for_each_block(rays.size, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    SurfaceReader reader(*source_.scene.description, source_.textures);
    for (std::size_t i = begin; i < end; ++i) {
      if (triangles[i] == kInvalidId) continue;
      const TriangleAt triangle = source_.at(triangles[i]);
      const MaterialAt at_hit = material_at(source_.scene, triangle);
      if (at_hit.number >= materials_.size()) continue;
      const PlacedMaterial& material = materials_[at_hit.number];
      if (!is_cutout(material, material.alpha, blends_, at_hit.has_alphas)) continue;
      reader.hold(source_.scene, triangle);
      const Vec3(&corner)[3] = reader.held().corner;
      const Vec2 at = clamped_barycentrics(rays[i], corner[0], corner[1], corner[2]);
      const float alpha = reader.alpha_at(at.x, at.y);
      const bool blends = blends_ || at_hit.has_alphas;
      const std::uint32_t number = source_.scene.number_of(triangle);
      away[i] = is_cut_away(material, alpha, blends, rays[i], number) ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> places;
  for (std::uint32_t i = 0; i < away.size(); ++i)
    if (away[i] != 0) places.push_back(i);
  return places;
}

void Cutouts::pass(const RayBatch& batch, const Trace& trace, View<RayHit> hits,
                   View<float> ray_tests) const {
  // The places in the batch of the rays that continue; initially all.
  std::vector<std::uint32_t> on_way(batch.rays.size());
  std::iota(on_way.begin(), on_way.end(), 0u);
  RayBatch part;
  const RayBatch* now = &batch;
  while (true) {
    std::vector<std::uint32_t> triangles;
    for (const std::uint32_t place : on_way) triangles.push_back(hits[place].triangle);
    const std::vector<std::uint32_t> away = cut_away(now->rays, triangles);
    if (away.empty()) return;
    std::vector<std::uint32_t> still;
    std::vector<float> t_min;
    for (const std::uint32_t i : away) {
      const std::uint32_t place = on_way[i];
      const float behind = just_behind(hits[place].t);
      hits[place] = {};
      if (behind > batch.rays[place].t_max) continue;  // the ray ends here
      still.push_back(place);
      t_min.push_back(behind);
    }
    if (still.empty()) return;
    part = part_of(batch, View<const std::uint32_t>(still));
    for (std::size_t i = 0; i < still.size(); ++i) part.rays[i].t_min = t_min[i];
    std::vector<float> tests(ray_tests.empty() ? 0 : still.size());
    const std::vector<RayHit> found = trace(part, tests);
    for (std::size_t i = 0; i < still.size(); ++i) {
      hits[still[i]] = found[i];
      if (!tests.empty()) ray_tests[still[i]] += tests[i];
    }
    now = &part;
    on_way = std::move(still);
  }
}

}  // namespace raysheaf
