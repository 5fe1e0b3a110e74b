// A scene as OpenGL draws it while the camera moves: triangles in world space, one colour or one
// small texture for each material.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::viewer {

struct PreviewVertex {
  Vec3 position;                        ///< world space
  std::array<std::int8_t, 4> normal{};  ///< 127 is 1; 0: the face's normal is used
  Vec2 uv;
  std::array<std::uint8_t, 4> color{};  ///< square roots of linear values; 255 is 1
};

/// Triangles close together, which are drawn if their box may show.
struct PreviewGroup {
  std::uint32_t first = 0, count = 0;  ///< of `PreviewMesh::indices`
  Box box;
};

/// Triangles of one material.
struct PreviewDraw {
  std::vector<PreviewGroup> groups;    ///< consecutive
  std::uint32_t texture = kInvalidId;  ///< index into `PreviewMesh::textures`
  Vec3 color{1, 1, 1};                 ///< linear
  Vec3 emission{0, 0, 0};
  float alpha_cutoff = 0;
  bool unlit = false, double_sided = false;
  bool see_through = false;  ///< glass
};

struct PreviewTexture {
  Image image;  ///< sRGB, at most `kPreviewTextureSide` pixels wide and high
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
};

struct PreviewMesh {
  double time_s = 0;  ///< of moving scenes
  std::uint32_t clip = 0;
  std::vector<PreviewVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three for each triangle
  std::vector<PreviewDraw> draws;
  std::vector<PreviewTexture> textures;
};

inline constexpr std::uint32_t kPreviewTextureSide = 512;
/// Most triangles of a group; a group has triangles of one instance.
inline constexpr std::uint32_t kPreviewGroup = 2048;
/// Scenes with more triangles have no preview, because it would need too much memory.
inline constexpr std::uint64_t kMostPreviewTriangles = 4'000'000;

/// The scene as it is posed now. Empty (without triangles) for scenes with too many triangles.
[[nodiscard]] PreviewMesh preview_mesh(const SceneDescription& scene);

}  // namespace raysheaf::viewer
