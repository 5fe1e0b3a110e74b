// A scene as plain data: the loaders fill it, the built-in scenes generate it, and the renderer
// reads it. Lengths are in scene units, angles in radians, colours linear with Rec. 709 primaries
// unless stated otherwise. Every field may be edited between frames; no field is derived from
// another.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf {

/// Eight-bit RGBA, rows from the top, four bytes per pixel, not premultiplied.
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

/// How a material reads a texture. The mesh's `uvs` or `second_uvs` are first scaled, then rotated
/// counter-clockwise by `rotation`, then moved by `offset` (KHR_texture_transform); `v` points down
/// from the top row.
struct TextureSlot {
  std::uint32_t texture = kInvalidId;  ///< index into `SceneDescription::textures`, or none
  Vec2 offset{0, 0}, scale{1, 1};
  float rotation = 0;
  bool second_uvs = false;  ///< use the mesh's `second_uvs`, if it has any
};

/// glTF 2.0 metallic-roughness, with the transmission, ior, specular, emissive strength and unlit
/// extensions. Each texture multiplies the factor of the same name.
struct Material {
  std::string name;
  Vec4 base_color{1, 1, 1, 1};
  TextureSlot base_color_texture;  ///< sRGB
  /// Where alpha (the base colour's times the texture's) is less, the surface has a hole. 0: the
  /// surface has no holes, and alpha is not read.
  float alpha_cutoff = 0;
  /// With several samples per pixel, alpha is instead the probability that a ray hits the surface.
  bool alpha_blend = false;
  float metallic = 0, roughness = 1;
  TextureSlot metallic_roughness_texture;  ///< linear; roughness in green, metallic in blue
  Vec3 emission{0, 0, 0};                  ///< radiance, including strength
  TextureSlot emission_texture;            ///< sRGB
  /// Linear; 2 c - 1 along the texture's u, against its v, and along the normal.
  TextureSlot normal_texture;
  float normal_scale = 1;  ///< of the first two components
  float specular = 1;
  Vec3 specular_color{1, 1, 1};
  float transmission = 0;
  float ior = 1.5f;
  /// A transmitting surface is a sheet without an interior: light passes straight through it from
  /// either side and is tinted once. false: it bounds a solid body, whose front faces are its
  /// outside.
  bool thin = false;
  bool unlit = false;
  bool double_sided = false;  ///< false: back faces are not drawn by primary visibility
};

/// Triangles that move together. Front faces are counter-clockwise.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< a unit vector for each vertex, or empty: face normals are used
  std::vector<Vec2> uvs;      ///< one for each vertex, or empty
  /// For textures with `second_uvs`: one for each vertex, or empty. Needs `uvs`.
  std::vector<Vec2> second_uvs;
  /// Linear, one for each vertex, or empty; they multiply the base colour.
  std::vector<Vec3> colors;
  /// From 0 to 1, one for each vertex, or empty; they multiply the base colour's alpha. With them,
  /// alpha of a blending material is a probability also with a single sample per pixel.
  std::vector<float> alphas;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into the vertices
  std::vector<std::uint32_t> materials;  ///< one for each triangle, or a single one for all of them
};

struct Instance {
  std::string name;
  std::uint32_t mesh = 0;  ///< index into `SceneDescription::meshes`
  Affine to_world;         ///< a mirroring transform reverses the winding, as in glTF
};

/// KHR_lights_punctual, and lights with a size (docs/light.md). `intensity` is the colour times
/// candela (point, spot; rectangle: along `direction`) or lux (directional).
struct Light {
  enum class Type : std::uint8_t { kPoint, kSpot, kDirectional, kRectangle };
  std::string name;
  Type type = Type::kPoint;
  Vec3 position{0, 0, 0};  ///< world space; not used by directional lights
  /// The unit vector along which light is emitted; not used by point lights.
  Vec3 direction{0, 0, -1};
  Vec3 intensity{1, 1, 1};
  float range = std::numeric_limits<float>::infinity();
  float inner_angle = 0, outer_angle = 0.785398163f;  ///< spot: half angles from the axis
  float radius = 0;  ///< point, spot: of the sphere that emits light evenly; 0: a point
  /// Rectangle: the unit vector along its width, perpendicular to `direction`.
  Vec3 right{1, 0, 0};
  float width = 0, height = 0;  ///< rectangle: its side lengths, above 0; `position` is its centre
};

/// A camera looks along its own -z with +y up. The image's shape sets the horizontal extent; if
/// that would show less of the width than `aspect_ratio` requires, both extents grow until it does
/// not (glTF 2.0, section 3.10.3).
struct Camera {
  std::string name;
  Affine to_world;
  bool orthographic = false;
  float y_fov = 1.04719755f;  ///< perspective: full vertical angle
  float y_mag = 1;            ///< orthographic: half the height of the visible region
  /// Width over height of the region visible in every image; 0: no requirement.
  float aspect_ratio = 0;
  float z_near = 0.01f;  ///< nothing nearer is drawn
  float z_far = std::numeric_limits<float>::infinity();
  float aperture = 0;  ///< diameter of a thin lens; 0: everything is sharp
  float focus = 0;     ///< the depth in focus; 0: that of the surface in the middle of the image
};

/// Light from far away in all directions: a map of radiance. Rows go from +y down to -y, and
/// columns once around: the middle column lies towards -z, the columns after it to the right for a
/// viewer who looks there.
struct Environment {
  std::string name;
  std::uint32_t width = 0, height = 0;  ///< 0: no environment
  std::vector<Vec3> radiance;           ///< linear, rows from the top
  float intensity = 1;                  ///< a factor on all radiance
  float rotation = 0;                   ///< of the map about +y, counter-clockwise from above
  std::vector<std::string> warnings;    ///< a sentence for each thing that was read as another
  [[nodiscard]] bool empty() const { return width == 0 || height == 0; }
};

struct SceneDescription {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;  ///< may be empty: triangles without a material use `Material{}`
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  Environment environment;
  std::vector<std::string> warnings;  ///< one sentence for each thing that a loader ignored
  /// The files that the scene was read from: its own first, then those that it names, whether they
  /// exist or not; for a sequence all its frames, and the files that the first one names. Paths are
  /// relative to the current folder.
  std::vector<std::string> files;

  /// Triangles, counted for each instance.
  [[nodiscard]] std::uint64_t triangle_count() const;
};

/// The box of every instance's triangles, in world space; empty if there are none. Triangles
/// without area are invisible and count only if no triangle has an area.
[[nodiscard]] Box world_bounds(const SceneDescription& scene);

/// Throws `Error` naming the first field that cannot be rendered: indices out of range, non-finite
/// vertices, transforms or lights, arrays of unequal length, no triangle at all.
void validate(const SceneDescription& scene);

/// A camera that looks at the whole scene from the front, above and to the right.
[[nodiscard]] Camera framing_camera(const SceneDescription& scene);

/// A point light above and to the left of `camera` that illuminates what it sees.
[[nodiscard]] Light showing_light(const SceneDescription& scene, const Camera& camera);

/// Whether the scene has neither a light nor an environment, but a material that needs one: not
/// every material is unlit.
[[nodiscard]] bool needs_light(const SceneDescription& scene);

/// Adds `framing_camera` if the scene has no camera, and `studio_lights` if `needs_light` returns
/// true.
void add_missing_camera_and_light(SceneDescription& scene);

}  // namespace raysheaf
