// Scenes made by hand, random triangles, and brute force answers for rasterised images.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "intersect/triangle_body.h"
#include "raysheaf/error.h"
#include "render/raster/rasterizer.h"
#include "render/rays/camera_body.h"
#include "scene/flat_scene.h"
#include "scene/flatten_body.h"
#include "support/random.h"

namespace raysheaf::test {

/// A flat scene of one mesh, made triangle by triangle.
struct MadeScene : FlatScene {
  std::vector<Vec3> corners_in_order;  ///< three a triangle
};

inline void add(MadeScene& scene, Vec3 a, Vec3 b, Vec3 c, std::uint8_t flags = 0) {
  for (const Vec3 corner : {a, b, c}) {
    scene.corners_in_order.push_back(corner);
    scene.bounds.min = min(scene.bounds.min, corner);
    scene.bounds.max = max(scene.bounds.max, corner);
  }
  scene.flags.push_back(flags);
  scene.mesh_of_triangle.push_back(0);
  PlacedInstance all;
  all.positions = View<const Vec3>(scene.corners_in_order);
  all.triangle_count = ++scene.triangle_count;
  scene.placed.list({all});
}

/// Triangles of about `size` in the cube [-1, 1]^3 moved to `center`, with any flags.
inline MadeScene soup(std::uint32_t count, float size, std::uint32_t seed, Vec3 center = {}) {
  MadeScene scene;
  Random random(seed);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 a = center + random.in_box(1);
    const Vec3 b = a + random.in_box(size), c = a + random.in_box(size);
    add(scene, a, b, c, static_cast<std::uint8_t>(random.below(4)));
  }
  return scene;
}

/// Each pixel's closest triangle by brute force: the smallest (t, number).
inline std::vector<std::uint32_t> cast(const FlatScene& scene, const Camera& camera,
                                       std::uint32_t width, std::uint32_t height) {
  const CameraFrame frame = make_camera_frame(camera, width, height);
  std::vector<std::uint32_t> picture;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const RaySetup setup = make_ray_setup(camera_ray(frame, x, y));
      float t = std::numeric_limits<float>::infinity();
      std::uint32_t nearest = kInvalidId;
      for (std::uint32_t i = 0; i < scene.triangle_count; ++i) {
        TriangleHit hit;
        const auto [a, b, c] = scene.corners(i);
        if (has_no_area(a, b, c) || !intersect_triangle(setup, a, b, c, &hit)) continue;
        const bool front = hit.front != ((scene.flags[i] & kMirrored) != 0);
        if (!front && (scene.flags[i] & kSingleSided) != 0) continue;
        if (hit.t < t) t = hit.t, nearest = i;
      }
      picture.push_back(nearest);
    }
  }
  return picture;
}

/// Whether all pixels around (x, y) have the same id.
inline bool is_interior(const std::vector<std::uint32_t>& picture, std::uint32_t width,
                        std::uint32_t height, std::uint32_t x, std::uint32_t y) {
  std::set<std::uint32_t> ids;
  for (std::uint32_t j = y > 0 ? y - 1 : 0; j <= y + 1 && j < height; ++j) {
    for (std::uint32_t i = x > 0 ? x - 1 : 0; i <= x + 1 && i < width; ++i) {
      ids.insert(picture[j * width + i]);
    }
  }
  return ids.size() == 1;
}

struct Difference {
  std::uint32_t pixels = 0;    ///< how many differ
  std::uint32_t interior = 0;  ///< how many of them are away from every border in `expected`
};

inline Difference compare(const std::vector<std::uint32_t>& expected,
                          const std::vector<std::uint32_t>& found, std::uint32_t width,
                          std::uint32_t height) {
  Difference difference;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      if (expected[y * width + x] == found[y * width + x]) continue;
      ++difference.pixels;
      if (is_interior(expected, width, height, x, y)) ++difference.interior;
    }
  }
  return difference;
}

inline Camera camera_at(Vec3 eye, Vec3 target) {
  Camera camera;
  camera.to_world = look_at(eye, target, {0, 1, 0});
  return camera;
}

/// Whether OpenGL is available.
inline bool has_graphics() {
  try {
    const Rasterizer rasterizer;
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace raysheaf::test

#define RAYSHEAF_GRAPHICS_OR_SKIP() \
  if (!raysheaf::test::has_graphics()) GTEST_SKIP() << "no OpenGL 4.5 context here"
