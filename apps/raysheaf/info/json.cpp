// `raysheaf info --json`. Only this file and those named *_json.cpp include nlohmann-json.
#include <nlohmann/json.hpp>

#include <cmath>

#include "info/info.h"

namespace raysheaf::app {
namespace {

using Json = nlohmann::ordered_json;

Json array_of(const Vec3& v) {
  return Json::array({v.x, v.y, v.z});
}

// JSON has no infinity: an unlimited range, and a camera without a far plane, are null.
Json number_or_null(float value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json texture_json(const TextureSlot& slot) {
  return slot.texture == kInvalidId ? Json(nullptr) : Json(slot.texture);
}

Json mesh_json(const Mesh& mesh, std::uint64_t instances) {
  return {{"name", mesh.name},
          {"vertices", mesh.positions.size()},
          {"triangles", mesh.triangles.size()},
          {"instances", instances},
          {"normals", !mesh.normals.empty()},
          {"uvs", !mesh.uvs.empty()},
          {"colors", !mesh.colors.empty()}};
}

Json material_json(const Material& m) {
  return {{"name", m.name},
          {"base_color", Json::array({m.base_color.x, m.base_color.y, m.base_color.z})},
          {"base_color_texture", texture_json(m.base_color_texture)},
          {"metallic", m.metallic},
          {"roughness", m.roughness},
          {"transmission", m.transmission},
          {"ior", m.ior},
          {"thin", m.thin},
          {"emission", array_of(m.emission)},
          {"unlit", m.unlit},
          {"double_sided", m.double_sided}};
}

Json light_json(const Light& light) {
  return {{"name", light.name},
          {"type", type_name(light.type)},
          {"position", array_of(light.position)},
          {"direction", array_of(light.direction)},
          {"intensity", array_of(light.intensity)},
          {"range", number_or_null(light.range)},
          {"radius", light.radius},
          {"width", light.width},
          {"height", light.height}};
}

Json camera_json(const Camera& camera) {
  return {{"name", camera.name},
          {"projection", camera.orthographic ? "orthographic" : "perspective"},
          {"position", array_of(position_of(camera))},
          {"y_fov", camera.orthographic ? Json(nullptr) : Json(camera.y_fov)},
          {"y_mag", camera.orthographic ? Json(camera.y_mag) : Json(nullptr)},
          {"aspect_ratio", camera.aspect_ratio > 0 ? Json(camera.aspect_ratio) : Json(nullptr)},
          {"z_near", camera.z_near},
          {"z_far", number_or_null(camera.z_far)},
          {"aperture", camera.aperture},
          {"focus", camera.focus}};
}

Json clip_json(const ClipInfo& clip) {
  return {{"name", clip.name},
          {"start", clip.start},
          {"end", clip.end},
          {"frames", clip.frames == 0 ? Json(nullptr) : Json(clip.frames)}};
}

Json image_json(const Image& image) {
  return {{"name", image.name}, {"width", image.width}, {"height", image.height}};
}

template <typename Item, typename ToJson>
Json list(const std::vector<Item>& items, ToJson to_json) {
  Json all = Json::array();
  for (const Item& item : items) all.push_back(to_json(item));
  return all;
}

}  // namespace

std::string info_json(const SceneInfo& info) {
  const SceneDescription& scene = *info.scene;
  Json meshes = Json::array();
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    meshes.push_back(mesh_json(scene.meshes[i], info.instances_of_mesh[i]));
  }
  Json all = {{"scene", scene.name},
              {"kind", info.kind},
              {"unit", info.in_metres ? Json("m") : Json(nullptr)},
              {"triangles", info.triangles},
              {"geometry_bytes", info.geometry_bytes},
              {"image_bytes", info.image_bytes},
              {"instances", scene.instances.size()},
              {"bounds", {{"min", array_of(info.bounds.min)}, {"max", array_of(info.bounds.max)}}},
              {"meshes", std::move(meshes)},
              {"materials", list(scene.materials, material_json)},
              {"textures", scene.textures.size()},
              {"images", list(scene.images, image_json)},
              {"lights", list(scene.lights, light_json)},
              {"cameras", list(scene.cameras, camera_json)},
              {"animations", list(info.clips, clip_json)},
              {"warnings", scene.warnings},
              {"files", scene.files}};
  if (info.blocks != 0) {
    all["blocks"] = info.blocks;
    all["bytes"] = info.file_bytes;
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace raysheaf::app
