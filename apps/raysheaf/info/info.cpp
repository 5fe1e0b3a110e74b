#include "info/info.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "apps/support/console.h"
#include "apps/support/table.h"
#include "apps/support/values.h"

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

// Things without a name are known only by their index.
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

/// "Walk, 1.5 s".
std::string clip_text(const ClipInfo& clip) {
  std::string text = clip.name.empty() ? "" : printable(clip.name) + ", ";
  if (clip.frames > 0) text += count_text(clip.frames, "frame", "frames") + ", ";
  return text + fmt::format("{:.4g} s", clip.end - clip.start);
}

/// The first of `names`, and how many more there are.
std::string first_of(const std::vector<std::string>& names) {
  if (names.empty()) return "none";
  if (names.size() == 1) return names.front();
  return fmt::format("{}: {}, ...", names.size(), names.front());
}

std::string size_text(const SceneInfo& info) {
  const Vec3 lo = info.bounds.min, hi = info.bounds.max;
  return fmt::format("{:.4g} x {:.4g} x {:.4g} {}, from {} to {}", hi.x - lo.x, hi.y - lo.y,
                     hi.z - lo.z, info.in_metres ? "m" : "units", triple(lo), triple(hi));
}

/// "84 bytes", "12.3 kB", "1.5 MB".
std::string bytes_text(std::uint64_t bytes) {
  const std::string number = short_number(static_cast<double>(bytes));
  return number + (number.find(' ') == std::string::npos ? " bytes" : "B");
}

std::string memory_text(const SceneInfo& info) {
  if (info.blocks != 0)
    return fmt::format("{} in the file, in {}", bytes_text(info.file_bytes),
                       count_text(info.blocks, "block", "blocks"));
  std::string text = bytes_text(info.geometry_bytes) + " of geometry";
  if (info.image_bytes > 0) text += ", " + bytes_text(info.image_bytes) + " of images";
  return text;
}

std::string camera_text(const SceneDescription& scene) {
  if (scene.cameras.empty()) return "none; rendering adds one that frames the scene";
  std::vector<std::string> names;
  for (const Camera& camera : scene.cameras)
    names.push_back(camera.name.empty() ? std::string("without a name") : printable(camera.name));
  return first_of(names);
}

std::string light_text(const SceneDescription& scene) {
  if (!scene.lights.empty()) return std::to_string(scene.lights.size());
  return needs_light(scene) ? "none; rendering adds some" : "none";
}

std::string ignored_text(const SceneDescription& scene) {
  constexpr std::size_t kShown = 3;
  if (scene.warnings.empty()) return "nothing";
  std::string text = count_text(scene.warnings.size(), "warning", "warnings");
  for (std::size_t i = 0; i < std::min(scene.warnings.size(), kShown); ++i)
    text += "\n           " + printable(scene.warnings[i]);
  if (scene.warnings.size() > kShown) text += "\n           ... (--all prints all of them)";
  return text;
}

/// "glTF file"; a sequence has a pattern or a list of files.
std::string kind_of(const std::string& argument) {
  constexpr std::array<std::pair<const char*, const char*>, 7> kKinds{{{".gltf", "glTF file"},
                                                                       {".glb", "binary glTF file"},
                                                                       {".obj", "OBJ file"},
                                                                       {".ply", "PLY file"},
                                                                       {".stl", "STL file"},
                                                                       {".rsb", "block file"},
                                                                       {".json", "sequence"}}};
  if (argument.starts_with("builtin:")) return "built-in scene";
  if (argument.find_first_of("*?") != std::string::npos) return "sequence of files";
  for (const auto& [ending, kind] : kKinds)
    if (has_ending(argument, ending)) return kind;
  return "scene";
}

template <typename Item>
std::uint64_t bytes_of(const std::vector<Item>& items) {
  return items.size() * sizeof(Item);
}

std::uint64_t bytes_of(const Mesh& mesh) {
  return bytes_of(mesh.positions) + bytes_of(mesh.triangles) + bytes_of(mesh.normals) +
         bytes_of(mesh.uvs) + bytes_of(mesh.second_uvs) + bytes_of(mesh.colors) +
         bytes_of(mesh.alphas);
}

}  // namespace

SceneInfo gather_info(const SceneDescription& scene, const std::string& argument) {
  SceneInfo info;
  info.scene = &scene;
  info.kind = kind_of(argument);
  info.in_metres = has_ending(argument, ".gltf") || has_ending(argument, ".glb");
  info.triangles = scene.triangle_count();
  info.bounds = world_bounds(scene);
  for (const Mesh& mesh : scene.meshes) info.geometry_bytes += bytes_of(mesh);
  for (const Image& image : scene.images) info.image_bytes += bytes_of(image.rgba);
  info.instances_of_mesh.assign(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++info.instances_of_mesh.at(instance.mesh);
  return info;
}

SceneInfo gather_info(Animation& animation, const std::string& argument) {
  SceneInfo info = gather_info(animation.scene(), argument);
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

std::string info_summary(const SceneInfo& info) {
  const SceneDescription& scene = *info.scene;
  std::string text;
  const auto line = [&text](const char* what, const std::string& value) {
    text += fmt::format("{:<10} {}\n", what, value);
  };
  std::vector<std::string> clips;
  for (const ClipInfo& clip : info.clips) clips.push_back(clip_text(clip));
  line("scene", fmt::format("{} ({})", shown_name(scene.name), info.kind));
  line("size", size_text(info));
  line("triangles", grouped(std::to_string(info.triangles)));
  line("meshes", fmt::format("{}, {}", grouped(std::to_string(scene.meshes.size())),
                             count_text(scene.instances.size(), "instance", "instances")));
  line("materials", fmt::format("{}, {}", scene.materials.size(),
                                count_text(scene.textures.size(), "texture", "textures")));
  line("memory", memory_text(info));
  line("cameras", camera_text(scene));
  line("lights", light_text(scene));
  line("animations", first_of(clips));
  line("ignored", ignored_text(scene));
  return text;
}

std::string info_details(const SceneInfo& info) {
  const SceneDescription& scene = *info.scene;
  std::string text;
  // The number of triangles of each mesh is not known if they are in blocks.
  for (const Table& table : {info.blocks == 0 ? mesh_table(info) : Table({}), material_table(scene),
                             light_table(scene), camera_table(scene), clip_table(info)}) {
    if (!table.empty()) text += "\n" + table.text();
  }
  text += image_list(scene);
  for (const std::string& warning : scene.warnings) {
    text += "\nwarning: " + printable(warning) + "\n";
  }
  return text;
}

}  // namespace raysheaf::app
