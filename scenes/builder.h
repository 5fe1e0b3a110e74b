// Tools for the built-in scenes: a mesh builder, kits of meshes, and reproducible random numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::builtin {

inline constexpr float kPi = 3.14159265358979f;

[[nodiscard]] constexpr float radians(float degrees) {
  return degrees * (kPi / 180);
}

/// Turned about +y by `degrees` (counter-clockwise from above), then moved to `position`.
[[nodiscard]] Affine placed(Vec3 position, float degrees = 0);

/// The linear colour of an sRGB number such as 0xff8000.
[[nodiscard]] Vec4 srgb(std::uint32_t rgb);

/// PCG32 (O'Neill 2014): the same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) { next(); }
  std::uint32_t next();
  /// In [low, high).
  float uniform(float low, float high);
  /// In [0, count).
  std::uint32_t index(std::uint32_t count) { return next() % count; }

 private:
  std::uint64_t state_;
};

/// Builds a mesh. Everything is added in the current frame and with the current material; shapes
/// have outward counter-clockwise faces, also in a mirroring frame.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::string_view name) { mesh_.name = name; }

  MeshBuilder& use(std::uint32_t material);
  MeshBuilder& at(const Affine& frame);

  [[nodiscard]] const Affine& frame() const { return frame_; }

  std::uint32_t add_vertex(Vec3 position, Vec3 normal, Vec2 uv);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);

  /// The mesh so far; the builder is empty afterwards.
  [[nodiscard]] Mesh take();

 private:
  Mesh mesh_;
  Affine frame_;
  bool mirrored_ = false;
  std::uint32_t material_ = 0;
};

/// One mesh of a piece of furniture, with its position in the piece.
struct Part {
  std::uint32_t mesh = 0;
  Affine to_kit;
};

/// A piece of furniture, made once and placed as often as needed.
struct Kit {
  std::string name;
  std::vector<Part> parts;
};

/// Builds a scene.
class Stage {
 public:
  explicit Stage(std::string_view name) { scene.name = name; }

  std::uint32_t add(const Material& material);
  /// Drops texture coordinates that no material of the mesh reads.
  std::uint32_t add(Mesh mesh);
  /// Adds a repeating texture with its own image.
  [[nodiscard]] TextureSlot add(Image image);
  void place(std::uint32_t mesh, const Affine& to_world, std::string_view name);
  void place(const Kit& kit, const Affine& to_world);

  SceneDescription scene;
};

/// An opaque material with a colour as in `srgb`.
[[nodiscard]] Material matte(std::string_view name, std::uint32_t rgb, float roughness = 0.8f);

}  // namespace raysheaf::builtin
