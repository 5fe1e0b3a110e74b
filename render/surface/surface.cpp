#include "render/surface/surface.h"

#include "geom/surface_body.h"
#include "render/surface/surface_reader.h"
#include "scene/material_of.h"

namespace raysheaf {
namespace {

/// The second set of coordinates is the first if the mesh has only one.
TriangleUv uv_of(const SurfaceTriangle& t) {
  TriangleUv uv;
  for (int k = 0; k < 3; ++k) {
    uv.first[k] = t.uv[k];
    uv.second[k] = t.has_second_uvs ? t.second_uv[k] : t.uv[k];
  }
  return uv;
}

}  // namespace

void SurfaceReader::hold(const FlatScene& flat, TriangleAt at) {
  if (at == at_) return;
  const bool is_other_mesh = at.mesh != at_.mesh;
  at_ = at;
  const FlatMesh& placed = flat.meshes[at.mesh];
  const Mesh& mesh = scene_.meshes[placed.geom_id];
  if (is_other_mesh) {
    has_material_ = false;  // the next mesh may have different coordinates
    t_.has_normals = !mesh.normals.empty();
    t_.has_uvs = !mesh.uvs.empty();
    t_.has_second_uvs = !mesh.second_uvs.empty();
    t_.has_colors = !mesh.colors.empty();
    t_.has_alphas = !mesh.alphas.empty();
    t_.mirrored = placed.mirrored;
    t_.to_world = scene_.instances[placed.inst_id].to_world;
    normal_map_ = normal_map(t_.to_world);
  }
  const std::array<Vec3, 3> corners = flat.corners(at);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = mesh.triangles[at.prim][k];
    t_.corner[k] = corners[k];
    if (t_.has_normals) t_.normal[k] = mesh.normals[vertex];
    if (t_.has_uvs) t_.uv[k] = mesh.uvs[vertex];
    if (t_.has_second_uvs) t_.second_uv[k] = mesh.second_uvs[vertex];
    if (t_.has_colors) t_.color[k] = mesh.colors[vertex];
    if (t_.has_alphas) t_.alpha[k] = mesh.alphas[vertex];
  }
  front_ = front_normal(t_.corner, t_.mirrored);
  hold_material(material_of(mesh, at.prim));
}

void SurfaceReader::hold(const SurfaceTriangle& triangle) {
  at_ = {};
  t_ = triangle;
  has_material_ = false;
  normal_map_ = normal_map(t_.to_world);
  front_ = front_normal(t_.corner, t_.mirrored);
  hold_material(triangle.material);
}

void SurfaceReader::hold_material(std::uint32_t material) {
  if (has_material_ && material == t_.material) return;
  t_.material = material;
  material_ = placed_material(material_or_default(scene_, material));
  has_material_ = true;
  textured_ = t_.has_uvs && !is_plain(material_);
  look_ = {};
  look_.material = material;
  if (!textured_ && !t_.has_colors) set_material(material_, {}, &look_);
}

Surface SurfaceReader::at(float u, float v, Vec3 direction) const {
  Surface surface = look_;
  const PlacedSurface placed = placed_surface(
      t_.corner, front_, t_.has_normals ? &t_.normal : nullptr, normal_map_, u, v, direction);
  surface.position = placed.position;
  surface.geometric_normal = placed.geometric_normal;
  surface.normal = placed.normal;
  surface.clearance = placed.clearance;
  surface.front = placed.front;
  if (t_.has_uvs && is_bumpy(material_))
    surface.normal =
        textured_normal(material_, textures_.table(), t_.corner, uv_of(t_), u, v, placed);
  if (!textured_ && !t_.has_colors) return surface;
  TextureColors colors;
  if (textured_) colors = texture_colors(material_, textures_.table(), mixed(uv_of(t_), u, v));
  if (t_.has_colors) colors.base = colors.base * mixed(t_.color, u, v);
  set_material(material_, colors, &surface);
  return surface;
}

float SurfaceReader::alpha_at(float u, float v) const {
  float alpha = material_.alpha;
  if (t_.has_alphas) alpha *= mixed(t_.alpha, u, v);
  if (!t_.has_uvs) return alpha;
  const TextureTable table = textures_.table();
  const PlaceUv uv = mixed(uv_of(t_), u, v);
  return alpha * look_up(table, material_.base_color_texture, table.as_is, uv).w;
}

Surface surface_of(const SceneDescription& scene, const TextureSet& textures,
                   const SurfaceTriangle& triangle, float u, float v, Vec3 direction) {
  SurfaceReader reader(scene, textures);
  reader.hold(triangle);
  return reader.at(u, v, direction);
}

Surface surface_at(const FlatScene& scene, const TextureSet& textures, std::uint32_t triangle,
                   float u, float v, Vec3 direction) {
  SurfaceReader reader(*scene.description, textures);
  reader.hold(scene, scene.at(triangle));
  return reader.at(u, v, direction);
}

}  // namespace raysheaf
