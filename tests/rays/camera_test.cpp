#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "render/rays/camera_rays.h"

namespace raysheaf {
namespace {

void expect_near(Vec3 found, Vec3 expected, float tolerance = 1e-6f) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

TEST(CameraRay, PerspectiveCornersFromTheTopLeft) {
  Camera camera;
  camera.y_fov = 2 * std::atan(0.5f);
  camera.z_near = 0.25f;
  camera.z_far = 40;
  const CameraFrame frame = make_camera_frame(camera, 4, 2);
  const Ray top_left = camera_ray(frame, 0, 0), bottom_right = camera_ray(frame, 3, 1);
  expect_near(top_left.origin, {0, 0, 0});
  expect_near(top_left.direction, {-0.75f, 0.25f, -1});
  expect_near(bottom_right.direction, {0.75f, -0.25f, -1});
  EXPECT_EQ(top_left.t_min, 0.25f);
  EXPECT_EQ(top_left.t_max, 40);
}

TEST(CameraRay, OrthographicRaysAreParallel) {
  Camera camera;
  camera.to_world = translation({10, 20, 30});
  camera.orthographic = true;
  camera.y_mag = 2;
  const CameraFrame frame = make_camera_frame(camera, 4, 2);
  expect_near(camera_ray(frame, 0, 0).origin, {7, 21, 30});
  expect_near(camera_ray(frame, 3, 1).origin, {13, 19, 30});
  expect_near(camera_ray(frame, 0, 0).direction, {0, 0, -1});
  expect_near(camera_ray(frame, 3, 1).direction, {0, 0, -1});
}

TEST(CameraRay, TheMiddlePixelLooksAlongTheAxis) {
  Camera camera;
  camera.to_world = look_at({1, 2, 3}, {4, -1, 7}, {0, 1, 0});
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    const Ray ray = camera_ray(make_camera_frame(camera, 333, 77), 166, 38);
    expect_near(ray.origin, {1, 2, 3});
    expect_near(ray.direction, normalized(Vec3{3, -3, 4}));
  }
}

TEST(CameraRay, TIsTheDepth) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> any(-5, 5);
  for (int i = 0; i < 500; ++i) {
    Camera camera;
    camera.to_world = look_at({any(engine), any(engine), any(engine)},
                              {any(engine), any(engine), any(engine)}, {0, 1, 0});
    camera.orthographic = i % 2 == 0;
    const CameraFrame frame = make_camera_frame(camera, 100, 60);
    const Ray ray = camera_ray(frame, static_cast<std::uint32_t>(i * 7 % 100),
                               static_cast<std::uint32_t>(i * 11 % 60));
    const Vec3 p = ray.origin + ray.direction * 7;
    EXPECT_NEAR(dot(p - frame.eye, frame.forward), 7, 1e-4f);
  }
}

TEST(CameraRay, TheScaleOfTheCameraDoesNotMatter) {
  Camera camera;
  camera.to_world = look_at({1, 2, 3}, {4, -1, 7}, {0, 1, 0});
  const CameraFrame plain = make_camera_frame(camera, 50, 40);
  for (const Vec3 scale : {Vec3{3, 0.1f, 7}, Vec3{1e-30f, 1e30f, 1}, Vec3{1e18f, 1e-25f, 1e25f}}) {
    Camera scaled = camera;
    scaled.to_world = compose(camera.to_world, scaling(scale));
    const CameraFrame frame = make_camera_frame(scaled, 50, 40);
    expect_near(camera_ray(frame, 7, 9).direction, camera_ray(plain, 7, 9).direction);
  }
}

TEST(CameraRay, PixelsAreEvenlySpacedAndSymmetric) {
  for (const std::uint32_t count : {1u, 2u, 3u, 512u, 16384u}) {
    for (std::uint32_t i = 0; i < count; ++i) {
      EXPECT_EQ(pixel_center(i, count), -pixel_center(count - 1 - i, count));
      EXPECT_NEAR(pixel_center(i, count), (2.0 * i + 1) / count - 1, 6e-8);
    }
  }
}

TEST(CameraRays, AreThoseOfEachPixel) {
  Camera camera;
  camera.to_world = look_at({1, 2, 3}, {4, -1, 7}, {0, 1, 0});
  camera.z_near = 0.5f;
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    for (const float lens : {0.0f, 0.25f}) {
      CameraFrame frame = moved_by_pixels(make_camera_frame(camera, 37, 23), {0.25f, -0.4f});
      frame.lens_radius = lens;
      const CameraRays rays(frame);
      for (std::uint32_t pixel = 0; pixel < 37 * 23; ++pixel) {
        const Ray found = rays.at(pixel % 37, pixel / 37);
        const Ray expected = camera_ray(frame, pixel % 37, pixel / 37);
        ASSERT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << pixel;
      }
    }
  }
}

}  // namespace
}  // namespace raysheaf
