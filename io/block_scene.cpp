// The scene without its triangles: JSON, then images as PNG.
#include <cmath>
#include <limits>

#include "io/block_format.h"
#include "io/image.h"
#include "io/json_value.h"
#include "io/json_writer.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"

namespace raysheaf::io {
namespace {

struct SceneHead {
  std::uint64_t json_bytes, images;
};

// A float becomes a double, which JSON prints so that it reads back to the same bits. JSON has no
// infinity: null stands for it.
Json number(float x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
float number_from(const JsonValue& j) {
  return j.is_null() ? std::numeric_limits<float>::infinity() : j.get<float>();
}
Json index(std::uint32_t i) {
  return i == kInvalidId ? Json(nullptr) : Json(i);
}
std::uint32_t index_from(const JsonValue& j) {
  return j.is_null() ? kInvalidId : j.get<std::uint32_t>();
}
Json of(Vec2 v) {
  return JsonArray{number(v.x), number(v.y)};
}
Json of(Vec3 v) {
  return JsonArray{number(v.x), number(v.y), number(v.z)};
}
Json of(Vec4 v) {
  return JsonArray{number(v.x), number(v.y), number(v.z), number(v.w)};
}
Vec2 vec2(const JsonValue& j) {
  return {number_from(j.at(0)), number_from(j.at(1))};
}
Vec3 vec3(const JsonValue& j) {
  return {number_from(j.at(0)), number_from(j.at(1)), number_from(j.at(2))};
}
Vec4 vec4(const JsonValue& j) {
  return {number_from(j.at(0)), number_from(j.at(1)), number_from(j.at(2)), number_from(j.at(3))};
}

Json of(const Affine& a) {
  JsonArray list;
  for (const auto& row : a.m) {
    for (const float x : row) list.add(number(x));
  }
  return list;
}
Affine affine(const JsonValue& j) {
  Affine a;
  for (std::size_t i = 0; i < 12; ++i) a.m[i / 4][i % 4] = number_from(j.at(i));
  return a;
}

Json of(const TextureSlot& slot) {
  JsonObject result{{"texture", index(slot.texture)},
                    {"offset", of(slot.offset)},
                    {"scale", of(slot.scale)},
                    {"rotation", number(slot.rotation)}};
  if (slot.second_uvs) result.add("second_uvs", true);
  return result;
}
TextureSlot slot(const JsonValue& j) {
  return {index_from(j.at("texture")), vec2(j.at("offset")), vec2(j.at("scale")),
          number_from(j.at("rotation")), j.get("second_uvs", false)};
}

Json of(const Material& m) {
  JsonObject result{{"name", m.name},
                    {"base_color", of(m.base_color)},
                    {"base_color_texture", of(m.base_color_texture)},
                    {"metallic", number(m.metallic)},
                    {"roughness", number(m.roughness)},
                    {"metallic_roughness_texture", of(m.metallic_roughness_texture)},
                    {"emission", of(m.emission)},
                    {"emission_texture", of(m.emission_texture)},
                    {"specular", number(m.specular)},
                    {"specular_color", of(m.specular_color)},
                    {"transmission", number(m.transmission)},
                    {"ior", number(m.ior)},
                    {"unlit", m.unlit},
                    {"double_sided", m.double_sided}};
  if (m.thin) result.add("thin", true);
  if (m.normal_texture.texture != kInvalidId) {
    result.add("normal_texture", of(m.normal_texture));
    result.add("normal_scale", number(m.normal_scale));
  }
  return result;
}
Material material(const JsonValue& j) {
  Material m;
  m.name = j.at("name").get<std::string>();
  m.base_color = vec4(j.at("base_color"));
  m.base_color_texture = slot(j.at("base_color_texture"));
  m.metallic = number_from(j.at("metallic"));
  m.roughness = number_from(j.at("roughness"));
  m.metallic_roughness_texture = slot(j.at("metallic_roughness_texture"));
  m.emission = vec3(j.at("emission"));
  m.emission_texture = slot(j.at("emission_texture"));
  m.specular = number_from(j.at("specular"));
  m.specular_color = vec3(j.at("specular_color"));
  m.transmission = number_from(j.at("transmission"));
  m.ior = number_from(j.at("ior"));
  m.unlit = j.at("unlit").get<bool>();
  m.double_sided = j.at("double_sided").get<bool>();
  m.thin = j.get("thin", false);
  if (j.contains("normal_texture")) {
    m.normal_texture = slot(j.at("normal_texture"));
    m.normal_scale = number_from(j.at("normal_scale"));
  }
  return m;
}

const char* const kWraps[] = {"repeat", "mirror", "clamp"};
const char* const kLights[] = {"point", "spot", "directional", "rectangle"};

template <class Enum, std::size_t kCount>
Enum word(const JsonValue& j, const char* const (&words)[kCount]) {
  const auto text = j.get<std::string>();
  for (std::size_t i = 0; i < kCount; ++i) {
    if (text == words[i]) return static_cast<Enum>(i);
  }
  throw Error(ErrorCode::kInvalidData, "its scene contains an unknown word");
}

Json of(const Texture& t) {
  return JsonObject{{"image", index(t.image)},
                    {"wrap_u", kWraps[static_cast<int>(t.wrap_u)]},
                    {"wrap_v", kWraps[static_cast<int>(t.wrap_v)]},
                    {"nearest", t.filter == Filter::kNearest}};
}
Texture texture(const JsonValue& j) {
  return {index_from(j.at("image")), word<Wrap>(j.at("wrap_u"), kWraps),
          word<Wrap>(j.at("wrap_v"), kWraps),
          j.at("nearest").get<bool>() ? Filter::kNearest : Filter::kLinear};
}

Json of(const Instance& i) {
  return JsonObject{{"name", i.name}, {"mesh", i.mesh}, {"to_world", of(i.to_world)}};
}
Instance instance(const JsonValue& j) {
  return {j.at("name").get<std::string>(), j.at("mesh").get<std::uint32_t>(),
          affine(j.at("to_world"))};
}

Json of(const Light& l) {
  return JsonObject{{"name", l.name},
                    {"type", kLights[static_cast<int>(l.type)]},
                    {"position", of(l.position)},
                    {"direction", of(l.direction)},
                    {"intensity", of(l.intensity)},
                    {"range", number(l.range)},
                    {"inner_angle", number(l.inner_angle)},
                    {"outer_angle", number(l.outer_angle)},
                    {"radius", number(l.radius)},
                    {"right", of(l.right)},
                    {"width", number(l.width)},
                    {"height", number(l.height)}};
}
Light light(const JsonValue& j) {
  Light l;
  l.name = j.at("name").get<std::string>();
  l.type = word<Light::Type>(j.at("type"), kLights);
  l.position = vec3(j.at("position"));
  l.direction = vec3(j.at("direction"));
  l.intensity = vec3(j.at("intensity"));
  l.range = number_from(j.at("range"));
  l.inner_angle = number_from(j.at("inner_angle"));
  l.outer_angle = number_from(j.at("outer_angle"));
  l.radius = number_from(j.at("radius"));
  l.right = vec3(j.at("right"));
  l.width = number_from(j.at("width"));
  l.height = number_from(j.at("height"));
  return l;
}

Json of(const Camera& c) {
  JsonObject result{{"name", c.name},
                    {"to_world", of(c.to_world)},
                    {"orthographic", c.orthographic},
                    {"y_fov", number(c.y_fov)},
                    {"y_mag", number(c.y_mag)},
                    {"z_near", number(c.z_near)},
                    {"z_far", number(c.z_far)},
                    {"aperture", number(c.aperture)},
                    {"focus", number(c.focus)}};
  if (c.aspect_ratio > 0) result.add("aspect_ratio", number(c.aspect_ratio));
  return result;
}
Camera camera(const JsonValue& j) {
  Camera c;
  c.name = j.at("name").get<std::string>();
  c.to_world = affine(j.at("to_world"));
  c.orthographic = j.at("orthographic").get<bool>();
  c.y_fov = number_from(j.at("y_fov"));
  c.y_mag = number_from(j.at("y_mag"));
  c.z_near = number_from(j.at("z_near"));
  c.z_far = number_from(j.at("z_far"));
  c.aperture = number_from(j.at("aperture"));
  c.focus = number_from(j.at("focus"));
  if (j.contains("aspect_ratio")) c.aspect_ratio = number_from(j.at("aspect_ratio"));
  return c;
}

template <class T>
Json list_of(const std::vector<T>& items) {
  JsonArray list;
  for (const T& item : items) list.add(of(item));
  return list;
}
template <class T>
Json names_of(const std::vector<T>& items) {
  JsonArray list;
  for (const T& item : items) list.add(item.name);
  return list;
}
std::span<const JsonValue> list_at(const JsonValue& j, const char* name) {
  if (!j.at(name).is_array()) throw JsonMismatch();
  return j.at(name).items();
}
template <class T>
void read_list(const JsonValue& j, const char* name, T (*read)(const JsonValue&),
               std::vector<T>* out) {
  const auto list = list_at(j, name);
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      out->push_back(read(list[i]));
    } catch (const JsonMismatch&) {
      throw Error(ErrorCode::kInvalidData, "a field is missing or has the wrong type",
                  std::string(name) + "[" + std::to_string(i) + "]");
    }
  }
}

void read_images(std::span<const std::uint8_t> bytes, std::span<const JsonValue> names,
                 SceneDescription* scene) {
  std::uint64_t pixels = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string place = "images[" + std::to_string(i) + "]";
    std::uint64_t size = 0;
    if (bytes.size() < sizeof size) throw Error(ErrorCode::kInvalidData, "is not there", place);
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.subspan(sizeof size);
    if (bytes.size() < size) throw Error(ErrorCode::kInvalidData, "is truncated", place);
    const auto encoded = bytes.first(size);
    bytes = bytes.subspan(size);
    if (const auto head = image_size(encoded)) pixels += std::uint64_t{head->width} * head->height;
    if (pixels > kMaxScenePixels)
      throw Error(ErrorCode::kOutOfMemory, "the images have too many pixels", place);
    std::optional<Image> image = decode_image(encoded);
    if (!image) throw Error(ErrorCode::kInvalidData, "is not an image", place);
    image->name = names[i].get<std::string>();
    scene->images.push_back(std::move(*image));
  }
  if (!bytes.empty())
    throw Error(ErrorCode::kInvalidData, "there are more bytes than its images need", "images");
}

SceneDescription scene_from(const JsonValue& j) {
  SceneDescription scene;
  scene.name = j.at("name").get<std::string>();
  for (const JsonValue& name : list_at(j, "meshes"))
    scene.meshes.emplace_back().name = name.get<std::string>();
  read_list(j, "instances", instance, &scene.instances);
  read_list(j, "materials", material, &scene.materials);
  read_list(j, "textures", texture, &scene.textures);
  read_list(j, "lights", light, &scene.lights);
  read_list(j, "cameras", camera, &scene.cameras);
  return scene;
}

void append(std::span<const std::uint8_t> bytes, Bytes* out) {
  out->insert(out->end(), bytes.begin(), bytes.end());
}

}  // namespace

Bytes encode_scene(const SceneDescription& scene) {
  if (!scene.environment.empty())
    throw Error(ErrorCode::kUnsupported, "block files hold no environment", "environment");
  const Json json = JsonObject{{"name", scene.name},
                               {"meshes", names_of(scene.meshes)},
                               {"instances", list_of(scene.instances)},
                               {"materials", list_of(scene.materials)},
                               {"textures", list_of(scene.textures)},
                               {"lights", list_of(scene.lights)},
                               {"cameras", list_of(scene.cameras)},
                               {"images", names_of(scene.images)}};
  const std::string& text = json.text();
  Bytes out;
  append(bytes_of(SceneHead{text.size(), scene.images.size()}), &out);
  append(as_bytes(text), &out);
  for (const Image& image : scene.images) {
    const Bytes png = encode_png(image);
    append(bytes_of(std::uint64_t{png.size()}), &out);
    append(png, &out);
  }
  return out;
}

SceneDescription decode_scene(std::span<const std::uint8_t> bytes) {
  SceneHead head{};
  if (bytes.size() < sizeof head) throw Error(ErrorCode::kInvalidData, "is too short", "scene");
  std::memcpy(&head, bytes.data(), sizeof head);
  bytes = bytes.subspan(sizeof head);
  if (head.json_bytes > bytes.size())
    throw Error(ErrorCode::kInvalidData, "its JSON is truncated", "scene");
  try {
    const JsonDocument document(bytes.first(head.json_bytes));
    const JsonValue& j = document.root();
    SceneDescription scene = scene_from(j);
    const auto names = list_at(j, "images");
    if (names.size() != head.images)
      throw Error(ErrorCode::kInvalidData, "the numbers of names and images differ", "images");
    read_images(bytes.subspan(head.json_bytes), names, &scene);
    return scene;
  } catch (const JsonMismatch&) {
    throw Error(ErrorCode::kInvalidData, "a field of its JSON is missing or has the wrong type",
                "scene");
  }
}

}  // namespace raysheaf::io
