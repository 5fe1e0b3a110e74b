#include "info/info.h"

#include <fmt/format.h>

#include <numbers>

#include "console.h"
#include "table.h"

namespace raysheaf::app {
namespace {

std::string number(float value) {
  return fmt::format("{:.4g}", value);
}

std::string triple(const Vec3& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z);
}

std::string degrees(float radians) {
  return fmt::format("{:.1f}", radians * 180 / std::numbers::pi_v<float>);
}

// Unnamed things are known by their index alone.
std::string shown_name(const std::string& name) {
  return name.empty() ? "-" : printable(name);
}

Table mesh_table(const SceneInfo& info) {
  Table table({"mesh", "vertices", "triangles", "instances", "name"});
  const std::vector<Mesh>& meshes = info.scene->meshes;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    table.add({std::to_string(i), std::to_string(meshes[i].positions.size()),
               std::to_string(meshes[i].triangles.size()),
               std::to_string(info.instances_of_mesh[i]), shown_name(meshes[i].name)});
  }
  return table;
}

std::string features(const Material& material) {
  std::string words;
  const auto add = [&words](bool has, const char* word) {
    if (has) words += (words.empty() ? "" : ", ") + std::string(word);
  };
  add(material.base_color_texture.texture != kInvalidId ||
          material.metallic_roughness_texture.texture != kInvalidId ||
          material.emission_texture.texture != kInvalidId ||
          material.normal_texture.texture != kInvalidId,
      "textured");
  add(material.emission.x > 0 || material.emission.y > 0 || material.emission.z > 0, "emitting");
  add(material.alpha_blend, "blended");
  add(material.alpha_cutoff > 0 && !material.alpha_blend, "cut out");
  add(material.thin && material.transmission > 0, "thin");
  add(material.unlit, "unlit");
  add(material.double_sided, "double-sided");
  return words.empty() ? "-" : words;
}

Table material_table(const SceneDescription& scene) {
  Table table(
      {"material", "metallic", "roughness", "transmission", "ior", "base colour", "is", "name"});
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    table.add({std::to_string(i), number(m.metallic), number(m.roughness), number(m.transmission),
               number(m.ior), triple({m.base_color.x, m.base_color.y, m.base_color.z}), features(m),
               shown_name(m.name)});
  }
  return table;
}

Table light_table(const SceneDescription& scene) {
  Table table({"light", "type", "position", "direction", "intensity", "name"});
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const bool placed = light.type != Light::Type::kDirectional;
    const bool aimed = light.type != Light::Type::kPoint;
    table.add({std::to_string(i), type_name(light.type), placed ? triple(light.position) : "-",
               aimed ? triple(light.direction) : "-", triple(light.intensity),
               shown_name(light.name)});
  }
  return table;
}

Table camera_table(const SceneDescription& scene) {
  Table table({"camera", "projection", "position", "vertical view", "name"});
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    table.add({std::to_string(i), camera.orthographic ? "orthographic" : "perspective",
               triple(position_of(camera)),
               camera.orthographic ? number(2 * camera.y_mag) + " units"
                                   : degrees(camera.y_fov) + " degrees",
               shown_name(camera.name)});
  }
  return table;
}

Table clip_table(const SceneInfo& info) {
  Table table({"animation", "from s", "to s", "frames", "name"});
  for (std::size_t i = 0; i < info.clips.size(); ++i) {
    const ClipInfo& clip = info.clips[i];
    table.add({std::to_string(i), fmt::format("{:.4g}", clip.start),
               fmt::format("{:.4g}", clip.end),
               clip.frames == 0 ? "-" : std::to_string(clip.frames), shown_name(clip.name)});
  }
  return table;
}

std::string image_list(const SceneDescription& scene) {
  Table table({"image", "size", "name"});
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    const Image& image = scene.images[i];
    table.add({std::to_string(i), fmt::format("{}x{}", image.width, image.height),
               shown_name(image.name)});
  }
  return table.empty() ? "" : "\n" + table.text();
}

std::string totals(const SceneInfo& info) {
  const SceneDescription& scene = *info.scene;
  std::string text = fmt::format("scene      {}\n", shown_name(scene.name));
  const auto line = [&text](const char* what, const auto& value) {
    text += fmt::format("{:<10} {}\n", what, value);
  };
  line("triangles", info.triangles);
  if (info.blocks != 0) {
    line("blocks", info.blocks);
    line("bytes", info.file_bytes);
  }
  line("meshes", scene.meshes.size());
  line("instances", scene.instances.size());
  line("materials", scene.materials.size());
  line("textures", scene.textures.size());
  line("images", scene.images.size());
  line("lights", scene.lights.size());
  line("cameras", scene.cameras.size());
  line("bounds", triple(info.bounds.min) + " to " + triple(info.bounds.max));
  return text;
}

}  // namespace

SceneInfo gather_info(const SceneDescription& scene) {
  SceneInfo info;
  info.scene = &scene;
  info.triangles = scene.triangle_count();
  info.bounds = world_bounds(scene);
  info.instances_of_mesh.assign(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++info.instances_of_mesh.at(instance.mesh);
  return info;
}

SceneInfo gather_info(Animation& animation) {
  SceneInfo info = gather_info(animation.scene());
  for (std::uint32_t i = 0; i < animation.clips().size(); ++i) {
    animation.play(i);
    info.clips.push_back(
        {animation.clips()[i], animation.start(), animation.end(), animation.frame_times().size()});
  }
  return info;
}

const char* type_name(Light::Type type) {
  switch (type) {
    case Light::Type::kPoint:
      return "point";
    case Light::Type::kSpot:
      return "spot";
    case Light::Type::kDirectional:
      return "directional";
    case Light::Type::kRectangle:
      return "rectangle";
  }
  return "unknown";
}

Vec3 position_of(const Camera& camera) {
  const auto& rows = camera.to_world.m;
  return {rows[0][3], rows[1][3], rows[2][3]};
}

std::string info_text(const SceneInfo& info) {
  const SceneDescription& scene = *info.scene;
  std::string text = totals(info);
  // How many triangles a mesh has is not known where they are in blocks.
  for (const Table& table : {info.blocks == 0 ? mesh_table(info) : Table({}), material_table(scene),
                             light_table(scene), camera_table(scene), clip_table(info)}) {
    if (!table.empty()) text += "\n" + table.text();
  }
  text += image_list(scene);
  if (scene.cameras.empty()) text += "\nno camera: rendering adds one that frames the scene\n";
  for (const std::string& warning : scene.warnings) {
    text += "\nwarning: " + printable(warning) + "\n";
  }
  return text;
}

}  // namespace raysheaf::app
