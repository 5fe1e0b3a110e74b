#include "raster/pack.h"

#include <algorithm>

#include "base/bits.h"
#include "exec/executor.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kBlock = 2048;

/// Sides of the frustum that a point relative to the eye is outside of, a bit each. Points behind a
/// perspective eye may be outside of all.
std::uint32_t outside(const ClipMatrix& m, Vec3 p) {
  const float x = m[0] * p.x + m[4] * p.y + m[8] * p.z;
  const float y = m[1] * p.x + m[5] * p.y + m[9] * p.z;
  const float z = m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14];
  const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
  return std::uint32_t{x > w} | std::uint32_t{x < -w} << 1 | std::uint32_t{y > w} << 2 |
         std::uint32_t{y < -w} << 3 | std::uint32_t{z > w} << 4 | std::uint32_t{z < 0} << 5;
}

/// Six times the volume of the tetrahedron of eye and triangle; orthographic: of a prism along the
/// view. Negative where the corners run counter-clockwise for the eye. In binary64 the products
/// keep nearly all their bits, so the sign errs only where no ray could tell either.
double facing(const CameraFrame& frame, Vec3 a, Vec3 b, Vec3 c) {
  const double ab[3] = {double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z};
  const double ac[3] = {double{c.x} - a.x, double{c.y} - a.y, double{c.z} - a.z};
  const Vec3 along = frame.orthographic ? frame.forward : a;
  return along.x * (ab[1] * ac[2] - ab[2] * ac[1]) + along.y * (ab[2] * ac[0] - ab[0] * ac[2]) +
         along.z * (ab[0] * ac[1] - ab[1] * ac[0]);
}

bool may_show(const PackView& view, Vec3 a, Vec3 b, Vec3 c, std::uint8_t flags) {
  const double side = facing(view.frame, a, b, c);
  const bool front = (flags & kMirrored) != 0 ? side > 0 : side < 0;
  const bool faces = front || ((flags & kSingleSided) == 0 && (side < 0 || side > 0));
  return faces && (outside(view.clip, a) & outside(view.clip, b) & outside(view.clip, c)) == 0;
}

}  // namespace

std::uint32_t TrianglePacker::choose(const Executor& executor, const FlatScene& scene,
                                     const PackView& view, std::uint32_t first,
                                     std::uint32_t count) {
  const std::uint32_t blocks = div_ceil(count, kBlock);
  chosen_.resize(std::max<std::size_t>(chosen_.size(), count));
  starts_.assign(blocks + std::size_t{1}, 0);
  const Vec3 eye = view.frame.eye;
  executor.for_each(blocks, 1, [&](std::size_t block) {
    const auto begin = static_cast<std::uint32_t>(block) * kBlock;
    const std::uint32_t end = std::min(begin + kBlock, count);
    std::uint32_t kept = begin;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t t = first + i;
      chosen_[kept] = t;
      kept += may_show(view, scene.corner(t, 0) - eye, scene.corner(t, 1) - eye,
                       scene.corner(t, 2) - eye, scene.flags[t])
                  ? 1
                  : 0;
    }
    starts_[block + 1] = kept - begin;
  });
  for (std::uint32_t block = 0; block < blocks; ++block) starts_[block + 1] += starts_[block];
  return starts_.back();
}

void TrianglePacker::pack(const Executor& executor, const FlatScene& scene, const PackView& view,
                          float* corners, std::uint32_t* numbers) const {
  const Vec3 eye = view.frame.eye;
  executor.for_each(starts_.size() - 1, 1, [&](std::size_t block) {
    const std::uint32_t start = starts_[block], kept = starts_[block + 1] - start;
    for (std::uint32_t i = 0; i < kept; ++i) {
      const std::uint32_t t = chosen_[block * kBlock + i];
      float* const out = corners + std::size_t{kFloatsPerTriangle} * (start + i);
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = scene.corner(t, k) - eye;
        out[3 * k] = p.x;
        out[3 * k + 1] = p.y;
        out[3 * k + 2] = p.z;
      }
      numbers[start + i] = t;
    }
  });
}

}  // namespace raysheaf
