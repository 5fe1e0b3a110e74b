#include <algorithm>
#include <cmath>

#include "io/glb_writer.h"
#include "io/linear.h"

namespace raysheaf::io {
namespace {

constexpr int kFloat = 5126, kUint32 = 5125, kVertexTarget = 34962, kIndexTarget = 34963;

template <class T>
std::span<const std::uint8_t> raw(const T* first, std::size_t count) {
  return {reinterpret_cast<const std::uint8_t*>(first), count * sizeof(T)};
}

template <class T>
std::size_t add_vertices(GlbParts& parts, const std::vector<T>& values, const char* type,
                         JsonObject accessor = {}) {
  accessor.add("bufferView", parts.add_view(raw(values.data(), values.size()), kVertexTarget));
  accessor.add("componentType", kFloat);
  accessor.add("count", values.size());
  accessor.add("type", type);
  return parts.add("accessors", accessor);
}

Json numbers_of(Vec3 v) {
  return JsonArray{v.x, v.y, v.z};
}

std::vector<Vec4> colors_with_alpha(const Mesh& mesh) {
  std::vector<Vec4> all;
  for (std::size_t i = 0; i < mesh.alphas.size(); ++i) {
    const Vec3 color = mesh.colors.empty() ? Vec3{1, 1, 1} : mesh.colors[i];
    all.push_back({color.x, color.y, color.z, mesh.alphas[i]});
  }
  return all;
}

Json attributes_of(const Mesh& mesh, GlbParts& parts) {
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const JsonObject bounds{{"min", numbers_of(low)}, {"max", numbers_of(high)}};
  JsonObject result{{"POSITION", add_vertices(parts, mesh.positions, "VEC3", bounds)}};
  if (!mesh.normals.empty()) result.add("NORMAL", add_vertices(parts, mesh.normals, "VEC3"));
  if (!mesh.uvs.empty()) result.add("TEXCOORD_0", add_vertices(parts, mesh.uvs, "VEC2"));
  if (!mesh.second_uvs.empty())
    result.add("TEXCOORD_1", add_vertices(parts, mesh.second_uvs, "VEC2"));
  if (!mesh.alphas.empty())
    result.add("COLOR_0", add_vertices(parts, colors_with_alpha(mesh), "VEC4"));
  else if (!mesh.colors.empty())
    result.add("COLOR_0", add_vertices(parts, mesh.colors, "VEC3"));
  return result;
}

std::uint32_t material_at(const Mesh& mesh, std::size_t triangle) {
  if (mesh.materials.empty()) return kInvalidId;
  return mesh.materials.size() == 1 ? mesh.materials[0] : mesh.materials[triangle];
}

/// Writes one primitive for each run of triangles with the same material, which keeps the
/// triangles' order. All primitives share the vertices and one buffer view of indices.
Json mesh_of(const Mesh& mesh, GlbParts& parts) {
  const Json attributes = attributes_of(mesh, parts);
  const std::size_t view =
      parts.add_view(raw(mesh.triangles.data(), mesh.triangles.size()), kIndexTarget);
  JsonArray primitives;
  for (std::size_t first = 0, last = 0; first < mesh.triangles.size(); first = last) {
    const std::uint32_t material = material_at(mesh, first);
    while (last < mesh.triangles.size() && material_at(mesh, last) == material) ++last;
    const std::size_t indices = parts.add("accessors", JsonObject{{"bufferView", view},
                                                                  {"byteOffset", 12 * first},
                                                                  {"componentType", kUint32},
                                                                  {"count", 3 * (last - first)},
                                                                  {"type", "SCALAR"}});
    JsonObject primitive{{"attributes", attributes}, {"indices", indices}};
    if (material != kInvalidId) primitive.add("material", material);
    primitives.add(primitive);
  }
  return JsonObject{{"name", mesh.name}, {"primitives", primitives}};
}

void write_transform(const Affine& a, JsonObject& node) {
  const Affine identity;
  if (a.m == identity.m) return;
  JsonArray matrix;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t r = 0; r < 3; ++r) matrix.add(a.m[r][c]);
    matrix.add(c == 3 ? 1 : 0);
  }
  node.add("matrix", matrix);
}

/// A coordinate frame whose -z axis is the light's direction.
Affine light_frame(const Light& light) {
  const Double3 z = widen(light.direction) * -1;
  const Double3 spare = std::fabs(z.y) < 0.9 ? Double3{0, 1, 0} : Double3{1, 0, 0};
  const Double3 x = normalized(cross(spare, z), {1, 0, 0});
  DoubleAffine frame;
  frame.columns = {x, cross(z, x), z, widen(light.position)};
  if (light.type == Light::Type::kRectangle) {
    const Double3 right = widen(light.right);
    frame.columns = {right, cross(z, right), z, widen(light.position)};
  }
  if (light.type == Light::Type::kPoint)
    frame.columns = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, widen(light.position)}};
  if (light.type == Light::Type::kDirectional) frame.columns[3] = {};
  return narrow(frame);
}

Json light_of(const Light& light) {
  const float strength = power_of_two_above(light.intensity);
  const Vec3 i = light.intensity;
  // Other readers do not know rectangular lights and see a wide spot light.
  const bool rectangle = light.type == Light::Type::kRectangle;
  JsonObject result{{"name", light.name},
                    {"color", numbers_of({i.x / strength, i.y / strength, i.z / strength})},
                    {"intensity", strength},
                    {"type", light.type == Light::Type::kPoint         ? "point"
                             : light.type == Light::Type::kDirectional ? "directional"
                                                                       : "spot"}};
  const auto add_spot = [&](float inner, float outer) {
    result.add("spot", JsonObject{{"innerConeAngle", inner}, {"outerConeAngle", outer}});
  };
  if (rectangle) {
    result.add("extras", JsonObject{{"width", light.width}, {"height", light.height}});
    add_spot(0, 1.5707963f);
  } else if (light.radius > 0) {
    result.add("extras", JsonObject{{"radius", light.radius}});
  }
  if (light.type == Light::Type::kSpot) add_spot(light.inner_angle, light.outer_angle);
  if (std::isfinite(light.range)) result.add("range", light.range);
  return result;
}

Json camera_of(const Camera& camera) {
  const bool bounded = std::isfinite(camera.z_far);
  JsonObject lens{{"znear", camera.z_near}};
  if (camera.orthographic) {
    // glTF requires a width. If the camera has no aspect ratio, the image is square.
    lens.add("xmag", camera.y_mag * (camera.aspect_ratio > 0 ? camera.aspect_ratio : 1));
    lens.add("ymag", camera.y_mag);
    // glTF requires this field.
    lens.add("zfar", bounded ? camera.z_far : std::numeric_limits<float>::max());
  } else {
    lens.add("yfov", camera.y_fov);
    if (camera.aspect_ratio > 0) lens.add("aspectRatio", camera.aspect_ratio);
    if (bounded) lens.add("zfar", camera.z_far);
  }
  const char* type = camera.orthographic ? "orthographic" : "perspective";
  JsonObject result{{"name", camera.name}, {"type", type}, {type, lens}}, extras;
  if (camera.aperture > 0) extras.add("aperture", camera.aperture);
  if (camera.focus > 0) extras.add("focus", camera.focus);
  if (!extras.empty()) result.add("extras", extras);
  return result;
}

}  // namespace

void write_meshes(const SceneDescription& scene, GlbParts& parts) {
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.triangles.empty()) parts.add("meshes", mesh_of(mesh, parts));
  }
}

void write_nodes(const SceneDescription& scene, GlbParts& parts) {
  std::vector<std::size_t> index_of;
  std::size_t written = 0;
  for (const Mesh& mesh : scene.meshes) {
    index_of.push_back(mesh.triangles.empty() ? kInvalidId : written++);
  }
  for (const Instance& instance : scene.instances) {
    if (index_of[instance.mesh] == kInvalidId) continue;
    JsonObject node{{"name", instance.name}, {"mesh", index_of[instance.mesh]}};
    write_transform(instance.to_world, node);
    parts.add("nodes", node);
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    parts.extensions.insert("KHR_lights_punctual");
    parts.lights.push_back(light_of(scene.lights[i]));
    const Json punctual = JsonObject{{"KHR_lights_punctual", JsonObject{{"light", i}}}};
    JsonObject node{{"extensions", punctual}};
    write_transform(light_frame(scene.lights[i]), node);
    parts.add("nodes", node);
  }
  for (const Camera& camera : scene.cameras) {
    JsonObject node{{"camera", parts.add("cameras", camera_of(camera))}};
    write_transform(camera.to_world, node);
    parts.add("nodes", node);
  }
  JsonArray roots;
  for (std::size_t n = 0; n < parts.lists["nodes"].size(); ++n) roots.add(n);
  parts.add("scenes", JsonObject{{"name", scene.name}, {"nodes", roots}});
}

}  // namespace raysheaf::io
