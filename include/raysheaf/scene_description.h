// A scene as plain data: what the loaders fill, the built-in scenes generate and the renderer
// takes. Lengths are in scene units, angles in radians, colours linear with Rec. 709 primaries
// unless said otherwise. Everything may be edited between frames; nothing here is derived from
// anything else.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf {

/// Eight-bit RGBA, rows from the top, four bytes a pixel, not premultiplied.
struct Image {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

enum class Wrap : std::uint8_t { kRepeat, kMirroredRepeat, kClampToEdge };
enum class Filter : std::uint8_t { kLinear, kNearest };

struct Texture {
  std::uint32_t image = kInvalidId;  ///< index into `SceneDescription::images`
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  Filter filter = Filter::kLinear;
};

/// Where a material reads a texture. The mesh's `uvs`, or its `second_uvs`, are first scaled, then
/// rotated counter-clockwise by `rotation`, then moved by `offset` (KHR_texture_transform); `v`
/// points down from the top row.
struct TextureSlot {
  std::uint32_t texture = kInvalidId;  ///< index into `SceneDescription::textures`, or none
  Vec2 offset{0, 0}, scale{1, 1};
  float rotation = 0;
  bool second_uvs = false;  ///< read at the mesh's `second_uvs`, where it has any
};

/// glTF 2.0 metallic-roughness, with the transmission, ior, specular, emissive strength and unlit
/// extensions. Textures multiply the factors beside them.
struct Material {
  std::string name;
  Vec4 base_color{1, 1, 1, 1};
  TextureSlot base_color_texture;  ///< sRGB
  /// Where alpha, the base colour's times the texture's, is less, there is nothing; 0: everywhere
  /// is something, and alpha is not looked at.
  float alpha_cutoff = 0;
  /// With several samples a pixel, alpha is instead the chance that a ray meets something.
  bool alpha_blend = false;
  float metallic = 0, roughness = 1;
  TextureSlot metallic_roughness_texture;  ///< linear; roughness in green, metallic in blue
  Vec3 emission{0, 0, 0};                  ///< radiance, strength included
  TextureSlot emission_texture;            ///< sRGB
  /// Linear; 2 c - 1 along the texture's u, against its v, and along the normal.
  TextureSlot normal_texture;
  float normal_scale = 1;  ///< of the first two of them
  float specular = 1;
  Vec3 specular_color{1, 1, 1};
  float transmission = 0;
  float ior = 1.5f;
  /// What transmits is a sheet without an inside: light goes straight through it, tinted once, from
  /// either side. false: it bounds a solid body, whose front faces are its outside.
  bool thin = false;
  bool unlit = false;
  bool double_sided = false;  ///< false: back faces are not drawn by primary visibility
};

/// Triangles that move together. Front faces are counter-clockwise.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< a unit vector a vertex, or empty: face normals are used
  std::vector<Vec2> uvs;      ///< one a vertex, or empty
  /// For textures that ask for them: one a vertex, or empty. Only beside `uvs`.
  std::vector<Vec2> second_uvs;
  std::vector<Vec3> colors;  ///< linear, one a vertex, or empty; they multiply the base colour
  /// From 0 to 1, one a vertex, or empty; they multiply the base colour's alpha. Where a material
  /// blends, alpha is a chance then with a single sample a pixel, too.
  std::vector<float> alphas;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into the vertices
  std::vector<std::uint32_t> materials;  ///< one a triangle, or a single one for all of them
};

struct Instance {
  std::string name;
  std::uint32_t mesh = 0;  ///< index into `SceneDescription::meshes`
  Affine to_world;         ///< one that mirrors turns the winding, as glTF says
};

/// KHR_lights_punctual, and lights with a size (docs/light.md). `intensity` is colour times candela
/// (point, spot; rectangle: along `direction`) or lux (directional).
struct Light {
  enum class Type : std::uint8_t { kPoint, kSpot, kDirectional, kRectangle };
  std::string name;
  Type type = Type::kPoint;
  Vec3 position{0, 0, 0};    ///< world; not used by directional lights
  Vec3 direction{0, 0, -1};  ///< the unit vector along which light leaves; not of points
  Vec3 intensity{1, 1, 1};
  float range = std::numeric_limits<float>::infinity();
  float inner_angle = 0, outer_angle = 0.785398163f;  ///< spot: half angles from the axis
  float radius = 0;     ///< point, spot: of the ball that shines, evenly; 0: a point
  Vec3 right{1, 0, 0};  ///< rectangle: the unit vector along its width, square to `direction`
  float width = 0, height = 0;  ///< rectangle: its sides, above 0; `position` is its centre
};

/// A camera looks along its own -z with +y up. The picture's shape sets the horizontal extent;
/// where that would show less of the width than `aspect_ratio` asks for, both extents grow until it
/// does not (glTF 2.0, section 3.10.3).
struct Camera {
  std::string name;
  Affine to_world;
  bool orthographic = false;
  float y_fov = 1.04719755f;  ///< perspective: full vertical angle
  float y_mag = 1;            ///< orthographic: half the height of what is seen
  float aspect_ratio = 0;     ///< width over height of what is seen in any picture; 0: any
  float z_near = 0.01f;       ///< nothing nearer is drawn
  float z_far = std::numeric_limits<float>::infinity();
  float aperture = 0;  ///< diameter of a thin lens; 0: everything is sharp
  float focus = 0;     ///< the depth that is sharp; 0: that of what the picture's middle shows
};

/// Light from far away, all around: a map of radiance over directions. Rows go from +y down to -y
/// and columns once around: the middle one lies towards -z, those after it to the right of who
/// looks there.
struct Environment {
  std::string name;
  std::uint32_t width = 0, height = 0;  ///< 0: there is none
  std::vector<Vec3> radiance;           ///< linear, rows from the top
  float intensity = 1;                  ///< a factor on all of it
  float rotation = 0;                   ///< of the map about +y, counter-clockwise from above
  [[nodiscard]] bool empty() const { return width == 0 || height == 0; }
};

struct SceneDescription {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;  ///< may be empty: triangles without one use `Material{}`
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  Environment environment;
  std::vector<std::string> warnings;  ///< a sentence for each thing a loader left out
  /// It was read from, its own first, and those that they name, be they there or not; of a sequence
  /// all its frames, and what the first of them names. As paths from where we are.
  std::vector<std::string> files;

  /// Triangles counted once an instance.
  [[nodiscard]] std::uint64_t triangle_count() const;
};

/// The box of every instance's triangles, in world space; empty where there are none. Triangles
/// without area, which nothing shows, count only where no triangle has an area.
[[nodiscard]] Box world_bounds(const SceneDescription& scene);

/// Throws `Error` that names the first field which cannot be rendered: indices out of range,
/// non-finite vertices, transforms or lights, arrays of unequal length, no triangle at all.
void validate(const SceneDescription& scene);

/// A camera that looks at the whole scene from the front, above and to the right.
[[nodiscard]] Camera framing_camera(const SceneDescription& scene);

/// A point light that shows the scene from where `camera` stands: above it and to its left.
[[nodiscard]] Light showing_light(const SceneDescription& scene, const Camera& camera);

/// Whether there is no light, no environment, and something that would show by one: not every
/// material is unlit.
[[nodiscard]] bool needs_light(const SceneDescription& scene);

/// Adds `framing_camera` where there is no camera, `studio_lights` where `needs_light` says so.
void add_missing_camera_and_light(SceneDescription& scene);

}  // namespace raysheaf
