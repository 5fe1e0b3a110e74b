#include "scene/surface.h"

#include <optional>

#include "scene/material_of.h"
#include "scene/surface_body.h"

namespace raysheaf {
namespace {

Vec3 rgb(Vec4 color) {
  return {color.x, color.y, color.z};
}

/// Corners' values with the weights of a place.
template <class T>
T mixed(const T (&of_corner)[3], float u, float v) {
  return of_corner[0] * (1 - u - v) + of_corner[1] * u + of_corner[2] * v;
}

/// Unit, on the front side: counter-clockwise, clockwise where the instance mirrors. Against the
/// ray where the triangle has no area.
Vec3 front_normal(const Vec3 (&corner)[3], bool mirrored, Vec3 direction) {
  const Wide along = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
  const Vec3 normal = unit(along, {0, 0, 0});
  if (normal == Vec3{0, 0, 0}) return unit(widened(-direction), {0, 0, 1});
  return mirrored ? -normal : normal;
}

void set_geometry(Surface& surface, const SurfaceTriangle& t, float u, float v, Vec3 direction) {
  const MixedPoint point = mixed_point(t.corner[0], t.corner[1], t.corner[2], u, v);
  surface.position = point.position;
  surface.position_error = point.error;
  const Vec3 front = front_normal(t.corner, t.mirrored, direction);
  surface.front = !(dot(widened(front), widened(direction)) > 0);
  const Vec3 shading =
      t.has_normals ? unit_normal(t.to_world, mixed(t.normal, u, v), front) : front;
  surface.geometric_normal = surface.front ? front : -front;
  surface.normal = surface.front ? shading : -shading;
}

/// The textures at a place. They need coordinates: a mesh without them shows the factors alone.
class Look {
 public:
  Look(const TextureSet& textures, const SurfaceTriangle& t, float u, float v)
      : textures_(textures) {
    if (t.has_uvs) uv_ = mixed(t.uv, u, v);
  }
  [[nodiscard]] Vec3 color(const TextureSlot& slot) const {
    return uv_ ? rgb(textures_.color(slot, *uv_)) : Vec3{1, 1, 1};
  }
  [[nodiscard]] Vec3 numbers(const TextureSlot& slot) const {
    return uv_ ? rgb(textures_.numbers(slot, *uv_)) : Vec3{1, 1, 1};
  }

 private:
  const TextureSet& textures_;
  std::optional<Vec2> uv_;
};

void set_material(Surface& surface, const Material& material, const Look& look) {
  const Vec3 base = rgb(material.base_color) * look.color(material.base_color_texture);
  surface.unlit = material.unlit;
  if (material.unlit) {
    surface.emission = base;
    return;
  }
  const Vec3 rough_metal = look.numbers(material.metallic_roughness_texture);
  const float metallic = material.metallic * rough_metal.z;
  const float normal_reflectance = (material.ior - 1) / (material.ior + 1);
  const Vec3 dielectric =
      min(material.specular_color * (normal_reflectance * normal_reflectance), {1, 1, 1}) *
      material.specular;
  surface.roughness = material.roughness * rough_metal.y;
  surface.transmission = material.transmission * (1 - metallic);
  surface.transmission_color = base;
  surface.ior = material.ior >= 1 ? material.ior : 1;
  surface.diffuse = base * ((1 - metallic) * (1 - material.transmission));
  surface.specular = lerp(dielectric, base, metallic);
  surface.coat = dielectric;
  surface.emission = material.emission * look.color(material.emission_texture);
}

}  // namespace

Surface surface_of(const SceneDescription& scene, const TextureSet& textures,
                   const SurfaceTriangle& triangle, float u, float v, Vec3 direction) {
  Surface surface;
  set_geometry(surface, triangle, u, v, direction);
  surface.material = triangle.material;
  set_material(surface, material_or_default(scene, surface.material),
               Look(textures, triangle, u, v));
  return surface;
}

Surface surface_at(const FlatScene& scene, const TextureSet& textures, std::uint32_t triangle,
                   float u, float v, Vec3 direction) {
  const FlatMesh& flat = scene.meshes[scene.mesh_of_triangle[triangle]];
  const SceneDescription& description = *scene.description;
  const Mesh& mesh = description.meshes[flat.geom_id];
  const std::uint32_t prim_id = triangle - flat.first_triangle;
  SurfaceTriangle t;
  t.has_normals = !mesh.normals.empty();
  t.has_uvs = !mesh.uvs.empty();
  t.mirrored = flat.mirrored;
  t.to_world = description.instances[flat.inst_id].to_world;
  t.material = material_of(mesh, prim_id);
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = mesh.triangles[prim_id][static_cast<std::size_t>(k)];
    t.corner[k] = scene.corner(triangle, k);
    if (t.has_normals) t.normal[k] = mesh.normals[vertex];
    if (t.has_uvs) t.uv[k] = mesh.uvs[vertex];
  }
  return surface_of(description, textures, t, u, v, direction);
}

}  // namespace raysheaf
