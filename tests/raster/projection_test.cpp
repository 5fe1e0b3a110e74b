#include "render/raster/projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "exec/executor.h"
#include "pictures.h"
#include "render/raster/pack.h"
#include "render/raster/pixel_range.h"

namespace raysheaf::test {
namespace {

struct Clip {
  double x, y, z, w;
};

/// Projects the point at `t` in binary64, so that only the matrix's rounding shows.
Clip project(const ClipMatrix& m, const CameraFrame& frame, const Ray& ray, double t) {
  const double x = double{ray.origin.x} - frame.eye.x + t * ray.direction.x;
  const double y = double{ray.origin.y} - frame.eye.y + t * ray.direction.y;
  const double z = double{ray.origin.z} - frame.eye.z + t * ray.direction.z;
  const auto at = [&](std::size_t r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  return {at(0), at(1), at(2), at(3)};
}

Camera random_camera(Random& random) {
  Camera camera = camera_at(random.in_box(10), random.in_box(10));
  Affine warp = scaling({random.between(0.1f, 5), random.between(-5, -0.1f), random.between(1, 2)});
  warp.m[0][1] = random.between(-0.3f, 0.3f);
  warp.m[2][0] = random.between(-0.3f, 0.3f);
  camera.to_world = compose(camera.to_world, warp);
  camera.orthographic = random.below(2) == 0;
  camera.y_fov = random.between(0.3f, 2.5f);
  camera.y_mag = random.between(0.1f, 50);
  camera.z_near = random.between(0.01f, 1);
  if (random.below(2) == 0) camera.z_far = random.between(2, 100);
  return camera;
}

TEST(Projection, PointsOnAPixelsRayLandOnItsCentre) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = random_camera(random);
    const std::uint32_t width = 200 + random.below(1000), height = 200 + random.below(1000);
    const CameraFrame frame = make_camera_frame(camera, width, height);
    const std::uint32_t x = random.below(width), y = random.below(height);
    // Depths at which the image's extent is not lost to rounding.
    const float deep = frame.z_near + (camera.orthographic ? 20 * camera.y_mag : 1000);
    const float t = random.between(frame.z_near, std::min(frame.z_far, deep));
    const Clip clip = project(clip_matrix(frame, 2000), frame, camera_ray(frame, x, y), t);
    EXPECT_NEAR((clip.x / clip.w + 1) / 2 * width, x + 0.5, 5e-3);
    EXPECT_NEAR((clip.y / clip.w + 1) / 2 * height, y + 0.5, 5e-3);
    EXPECT_GE(clip.z / clip.w, -1e-5);
    EXPECT_LE(clip.z / clip.w, 1 + 1e-5);
  }
}

TEST(Projection, DepthIsReversedFromOneAtNearToZeroAtFar) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Camera camera = random_camera(random);
    const CameraFrame frame = make_camera_frame(camera, 64, 64);
    const Ray ray = camera_ray(frame, 3, 40);
    const auto depth = [&](double t) {
      const Clip clip = project(clip_matrix(frame, 500), frame, ray, t);
      return clip.z / clip.w;
    };
    EXPECT_NEAR(depth(frame.z_near), 1, 1e-4);
    if (std::isfinite(frame.z_far)) {
      EXPECT_NEAR(depth(frame.z_far), 0, 1e-4);
    }
    EXPECT_GT(depth(1), depth(1.5));
  }
}

TEST(Projection, FarthestDepthReachesEveryCorner) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const CameraFrame frame = make_camera_frame(random_camera(random), 8, 8);
    const Vec3 center = random.in_box(20), half = abs(random.in_box(9));
    const float farthest = farthest_depth(frame, {center - half, center + half});
    const ClipMatrix clip = clip_matrix(frame, farthest);
    for (int k = 0; k < 8; ++k) {
      const Vec3 p =
          center + half * Vec3{k & 1 ? 1.f : -1.f, k & 2 ? 1.f : -1.f, k & 4 ? 1.f : -1.f};
      if (frame.orthographic && std::isinf(frame.z_far)) {
        EXPECT_GE(project(clip, frame, {frame.eye, 0, p - frame.eye}, 1).z, -1e-4);
      }
    }
  }
  EXPECT_EQ(farthest_depth(make_camera_frame(Camera{}, 8, 8), {{-1, -1, 1}, {1, 1, 2}}), 0);
}

/// Every visible triangle is packed, and numbers are in ascending order.
TEST(TrianglePacker, KeepsVisibleTriangles) {
  Random random(4);
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const MadeScene scene = soup(5000, 0.2f, seed);
    Camera camera = camera_at(random.in_box(1.5f), random.in_box(1));
    camera.orthographic = seed % 2 == 0;
    const CameraFrame frame = make_camera_frame(camera, 40, 30);
    const PictureView view = make_picture_view(frame, scene.bounds);
    TrianglePacker packer;
    const std::uint32_t first = 100, count = scene.triangle_count - first;
    const std::uint32_t kept = packer.choose(Executor(2), scene, view, first, count);
    ASSERT_LT(kept, count);
    std::vector<float> corners(std::size_t{kept} * kFloatsPerTriangle);
    std::vector<std::uint32_t> numbers(kept);
    packer.pack(Executor(2), scene, view, corners.data(), numbers.data());

    EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
    for (const std::uint32_t id : cast(scene, camera, 40, 30)) {
      if (id == kInvalidId || id < first) continue;
      EXPECT_TRUE(std::binary_search(numbers.begin(), numbers.end(), id)) << id;
    }
    for (std::uint32_t i = 0; i < kept; ++i) {
      EXPECT_EQ(corners[9 * i + 5], scene.corners(numbers[i])[1].z - frame.eye.z);
    }
  }
}

TEST(PixelRange, HoldsEveryPixelWhoseRayMeetsTheTriangle) {
  Random random(5);
  std::uint64_t pixels = 0, hits = 0;
  for (int i = 0; i < 300; ++i) {
    Camera camera = random_camera(random);
    camera.z_near = 0, camera.z_far = std::numeric_limits<float>::infinity();
    const CameraFrame frame = make_camera_frame(camera, 1 + random.below(60), 1 + random.below(60));
    const float size = i % 2 == 0 ? 0.5f : 15;
    const Ray middle = camera_ray(frame, frame.width / 2, frame.height / 2);
    const Vec3 a = middle.origin + middle.direction * random.between(0, 20) + random.in_box(1);
    const Vec3 b = a + random.in_box(size), c = a + random.in_box(size);
    const PixelRange range =
        pixel_range(frame, clip_matrix(frame, 100), a - frame.eye, b - frame.eye, c - frame.eye);
    pixels += static_cast<std::uint64_t>(range.area());
    for (std::int32_t y = 0; y < static_cast<std::int32_t>(frame.height); ++y) {
      for (std::int32_t x = 0; x < static_cast<std::int32_t>(frame.width); ++x) {
        TriangleHit hit;
        if (!intersect_triangle(make_ray_setup(camera_ray(frame, x, y)), a, b, c, &hit)) continue;
        ++hits;
        ASSERT_GE(hit.t, range.nearest);
        ASSERT_TRUE(x >= range.x0 && x <= range.x1 && y >= range.y0 && y <= range.y1);
      }
    }
  }
  EXPECT_GT(hits, 1000u);
  EXPECT_LT(pixels, 8 * hits);  // and not absurdly many
}

}  // namespace
}  // namespace raysheaf::test
