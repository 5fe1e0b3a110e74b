#include "render/raster/resolve.h"

#include <algorithm>
#include <vector>

#include "exec/executor.h"
#include "render/raster/resolve_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kTriangleGrain = 1024, kAroundGrain = 256;

struct FlatTriangles {
  const FlatScene* scene;
  [[nodiscard]] Vec3 corner(std::uint32_t triangle, int k) const {
    return scene->corners(triangle)[static_cast<std::size_t>(k)];
  }
  [[nodiscard]] std::uint8_t flags_of(std::uint32_t triangle) const {
    return scene->flags[triangle];
  }
};

/// The pixels whose rays do not hit their triangle, row by row.
std::vector<std::uint32_t> look_at_borders(const Executor& executor,
                                           const Resolve<FlatTriangles>& resolve) {
  const std::size_t width = resolve.view.frame.width;
  std::vector<std::vector<std::uint32_t>> of_rows(resolve.view.frame.height);
  executor.for_each(of_rows.size(), 1, [&](std::size_t y) {
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel)
      if (look_at_border(resolve, pixel)) of_rows[y].push_back(static_cast<std::uint32_t>(pixel));
  });
  std::vector<std::uint32_t> lost;
  for (const auto& row : of_rows) lost.insert(lost.end(), row.begin(), row.end());
  return lost;
}

/// Tests pixels around those that changed, until none changes any more.
void look_around_changes(const Executor& executor, const Resolve<FlatTriangles>& resolve,
                         View<std::uint32_t> shown) {
  const std::uint32_t width = resolve.view.frame.width, height = resolve.view.frame.height;
  std::vector<std::uint32_t> changed, around, next;
  for (std::size_t i = 0; i < shown.size; ++i)
    if (shown[i] != resolve.before[i]) changed.push_back(static_cast<std::uint32_t>(i));
  std::vector<bool> is_listed(shown.size);
  while (!changed.empty()) {
    around.clear();
    for (const std::uint32_t pixel : changed) {
      const std::uint32_t x = pixel % width, y = pixel / width;
      for (std::uint32_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, height - 1); ++j) {
        for (std::uint32_t i = x > 0 ? x - 1 : 0; i <= std::min(x + 1, width - 1); ++i) {
          const std::uint32_t near = j * width + i;
          if (!is_listed[near]) around.push_back(near);
          is_listed[near] = true;
        }
      }
    }
    next.resize(around.size());
    executor.for_each(around.size(), kAroundGrain, [&](std::size_t i) {
      next[i] = look_around(resolve, View<const std::uint32_t>(shown.data, shown.size), around[i]);
    });
    changed.clear();
    for (std::size_t i = 0; i < around.size(); ++i) {
      const std::uint32_t pixel = around[i];
      is_listed[pixel] = false;
      if (next[i] != shown[pixel]) changed.push_back(pixel);
      shown[pixel] = next[i];
    }
  }
}

/// `triangle_at(i)`, for i below `count`, are all triangles that may be visible.
template <class TriangleAt>
void resolve(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
             std::size_t count, const TriangleAt& triangle_at, View<std::uint32_t> triangles) {
  if (!(frame.z_far > frame.z_near)) return;
  const std::vector<std::uint32_t> before(triangles.begin(), triangles.end());
  std::vector<SightKey> sight(triangles.size, kNotLooked);
  const Resolve<FlatTriangles> resolve{make_picture_view(frame, scene.bounds),
                                       {&scene},
                                       View<const std::uint32_t>(before),
                                       sight.data()};
  const std::vector<std::uint32_t> lost = look_at_borders(executor, resolve);
  executor.for_each(count, kTriangleGrain, [&](std::size_t i) {
    look_for(resolve, View<const std::uint32_t>(lost), triangle_at(i));
  });
  executor.for_each(triangles.size, kCopyGrain,
                    [&](std::size_t i) { triangles[i] = resolved_pixel(before[i], sight[i]); });
  look_around_changes(executor, resolve, triangles);
}

}  // namespace

void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<const std::uint32_t> drawn, View<std::uint32_t> triangles) {
  resolve(
      executor, scene, frame, drawn.size, [&](std::size_t i) { return drawn[i]; }, triangles);
}

void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<std::uint32_t> triangles) {
  resolve(
      executor, scene, frame, scene.triangle_count,
      [](std::size_t i) { return static_cast<std::uint32_t>(i); }, triangles);
}

}  // namespace raysheaf
