// Primary visibility by OpenGL: the triangle that each pixel sees.
//
// A visibility buffer (C. Burns, W. Hunt, "The Visibility Buffer: A Cache-Friendly Approach to
// Deferred Shading", JCGT 2(2), 2013): triangle numbers and depth are rasterized, attributes are
// fetched afterwards.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/raster/slot_picture.h"
#include "render/rays/camera_body.h"

namespace raysheaf {

class Executor;
class TextureSet;
struct FlatScene;
struct Gbuffer;

/// Asks for the paper's four targets, which are then drawn in place of numbers.
struct GbufferRequest {
  const TextureSet& textures;  ///< of the scene
  Gbuffer* targets;            ///< take the picture's; not where a device took the picture
};

/// Owns a headless OpenGL context and the buffers that are reused from frame to frame. Any thread
/// may call it, one at a time; do not call it from within an `Executor` loop.
class Rasterizer {
 public:
  /// Throws `Error` (kNoGraphics) if no OpenGL 4.5 core context is available; see `EglContext`.
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;
  Rasterizer& operator=(Rasterizer&&) noexcept;

  /// The driver's renderer and version strings.
  [[nodiscard]] std::string description() const;

  /// For each pixel, in rows from the top, the number in `scene` of the triangle nearest to the
  /// camera, or kInvalidId. Single-sided triangles do not show their backs. Among triangles at
  /// the same depth, the least number wins, if OpenGL computes the same depth for them. OpenGL
  /// moves vertices to a grid of 1/256 pixel, so that along silhouettes a pixel may belong to a
  /// triangle which `camera_ray` misses by so much: `resolve_silhouettes` sets that right.
  /// `device`, if there is one, may draw its own triangles, which are the scene's, and take the
  /// picture from OpenGL's memory: then nothing is returned.
  /// `drawn`, if there is one, takes the triangles that might show, ascending: those that face the
  /// eye as they want, have an area, and do not lie outside of one of the frustum's sides.
  /// `gbuffer`, if there is one: with the same pictures. Colours and normals are those in the
  /// triangles' corners, textures included, and OpenGL's interpolation between them.
  /// O(triangles + pixels). Throws `Error`: kInvalidArgument for an empty picture, kUnsupported for
  /// one larger than the driver's targets, kOutOfMemory.
  [[nodiscard]] std::vector<std::uint32_t> visible_triangles(
      const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
      SlotDevice* device = nullptr, std::vector<std::uint32_t>* drawn = nullptr,
      const GbufferRequest* gbuffer = nullptr);

  /// The number of triangles drawn for the last picture.
  [[nodiscard]] std::uint64_t drawn_triangles() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raysheaf
