// Selects the triangles that may be visible in an image, and packs their corners for one draw call.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "render/raster/gbuffer_body.h"
#include "render/raster/pack_body.h"
#include "scene/flat_scene.h"

namespace raysheaf {

class Executor;
class TextureSet;

inline constexpr std::uint32_t kFloatsPerTriangle = 9;

/// Culling here instead of by OpenGL halves the cost for a software rasterizer and the bytes sent
/// to any device, and needs one draw call, in the order of the triangles' numbers, regardless of
/// which sides they show. Kept between frames for its memory.
class TrianglePacker {
 public:
  /// Selects, out of `count` triangles from `first` on, those that face the eye as their flags
  /// require, have an area, and are not outside one of the frustum's sides. Returns how many.
  std::uint32_t choose(const Executor& executor, const FlatScene& scene, const PictureView& view,
                       std::uint32_t first, std::uint32_t count);

  /// Writes the corners of the selected triangles relative to the eye, nine floats per triangle, in
  /// the order of their numbers, and the numbers to `numbers`; both must have room for the number
  /// that `choose` returned.
  void pack(const Executor& executor, const FlatScene& scene, const PictureView& view,
            float* corners, std::uint32_t* numbers) const;
  /// The same with what a G-buffer shows, three corners a triangle.
  void pack(const Executor& executor, const FlatScene& scene, const TextureSet& textures,
            const PictureView& view, GbufferCorner* corners, std::uint32_t* numbers) const;

 private:
  /// `put(triangle, i)` for each of the chosen ones, the i-th of them.
  template <class Put>
  void for_each_chosen(const Executor& executor, const Put& put) const;

  std::vector<std::uint32_t> chosen_;  ///< a block's triangles, from the block's start on
  std::vector<std::uint32_t> starts_;  ///< of each block in the output; the total at the end
};

}  // namespace raysheaf
