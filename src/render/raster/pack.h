// Chooses the triangles that a picture may show and packs their corners for one draw call.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "render/raster/pack_body.h"
#include "scene/flat_scene.h"

namespace raysheaf {

class Executor;

inline constexpr std::uint32_t kFloatsPerTriangle = 9;

/// Culling here rather than by OpenGL costs a software rasteriser half as much, sends half as many
/// bytes to any, and leaves one draw call in the order of the triangles' numbers, whatever sides
/// they show. Kept between frames for its memory.
class TrianglePacker {
 public:
  /// Of the `count` triangles from `first` on, chooses those that face the eye as their flags want,
  /// have an area, and do not lie outside one of the frustum's sides. Returns how many.
  std::uint32_t choose(const Executor& executor, const FlatScene& scene, const PictureView& view,
                       std::uint32_t first, std::uint32_t count);

  /// Writes the corners of the chosen ones relative to the eye, nine floats a triangle, in the
  /// order of their numbers, and these to `numbers`; both have room for what `choose` returned.
  void pack(const Executor& executor, const FlatScene& scene, const PictureView& view,
            float* corners, std::uint32_t* numbers) const;

 private:
  std::vector<std::uint32_t> chosen_;  ///< a block's triangles, from the block's start on
  std::vector<std::uint32_t> starts_;  ///< of each block in the output; the total at the end
};

}  // namespace raysheaf
