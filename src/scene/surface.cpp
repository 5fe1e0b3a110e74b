#include "scene/surface.h"

#include <optional>

#include "scene/material_of.h"
#include "scene/surface_body.h"

namespace raysheaf {
namespace {

Vec3 rgb(Vec4 color) {
  return {color.x, color.y, color.z};
}

/// Which triangle of which mesh.
struct Place {
  const FlatMesh& flat;
  const Instance& instance;
  const Mesh& mesh;
  std::uint32_t prim_id;
  float u, v;

  template <class T>
  [[nodiscard]] T mixed(const std::vector<T>& of_vertex) const {
    const auto& corner = mesh.triangles[prim_id];
    return of_vertex[corner[0]] * (1 - u - v) + of_vertex[corner[1]] * u + of_vertex[corner[2]] * v;
  }
};

/// Unit, on the front side: counter-clockwise, clockwise where the instance mirrors.
Vec3 front_normal(const Vec3 (&corner)[3], bool mirrored, Vec3 fallback) {
  const Wide along = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
  const Vec3 normal = unit(along, mirrored ? -fallback : fallback);
  return mirrored ? -normal : normal;
}

void set_geometry(Surface& surface, const FlatScene& scene, std::uint32_t triangle,
                  const Place& place, Vec3 direction) {
  const Vec3 corner[3] = {scene.corner(triangle, 0), scene.corner(triangle, 1),
                          scene.corner(triangle, 2)};
  const MixedPoint point = mixed_point(corner[0], corner[1], corner[2], place.u, place.v);
  surface.position = point.position;
  surface.position_error = point.error;
  const Vec3 front =
      front_normal(corner, place.flat.mirrored, unit(widened(-direction), {0, 0, 1}));
  surface.front = !(dot(widened(front), widened(direction)) > 0);
  const Vec3 shading =
      place.mesh.normals.empty()
          ? front
          : unit_normal(place.instance.to_world, place.mixed(place.mesh.normals), front);
  surface.geometric_normal = surface.front ? front : -front;
  surface.normal = surface.front ? shading : -shading;
}

/// The textures at a place. They need coordinates: a mesh without them shows the factors alone.
class Look {
 public:
  Look(const TextureSet& textures, const Place& place) : textures_(textures) {
    if (!place.mesh.uvs.empty()) uv_ = place.mixed(place.mesh.uvs);
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

Surface surface_at(const FlatScene& scene, const TextureSet& textures, std::uint32_t triangle,
                   float u, float v, Vec3 direction) {
  const FlatMesh& flat = scene.meshes[scene.mesh_of_triangle[triangle]];
  const SceneDescription& description = *scene.description;
  const Place place{flat,
                    description.instances[flat.inst_id],
                    description.meshes[flat.geom_id],
                    triangle - flat.first_triangle,
                    u,
                    v};
  Surface surface;
  set_geometry(surface, scene, triangle, place, direction);
  surface.material = material_of(place.mesh, place.prim_id);
  set_material(surface, material_or_default(description, surface.material), Look(textures, place));
  return surface;
}

}  // namespace raysheaf
