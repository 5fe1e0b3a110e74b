#include "look.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gil.h"
#include "raysheaf/animation.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"

namespace raysheaf::python {
namespace {

// Each kind of thing lists its fields once; `f` takes them into a dictionary or out of one.

template <class Fields>
void list(Fields& f, TextureSlot& slot) {
  f("texture", slot.texture), f("offset", slot.offset), f("scale", slot.scale);
  f("rotation", slot.rotation), f("second_uvs", slot.second_uvs);
}

template <class Fields>
void list(Fields& f, Material& m) {
  f("name", m.name), f("base_color", m.base_color), f("metallic", m.metallic);
  f("roughness", m.roughness), f("emission", m.emission), f("transmission", m.transmission);
  f("ior", m.ior), f("specular", m.specular), f("specular_color", m.specular_color);
  f("alpha_cutoff", m.alpha_cutoff), f("alpha_blend", m.alpha_blend), f("thin", m.thin);
  f("unlit", m.unlit), f("double_sided", m.double_sided), f("normal_scale", m.normal_scale);
  f("base_color_texture", m.base_color_texture);
  f("metallic_roughness_texture", m.metallic_roughness_texture);
  f("emission_texture", m.emission_texture), f("normal_texture", m.normal_texture);
}

template <class Fields>
void list(Fields& f, Texture& t) {
  f("image", t.image), f("wrap_u", t.wrap_u), f("wrap_v", t.wrap_v), f("filter", t.filter);
}

template <class Fields>
void list(Fields& f, Light& l) {
  f("name", l.name), f("type", l.type), f("position", l.position), f("direction", l.direction);
  f("intensity", l.intensity), f("range", l.range), f("inner_angle", l.inner_angle);
  f("outer_angle", l.outer_angle), f("radius", l.radius), f("right", l.right);
  f("width", l.width), f("height", l.height);
}

template <class Fields>
void list(Fields& f, Camera& c) {
  f("name", c.name), f("to_world", c.to_world), f("orthographic", c.orthographic);
  f("y_fov", c.y_fov), f("y_mag", c.y_mag), f("aspect_ratio", c.aspect_ratio);
  f("z_near", c.z_near), f("z_far", c.z_far), f("aperture", c.aperture), f("focus", c.focus);
}

template <class Fields>
void list(Fields& f, Instance& i) {
  f("name", i.name), f("mesh", i.mesh), f("to_world", i.to_world);
}

template <class Fields>
void list(Fields& f, Mesh& m) {
  f("name", m.name), f("positions", m.positions), f("normals", m.normals), f("uvs", m.uvs);
  f("second_uvs", m.second_uvs), f("colors", m.colors), f("alphas", m.alphas);
  f("triangles", m.triangles), f("materials", m.materials);
}

template <class Fields>
void list(Fields& f, Image& i) {
  f("name", i.name), f("width", i.width), f("height", i.height), f("rgba", i.rgba);
}

template <class Fields>
void list(Fields& f, Environment& e) {
  f("name", e.name), f("width", e.width), f("height", e.height), f("radiance", e.radiance);
  f("intensity", e.intensity), f("rotation", e.rotation);
}

template <class Fields>
void list(Fields& f, SceneDescription& s) {
  f("name", s.name), f("meshes", s.meshes), f("instances", s.instances);
  f("materials", s.materials), f("textures", s.textures), f("images", s.images);
  f("lights", s.lights), f("cameras", s.cameras), f("environment", s.environment);
  f("warnings", s.warnings);
}

/// Scalars of one kind, that a vector of them is an array of.
template <class Item>
struct Parts {
  using Scalar = float;
};
template <>
struct Parts<std::uint8_t> {
  using Scalar = std::uint8_t;
};
template <>
struct Parts<std::uint32_t> {
  using Scalar = std::uint32_t;
};
template <>
struct Parts<std::array<std::uint32_t, 3>> {
  using Scalar = std::uint32_t;
};
template <class Item>
inline constexpr bool kIsNumbers =
    std::is_same_v<Item, std::uint8_t> || std::is_same_v<Item, std::uint32_t> ||
    std::is_same_v<Item, float> || std::is_same_v<Item, Vec2> || std::is_same_v<Item, Vec3> ||
    std::is_same_v<Item, std::array<std::uint32_t, 3>>;

/// Three to twelve floats in a row.
template <class T>
inline constexpr bool kIsFloats = std::is_same_v<T, Vec2> || std::is_same_v<T, Vec3> ||
                                  std::is_same_v<T, Vec4> || std::is_same_v<T, Affine>;

struct IntoDict {
  nb::dict dict;

  template <class T>
  void operator()(const char* name, T& value) {
    dict[name] = given(value);
  }

 private:
  template <class T>
  static nb::object given(T& value) {
    if constexpr (std::is_enum_v<T>) {
      return nb::cast(static_cast<int>(value));
    } else if constexpr (kIsFloats<T>) {
      float floats[sizeof(T) / sizeof(float)];
      std::memcpy(floats, &value, sizeof value);
      nb::list items;
      for (const float x : floats) items.append(x);
      return nb::tuple(items);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      return nb::cast(value);
    } else {
      IntoDict inner;
      list(inner, value);
      return std::move(inner.dict);
    }
  }
  template <class Item>
  static nb::object given(std::vector<Item>& items) {
    if constexpr (kIsNumbers<Item>) {
      using Scalar = typename Parts<Item>::Scalar;
      auto* const kept = new std::vector<Item>(std::move(items));
      const nb::capsule owner(
          kept, [](void* at) noexcept { delete static_cast<std::vector<Item>*>(at); });
      if constexpr (std::is_same_v<Item, Scalar>) {
        return array_over<Scalar>(kept->data(), {kept->size()}, owner);
      } else {
        constexpr std::size_t kWidth = sizeof(Item) / sizeof(Scalar);
        return array_over<Scalar>(kept->data(), {kept->size(), kWidth}, owner);
      }
    } else {
      nb::list all;
      for (Item& item : items) all.append(given(item));
      return all;
    }
  }
};

struct FromDict {
  nb::dict dict;

  template <class T>
  void operator()(const char* name, T& value) {
    take(nb::object(dict[name]), &value);
  }

 private:
  template <class T>
  static void take(const nb::object& from, T* value) {
    if constexpr (std::is_enum_v<T>) {
      *value = static_cast<T>(nb::cast<int>(from));
    } else if constexpr (kIsFloats<T>) {
      constexpr std::size_t kCount = sizeof(T) / sizeof(float);
      float floats[kCount];
      if (nb::len(from) != kCount) throw nb::value_error("a tuple has another length");
      for (std::size_t i = 0; i < kCount; ++i) floats[i] = nb::cast<float>(nb::object(from[i]));
      std::memcpy(static_cast<void*>(value), floats, sizeof floats);
    } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
      *value = nb::cast<T>(from);
    } else {
      FromDict inner{nb::cast<nb::dict>(from)};
      list(inner, *value);
    }
  }
  template <class Item>
  static void take(const nb::object& from, std::vector<Item>* items) {
    if constexpr (kIsNumbers<Item>) {
      using Scalar = typename Parts<Item>::Scalar;
      const auto array = nb::cast<nb::ndarray<const Scalar, nb::c_contig, nb::device::cpu>>(from);
      const std::size_t bytes = array.size() * sizeof(Scalar);
      if (bytes % sizeof(Item) != 0) throw nb::value_error("an array has another shape");
      items->resize(bytes / sizeof(Item));
      if (bytes != 0) std::memcpy(static_cast<void*>(items->data()), array.data(), bytes);
    } else {
      for (const nb::handle item : nb::cast<nb::list>(from)) {
        items->emplace_back();
        take(nb::borrow(item), &items->back());
      }
    }
  }
};

template <class T>
T taken(const nb::dict& dict) {
  T value;
  FromDict fields{dict};
  list(fields, value);
  return value;
}

/// A file or a built-in scene at rest, or at a time.
nb::dict load(const std::string& name, const std::optional<double>& time) {
  const std::string prefix = "builtin:";
  SceneDescription scene = [&] {
    const WithoutGil released;
    if (name.starts_with(prefix)) return builtin_scene(name.substr(prefix.size()));
    if (!time) return load_scene(name);
    const std::unique_ptr<Animation> animation = load_animation(name);
    static_cast<void>(animation->seek(*time));
    return std::move(animation->scene());
  }();
  return dict_of(std::move(scene));
}

}  // namespace

nb::dict dict_of(SceneDescription&& scene) {
  IntoDict fields;
  list(fields, scene);
  return std::move(fields.dict);
}

SceneDescription description_of(const nb::dict& scene) {
  return taken<SceneDescription>(scene);
}

Camera camera_of(const nb::dict& camera) {
  return taken<Camera>(camera);
}

Light light_of(const nb::dict& light) {
  return taken<Light>(light);
}

void bind_look(nb::module_& module) {
  module.def("load", load, nb::arg("scene"), nb::arg("time").none());
}

}  // namespace raysheaf::python
