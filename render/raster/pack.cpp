#include "render/raster/pack.h"

#include <algorithm>

#include "base/bits.h"
#include "exec/executor.h"
#include "render/raster/pack_body.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kTrianglesPerBlock = 2048;

}  // namespace

std::uint32_t TrianglePacker::choose(const Executor& executor, const FlatScene& scene,
                                     const PictureView& view, std::uint32_t first,
                                     std::uint32_t count) {
  const std::uint32_t blocks = div_ceil(count, kTrianglesPerBlock);
  chosen_.resize(std::max<std::size_t>(chosen_.size(), count));
  starts_.assign(blocks + std::size_t{1}, 0);
  const Vec3 eye = view.frame.eye;
  executor.for_each(blocks, 1, [&](std::size_t block) {
    const auto begin = static_cast<std::uint32_t>(block) * kTrianglesPerBlock;
    const std::uint32_t end = std::min(begin + kTrianglesPerBlock, count);
    std::uint32_t kept = begin;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t t = first + i;
      chosen_[kept] = t;
      const auto [a, b, c] = scene.corners(t);
      const bool shows = may_show(view, a - eye, b - eye, c - eye, scene.flags[t]);
      kept += shows && !has_no_area(a, b, c) ? 1 : 0;
    }
    starts_[block + 1] = kept - begin;
  });
  for (std::uint32_t block = 0; block < blocks; ++block) starts_[block + 1] += starts_[block];
  return starts_.back();
}

template <class Put>
void TrianglePacker::for_each_chosen(const Executor& executor, const Put& put) const {
  executor.for_each(starts_.size() - 1, 1, [&](std::size_t block) {
    const std::uint32_t start = starts_[block], kept = starts_[block + 1] - start;
    for (std::uint32_t i = 0; i < kept; ++i)
      put(chosen_[block * kTrianglesPerBlock + i], start + i);
  });
}

void TrianglePacker::pack(const Executor& executor, const FlatScene& scene, const PictureView& view,
                          float* floats, std::uint32_t* numbers) const {
  const Vec3 eye = view.frame.eye;
  for_each_chosen(executor, [&](std::uint32_t t, std::uint32_t i) {
    float* const out = floats + std::size_t{kFloatsPerTriangle} * i;
    const std::array<Vec3, 3> corners = scene.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = corners[k] - eye;
      out[3 * k] = p.x;
      out[3 * k + 1] = p.y;
      out[3 * k + 2] = p.z;
    }
    numbers[i] = t;
  });
}

void TrianglePacker::pack(const Executor& executor, const FlatScene& scene,
                          const TextureSet& textures, const PictureView& view,
                          GbufferCorner* corners, std::uint32_t* numbers) const {
  for_each_chosen(executor, [&](std::uint32_t t, std::uint32_t i) {
    const std::array<Vec3, 3> found = scene.corners(t);
    const Vec3 corner[3] = {found[0], found[1], found[2]};
    const Vec3 sight = sight_of_triangle(view.frame, corner[0]);
    const auto surface_in = [&](int k) {
      return surface_at(scene, textures, t, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f, sight);
    };
    make_gbuffer_corners(corner, view.frame.eye, surface_in, corners + std::size_t{3} * i);
    numbers[i] = t;
  });
}

}  // namespace raysheaf
