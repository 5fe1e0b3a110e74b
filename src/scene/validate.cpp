// Validates a scene before any stage uses it.
#include <cmath>
#include <numbers>
#include <string>

#include "base/vec.h"
#include "raysheaf/error.h"
#include "raysheaf/scene_changes.h"
#include "raysheaf/stream.h"
#include "scene/flat_scene.h"
#include "scene/shown_name.h"

namespace raysheaf {
namespace {

/// The place of a check in the scene. Its text is made only for an error.
struct Item {
  const char* list;
  std::size_t index;
  const std::string* name;

  [[nodiscard]] std::string path(const std::string& field) const {
    return std::string(list) + "[" + std::to_string(index) + "]" +
           (field.empty() ? "" : "." + field);
  }
  [[nodiscard]] std::string of_name() const {
    return name == nullptr ? std::string() : raysheaf::of_name(*name);
  }
  [[noreturn]] void fail(const std::string& field, const std::string& sentence) const {
    throw Error(ErrorCode::kInvalidData, sentence, path(field));
  }
};

std::string element(const char* field, std::size_t i) {
  return std::string(field) + "[" + std::to_string(i) + "]";
}
std::string element(const char* field, std::size_t i, std::size_t k) {
  return element(field, i) + "[" + std::to_string(k) + "]";
}

bool finite(float x) {
  return std::isfinite(x);
}
bool finite(Vec2 v) {
  return finite(v.x) && finite(v.y);
}
bool finite(Vec3 v) {
  return is_finite(v);
}
bool finite(const Affine& a) {
  for (const auto& row : a.m) {
    for (float x : row) {
      if (!finite(x)) return false;
    }
  }
  return true;
}

template <class T>
void check_finite(const Item& item, const char* field, const T& value) {
  if (!finite(value))
    item.fail(field, std::string("the ") + field + item.of_name() + " is not finite");
}
void check_not_negative(const Item& item, const char* field, Vec3 value) {
  check_finite(item, field, value);
  if (min_component(value) < 0)
    item.fail(field, std::string("the ") + field + item.of_name() + " is negative");
}
void check_fraction(const Item& item, const char* field, float value) {
  if (!(value >= 0 && value <= 1)) {
    item.fail(field, std::string("the ") + field + item.of_name() + " is " + std::to_string(value) +
                         ", but must be from 0 to 1");
  }
}
void check_index(const Item& item, const std::string& field, std::uint32_t value, std::size_t count,
                 const char* what) {
  if (value < count) return;
  item.fail(field, field + item.of_name() + " is " + std::to_string(value) +
                       ", but the scene has " + std::to_string(count) + " " + what);
}

template <class T>
void check_all_finite(const Item& item, const char* field, const std::vector<T>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!finite(values[i]))
      item.fail(element(field, i), element(field, i) + item.of_name() + " is not finite");
  }
}
/// One entry for each vertex, or none at all.
template <class T>
void check_attribute(const Item& item, const char* field, const Mesh& mesh,
                     const std::vector<T>& values) {
  if (!values.empty() && values.size() != mesh.positions.size()) {
    item.fail(field, "the mesh" + item.of_name() + " has " + std::to_string(values.size()) + " " +
                         field + ", but " + std::to_string(mesh.positions.size()) + " vertices");
  }
  check_all_finite(item, field, values);
}

void check_colors(const Item& item, const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.colors.size(); ++i)
    if (min_component(mesh.colors[i]) < 0)
      item.fail(element("colors", i), element("colors", i) + item.of_name() + " is negative");
}

void check_alphas(const Item& item, const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.alphas.size(); ++i) {
    if (!(mesh.alphas[i] >= 0 && mesh.alphas[i] <= 1))
      item.fail(element("alphas", i), "alpha" + item.of_name() + " is not from 0 to 1");
  }
}

void check_triangles(const Item& item, const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (mesh.triangles[i][k] < vertices) continue;
      item.fail(element("triangles", i), element("triangles", i, k) + item.of_name() + " is " +
                                             std::to_string(mesh.triangles[i][k]) +
                                             ", but the mesh has " + std::to_string(vertices) +
                                             " vertices");
    }
  }
}

void check_mesh_materials(const Item& item, const Mesh& mesh, std::size_t material_count) {
  const std::size_t count = mesh.materials.size();
  if (count > 1 && count != mesh.triangles.size()) {
    item.fail("materials", "the mesh" + item.of_name() + " has " + std::to_string(count) +
                               " material indices, but " + std::to_string(mesh.triangles.size()) +
                               " triangles");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (mesh.materials[i] < material_count || mesh.materials[i] == kInvalidId) continue;
    check_index(item, element("materials", i), mesh.materials[i], material_count, "materials");
  }
}

void check_positions(const Item& item, const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = mesh.positions[i];
    if (finite(p) && max_component(abs(p)) <= kLargestCoordinate) continue;
    const std::string field = element("positions", i);
    item.fail(field, field + item.of_name() +
                         (finite(p) ? " is farther out than 1e18" : " is not finite"));
  }
}

void check(const Item& item, const Mesh& mesh, const SceneDescription& scene) {
  check_positions(item, mesh);
  check_attribute(item, "normals", mesh, mesh.normals);
  check_attribute(item, "uvs", mesh, mesh.uvs);
  check_attribute(item, "second_uvs", mesh, mesh.second_uvs);
  if (!mesh.second_uvs.empty() && mesh.uvs.empty())
    item.fail("second_uvs", "the mesh" + item.of_name() + " has second_uvs, but no uvs");
  check_attribute(item, "colors", mesh, mesh.colors);
  check_colors(item, mesh);
  check_attribute(item, "alphas", mesh, mesh.alphas);
  check_alphas(item, mesh);
  check_triangles(item, mesh);
  check_mesh_materials(item, mesh, scene.materials.size());
}

void check(const Item& item, const Instance& instance, const SceneDescription& scene) {
  check_index(item, "mesh", instance.mesh, scene.meshes.size(), "meshes");
  check_finite(item, "to_world", instance.to_world);
}

void check_slot(const Item& item, const std::string& field, const TextureSlot& slot,
                std::size_t texture_count) {
  if (slot.texture == kInvalidId) return;
  check_index(item, field + ".texture", slot.texture, texture_count, "textures");
  if (!finite(slot.offset) || !finite(slot.scale) || !finite(slot.rotation)) {
    item.fail(field,
              "the offset, scale or rotation of the " + field + item.of_name() + " is not finite");
  }
}

void check(const Item& item, const Material& material, const SceneDescription& scene) {
  check_not_negative(item, "base_color",
                     {material.base_color.x, material.base_color.y, material.base_color.z});
  check_not_negative(item, "base_color", {material.base_color.w, 0, 0});
  check_not_negative(item, "alpha_cutoff", {material.alpha_cutoff, 0, 0});
  check_fraction(item, "metallic", material.metallic);
  check_fraction(item, "roughness", material.roughness);
  check_not_negative(item, "emission", material.emission);
  check_fraction(item, "specular", material.specular);
  check_not_negative(item, "specular_color", material.specular_color);
  check_fraction(item, "transmission", material.transmission);
  if (!finite(material.ior) || !(material.ior >= 1 || material.ior == 0)) {
    item.fail("ior", "the ior" + item.of_name() + " is " + std::to_string(material.ior) +
                         ", but must be at least 1, or 0 for a surface that reflects all");
  }
  check_slot(item, "base_color_texture", material.base_color_texture, scene.textures.size());
  check_slot(item, "metallic_roughness_texture", material.metallic_roughness_texture,
             scene.textures.size());
  check_slot(item, "emission_texture", material.emission_texture, scene.textures.size());
  check_slot(item, "normal_texture", material.normal_texture, scene.textures.size());
  if (!finite(material.normal_scale))
    item.fail("normal_scale", "the normal_scale" + item.of_name() + " is not finite");
}

void check(const Item& item, const Texture& texture, const SceneDescription& scene) {
  check_index(item, "image", texture.image, scene.images.size(), "images");
}

void check(const Item& item, const Image& image, const SceneDescription&) {
  const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height);
  if (image.width == 0 || image.height == 0)
    item.fail("width", "the image" + item.of_name() + " has " + size + " pixels");
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (image.rgba.size() % 4 != 0 || image.rgba.size() / 4 != pixels) {
    item.fail("rgba", "the image" + item.of_name() + " has " + size + " pixels, but " +
                          std::to_string(image.rgba.size()) + " bytes");
  }
}

void check_spot_angles(const Item& item, const Light& light) {
  constexpr float kRightAngle = std::numbers::pi_v<float> / 2;
  if (!(light.outer_angle > 0 && light.outer_angle <= kRightAngle)) {
    item.fail("outer_angle", "the outer angle" + item.of_name() + " is " +
                                 std::to_string(light.outer_angle) +
                                 ", but must be above 0 and at most pi/2");
  }
  if (!(light.inner_angle >= 0 && light.inner_angle <= light.outer_angle)) {
    item.fail("inner_angle",
              "the inner angle" + item.of_name() + " is " + std::to_string(light.inner_angle) +
                  ", but must be from 0 to the outer angle, " + std::to_string(light.outer_angle));
  }
}

void check_size(const Item& item, const char* field, float value, bool may_be_zero) {
  if (finite(value) && (value > 0 || (may_be_zero && value == 0))) return;
  item.fail(field, std::string("the ") + field + item.of_name() + " is " + std::to_string(value) +
                       ", but must be " + (may_be_zero ? "0 or more" : "above 0"));
}

void check_rectangle(const Item& item, const Light& light) {
  constexpr float kTolerance = 1e-3f;
  check_size(item, "width", light.width, false);
  check_size(item, "height", light.height, false);
  check_finite(item, "right", light.right);
  if (!(std::fabs(dot(light.right, light.right) - 1) <= kTolerance) ||
      !(std::fabs(dot(light.right, light.direction)) <= kTolerance)) {
    item.fail("right", "the width's direction" + item.of_name() +
                           " is not a unit vector perpendicular to the light's direction");
  }
}

void check(const Item& item, const Light& light, const SceneDescription&) {
  check_not_negative(item, "intensity", light.intensity);
  if (light.type != Light::Type::kDirectional) check_finite(item, "position", light.position);
  if (light.type != Light::Type::kPoint) {
    constexpr float kTolerance = 1e-3f;
    check_finite(item, "direction", light.direction);
    if (!(std::fabs(dot(light.direction, light.direction) - 1) <= kTolerance)) {
      item.fail("direction", "the direction" + item.of_name() + " is not a unit vector");
    }
  }
  if (light.type == Light::Type::kSpot) check_spot_angles(item, light);
  if (light.type == Light::Type::kRectangle) check_rectangle(item, light);
  check_size(item, "radius", light.radius, true);
  if (!(light.range > 0)) {
    item.fail("range", "the range" + item.of_name() + " is " + std::to_string(light.range) +
                           ", but must be above 0");
  }
}

/// Computed in double, so that the transform of a tiny scene does not count as singular.
bool singular(const Affine& a) {
  const auto m = [&](int r, int c) { return static_cast<double>(a.m[r][c]); };
  return m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1)) -
             m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0)) +
             m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0)) ==
         0;
}

void check(const Item& item, const Camera& camera, const SceneDescription&) {
  check_finite(item, "to_world", camera.to_world);
  if (singular(camera.to_world))
    item.fail("to_world", "the transform" + item.of_name() + " is flat: it has no inverse");
  if (camera.orthographic) {
    if (!(finite(camera.y_mag) && camera.y_mag > 0)) {
      item.fail("y_mag", "the height" + item.of_name() + " is " + std::to_string(camera.y_mag) +
                             ", but must be above 0");
    }
  } else if (!(camera.y_fov > 0 && camera.y_fov < std::numbers::pi_v<float>)) {
    item.fail("y_fov", "the field of view" + item.of_name() + " is " +
                           std::to_string(camera.y_fov) + ", but must be between 0 and pi");
  }
  check_size(item, "aspect_ratio", camera.aspect_ratio, true);
  const bool near_is_right = camera.orthographic ? camera.z_near >= 0 : camera.z_near > 0;
  if (!near_is_right || !finite(camera.z_near)) {
    item.fail("z_near", "the near plane" + item.of_name() + " is at " +
                            std::to_string(camera.z_near) + ", but must be in front of the camera");
  }
  if (!(camera.z_far > camera.z_near)) {
    item.fail("z_far", "the far plane" + item.of_name() + " is at " + std::to_string(camera.z_far) +
                           ", but the near one at " + std::to_string(camera.z_near));
  }
  check_size(item, "aperture", camera.aperture, true);
  check_size(item, "focus", camera.focus, true);
}

void check_environment(const Environment& environment) {
  const auto fail = [](const std::string& field, const std::string& sentence) {
    throw Error(ErrorCode::kInvalidData, sentence, "environment." + field);
  };
  const auto check_factor = [&](const char* field, float value, bool negative_too) {
    if (!finite(value) || (value < 0 && !negative_too))
      fail(field, std::string("the ") + field + " is " + std::to_string(value) + ", but must be " +
                      (negative_too ? "finite" : "0 or more"));
  };
  check_factor("intensity", environment.intensity, false);
  check_factor("rotation", environment.rotation, true);
  if (environment.empty()) return;
  const std::uint64_t pixels = std::uint64_t{environment.width} * environment.height;
  const std::string size =
      std::to_string(environment.width) + "x" + std::to_string(environment.height);
  if (environment.radiance.size() != pixels)
    fail("radiance", "the map has " + size + " pixels, but " +
                         std::to_string(environment.radiance.size()) + " values");
  for (std::size_t i = 0; i < pixels; ++i) {
    const Vec3& value = environment.radiance[i];
    if (is_finite(value) && min_component(value) >= 0) continue;
    fail("radiance", "pixel (" + std::to_string(i % environment.width) + ", " +
                         std::to_string(i / environment.width) + ") of " + size + " is " +
                         (is_finite(value) ? "negative" : "not finite"));
  }
}

template <class T>
void check_item(const char* list, const std::vector<T>& items, std::size_t i,
                const SceneDescription& scene) {
  const std::string* name = nullptr;
  if constexpr (requires { items[i].name; }) name = &items[i].name;
  check(Item{list, i, name}, items[i], scene);
}

template <class T>
void check_list(const char* list, const std::vector<T>& items, const SceneDescription& scene,
                std::size_t from = 0) {
  for (std::size_t i = from; i < items.size(); ++i) check_item(list, items, i, scene);
}

/// Checks the items of a list of numbers, and the numbers themselves.
template <class T>
void check_listed(const char* list, const std::vector<T>& items, const char* field,
                  const std::vector<std::uint32_t>& numbers, const SceneDescription& scene) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (numbers[k] >= items.size() || (k > 0 && numbers[k] <= numbers[k - 1])) {
      throw Error(ErrorCode::kInvalidArgument,
                  "is " + std::to_string(numbers[k]) + ", but must ascend, below the scene's " +
                      std::to_string(items.size()) + " " + list,
                  "changes." + element(field, k));
    }
    check_item(list, items, numbers[k], scene);
  }
}

}  // namespace

void validate_but_triangles(const SceneDescription& scene) {
  check_list("meshes", scene.meshes, scene);
  check_list("instances", scene.instances, scene);
  check_list("materials", scene.materials, scene);
  check_list("textures", scene.textures, scene);
  check_list("images", scene.images, scene);
  check_list("lights", scene.lights, scene);
  check_list("cameras", scene.cameras, scene);
  check_environment(scene.environment);
}

void validate(const SceneDescription& scene) {
  validate_but_triangles(scene);
  if (scene.triangle_count() == 0)
    throw Error(ErrorCode::kInvalidData, "the scene has no triangles");
}

void validate_camera(const Camera& camera) {
  try {
    check(Item{"cameras", 0, &camera.name}, camera, {});
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), "camera" + error.place().substr(10));
  }
}

void validate_changes(const SceneDescription& scene, const SceneChanges& changes) {
  if (changes.everything) return validate(scene);
  check_listed("meshes", scene.meshes, "deformed", changes.deformed, scene);
  check_listed("instances", scene.instances, "moved", changes.moved, scene);
  check_list("meshes", scene.meshes, scene, changes.other_meshes_from);
  check_list("instances", scene.instances, scene, changes.other_instances_from);
  check_list("lights", scene.lights, scene);
  check_list("cameras", scene.cameras, scene);
  if (scene.triangle_count() == 0)
    throw Error(ErrorCode::kInvalidData, "the scene has no triangles");
}

}  // namespace raysheaf
