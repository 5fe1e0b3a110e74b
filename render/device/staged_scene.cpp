#include "render/device/staged_scene.h"

#include <limits>

#include "raysheaf/error.h"
#include "scene/material_of.h"

namespace raysheaf {
namespace {

/// Where a mesh's data begin in the arrays of all meshes.
struct FirstPlaces {
  std::uint32_t index = 0, normal = 0, uv = 0, color = 0, second_uv = 0, alpha = 0, material = 0;
  std::uint32_t position = 0;
};

/// Appends the data of each mesh.
std::vector<FirstPlaces> stage_meshes(const SceneDescription& description, StagedScene* staged) {
  const auto place = [](std::size_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorCode::kUnsupported, "the meshes of this scene have 2^32 vertices or more",
                  "meshes");
    return static_cast<std::uint32_t>(count);
  };
  std::vector<FirstPlaces> places;
  places.reserve(description.meshes.size());
  std::size_t positions = 0;
  for (const Mesh& mesh : description.meshes) {
    places.push_back({place(staged->triangles.size()), place(staged->normals.size()),
                      place(staged->uvs.size()), place(staged->colors.size()),
                      place(staged->second_uvs.size()), place(staged->alphas.size()),
                      place(staged->material_numbers.size()), place(positions)});
    positions += mesh.positions.size();
    for (const auto& vertices : mesh.triangles)
      staged->triangles.push_back({{vertices[0], vertices[1], vertices[2]}});
    staged->normals.insert(staged->normals.end(), mesh.normals.begin(), mesh.normals.end());
    staged->uvs.insert(staged->uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    staged->colors.insert(staged->colors.end(), mesh.colors.begin(), mesh.colors.end());
    staged->second_uvs.insert(staged->second_uvs.end(), mesh.second_uvs.begin(),
                              mesh.second_uvs.end());
    staged->alphas.insert(staged->alphas.end(), mesh.alphas.begin(), mesh.alphas.end());
    staged->material_numbers.insert(staged->material_numbers.end(), mesh.materials.begin(),
                                    mesh.materials.end());
  }
  return places;
}

}  // namespace

StagedScene stage_scene(const FlatScene& scene) {
  const SceneDescription& description = *scene.description;
  StagedScene staged;
  const std::vector<FirstPlaces> places = stage_meshes(description, &staged);
  for (const FlatMesh& placed : scene.meshes) {
    const Mesh& mesh = description.meshes[placed.geom_id];
    const FirstPlaces& first = places[placed.geom_id];
    StagedMesh& out = staged.meshes.emplace_back();
    out.first_triangle = placed.first_triangle;
    out.first_index = first.index;
    out.first_normal = first.normal;
    out.first_uv = first.uv;
    out.first_color = first.color;
    out.first_second_uv = first.second_uv;
    out.first_alpha = first.alpha;
    out.first_material = first.material;
    out.first_position = first.position;
    out.material_count = static_cast<std::uint32_t>(mesh.materials.size());
    out.has_normals = !mesh.normals.empty();
    out.has_uvs = !mesh.uvs.empty();
    out.has_colors = !mesh.colors.empty();
    out.has_second_uvs = !mesh.second_uvs.empty();
    out.has_alphas = !mesh.alphas.empty();
    out.mirrored = placed.mirrored;
    out.normal_map = normal_map(description.instances[placed.inst_id].to_world);
  }
  for (const Material& material : description.materials)
    staged.materials.push_back(placed_material(material));
  staged.materials.push_back(placed_material(material_or_default(description, kInvalidId)));
  return staged;
}

}  // namespace raysheaf
