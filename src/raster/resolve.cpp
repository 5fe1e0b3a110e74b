#include "raster/resolve.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "exec/executor.h"
#include "raster/pack_body.h"
#include "raster/pixel_range.h"
#include "raster/resolve_body.h"

namespace raysheaf {
namespace {

/// Triangles that span no more pixels than this are tested with all of them.
constexpr std::int64_t kFewPixels = 16;
constexpr std::size_t kTriangleGrain = 1024;

/// A pixel whose ray does not hit what it held.
struct LostPixel {
  std::uint32_t x;
  RaySetup ray;
};

class Resolver {
 public:
  Resolver(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
           View<std::uint32_t> picture)
      : executor_(executor),
        scene_(scene),
        view_(make_picture_view(frame, scene.bounds)),
        before_(picture.begin(), picture.end()),
        sight_(picture.size, kNotLooked),
        lost_(frame.height) {}

  void resolve(View<std::uint32_t> picture) {
    const std::uint32_t width = view_.frame.width;
    executor_.for_each(lost_.size(), 1, [&](std::size_t y) { look_at_borders_of(y); });
    executor_.for_each(scene_.triangle_count, kTriangleGrain, [&](std::size_t triangle) {
      look_for(static_cast<std::uint32_t>(triangle));
    });
    executor_.for_each(picture.size, std::size_t{16} * width, [&](std::size_t i) {
      if (sight_[i] != kNotLooked) picture[i] = triangle_of(sight_[i]);
    });
  }

 private:
  [[nodiscard]] RaySetup ray(std::uint32_t x, std::uint32_t y) const {
    return make_ray_setup(camera_ray(view_.frame, x, y));
  }

  /// A pixel amid eight like it is deep in its triangle, which is convex. At the picture's edge
  /// there is no telling.
  void look_at_borders_of(std::size_t row) {
    const std::uint32_t width = view_.frame.width, height = view_.frame.height;
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < width; ++x) {
      const bool at_edge = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
      if (!at_edge && is_uniform(&before_[row * width + x], width)) continue;
      look_at(neighbourhood(before_, width, height, x, y), x, y);
    }
  }

  void look_at(const Neighbourhood& near, std::uint32_t x, std::uint32_t y) {
    const RaySetup setup = ray(x, y);
    SightKey nearest = kSeesNothing;
    for (std::uint32_t i = 0; i < near.count; ++i) {
      if (near.ids[i] == kInvalidId) continue;
      const SightKey seen = look(scene_, setup, near.ids[i]);
      nearest = std::min(nearest, seen);
      if (i == 0 && seen == kSeesNothing) lost_[y].push_back({x, setup});
    }
    sight_[std::size_t{y} * view_.frame.width + x] = nearest;
  }

  /// Lets the pixels that may have missed a triangle look for it.
  void look_for(std::uint32_t triangle) {
    const Vec3 eye = view_.frame.eye;
    const Vec3 a = scene_.corner(triangle, 0) - eye, b = scene_.corner(triangle, 1) - eye,
               c = scene_.corner(triangle, 2) - eye;
    if (!may_show(view_, a, b, c, scene_.flags[triangle])) return;
    const PixelRange range = pixel_range(view_.frame, view_.clip, a, b, c);
    if (range.is_empty()) return;
    const bool few = range.area() <= kFewPixels;
    for (auto y = static_cast<std::uint32_t>(range.y0); y <= static_cast<std::uint32_t>(range.y1);
         ++y) {
      if (few) {
        look_from_row(triangle, range, y);
      } else {
        look_from_lost(triangle, range, y);
      }
    }
  }

  void look_from_row(std::uint32_t triangle, const PixelRange& range, std::uint32_t y) {
    for (auto x = static_cast<std::uint32_t>(range.x0); x <= static_cast<std::uint32_t>(range.x1);
         ++x) {
      const std::size_t i = std::size_t{y} * view_.frame.width + x;
      if (before_[i] == triangle) continue;
      const SightKey known = std::atomic_ref<SightKey>(sight_[i]).load(std::memory_order_relaxed);
      if (known != kNotLooked && distance_of(known) < range.nearest) continue;
      const RaySetup setup = ray(x, y);
      const SightKey seen = look(scene_, setup, triangle);
      if (seen == kSeesNothing) continue;
      // Whatever is known already stands for what the pixel held, too.
      const bool look_at_held = known == kNotLooked && before_[i] != kInvalidId;
      note(i, look_at_held ? std::min(seen, look(scene_, setup, before_[i])) : seen);
    }
  }

  void look_from_lost(std::uint32_t triangle, const PixelRange& range, std::uint32_t y) {
    const std::vector<LostPixel>& lost = lost_[y];
    const auto first =
        std::lower_bound(lost.begin(), lost.end(), static_cast<std::uint32_t>(range.x0),
                         [](const LostPixel& pixel, std::uint32_t x) { return pixel.x < x; });
    for (auto p = first; p != lost.end() && p->x <= static_cast<std::uint32_t>(range.x1); ++p) {
      note(std::size_t{y} * view_.frame.width + p->x, look(scene_, p->ray, triangle));
    }
  }

  /// The least of all notes stays, whatever their order.
  void note(std::size_t pixel, SightKey seen) {
    const std::atomic_ref<SightKey> sight(sight_[pixel]);
    SightKey held = sight.load(std::memory_order_relaxed);
    while (seen < held && !sight.compare_exchange_weak(held, seen, std::memory_order_relaxed)) {
    }
  }

  const Executor& executor_;
  const FlatScene& scene_;
  const PictureView view_;
  const std::vector<std::uint32_t> before_;
  std::vector<SightKey> sight_;
  std::vector<std::vector<LostPixel>> lost_;  ///< a row each, from left to right
};

}  // namespace

void resolve_silhouettes(const Executor& executor, const FlatScene& scene, const CameraFrame& frame,
                         View<std::uint32_t> triangles) {
  if (!(frame.z_far > frame.z_near)) return;
  Resolver(executor, scene, frame, triangles).resolve(triangles);
}

}  // namespace raysheaf
