// The viewer's camera: what stays in place when it moves.
#include <gtest/gtest.h>

#include <random>

#include "camera_rig.h"
#include "projection.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr Box kBounds{{-4, -1, -3}, {5, 6, 7}};

Camera looking(Vec3 eye, Vec3 at, Vec3 up) {
  const Vec3 back = normalized(eye - at), right = normalized(cross(up, back));
  Camera camera;
  set_column(camera.to_world, 0, right);
  set_column(camera.to_world, 1, cross(back, right));
  set_column(camera.to_world, 2, back);
  set_column(camera.to_world, 3, eye);
  return camera;
}

void expect_near(Vec3 a, Vec3 b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_orthonormal(const Affine& a) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(dot(column(a, i), column(a, j)), i == j ? 1 : 0, 1e-4f);
  }
  EXPECT_GT(dot(cross(column(a, 0), column(a, 1)), column(a, 2)), 0.99f);
}

TEST(Rig, TakesACameraAsItIs) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> in(-3, 3);
  for (const UpAxis up : {UpAxis::kY, UpAxis::kZ}) {
    for (int i = 0; i < 50; ++i) {
      const Vec3 tilted{in(random), in(random), in(random)};
      const Camera camera =
          looking({in(random), in(random), in(random)}, {in(random), in(random), 9}, tilted);
      CameraRig rig(camera, kBounds, up);
      expect_near(column(rig.camera().to_world, 0), column(camera.to_world, 0), 0);
      rig.look(0, 0);  // recomputed from angles
      for (std::size_t c = 0; c < 4; ++c)
        expect_near(column(rig.camera().to_world, c), column(camera.to_world, c), 2e-3f);
      expect_orthonormal(rig.camera().to_world);
    }
  }
}

TEST(Rig, OrbitKeepsThePivotInTheMiddleAndAtItsDistance) {
  CameraRig rig(looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), kBounds, UpAxis::kY);
  const Vec3 pivot = rig.pivot();
  const float distance = length(rig.eye() - pivot);
  for (int i = 0; i < 40; ++i) {
    rig.orbit(0.37f, i % 7 < 3 ? 0.3f : -0.21f);
    expect_near(rig.pivot(), pivot, 1e-3f);
    EXPECT_NEAR(length(rig.eye() - pivot), distance, 1e-3f);
    const auto spot = project(rig.camera(), 1.5f, pivot, pivot);
    ASSERT_TRUE(spot);
    EXPECT_NEAR(spot->from.x, 0.5f, 1e-3f);
    EXPECT_NEAR(spot->from.y, 0.5f, 1e-3f);
    EXPECT_LT(std::fabs(rig.pitch()), kPi / 2);
    expect_orthonormal(rig.camera().to_world);
  }
}

TEST(Rig, LookKeepsTheEyeAndFlyTheDirection) {
  CameraRig rig(looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), kBounds, UpAxis::kY);
  const Vec3 eye = rig.eye();
  rig.look(1, -0.4f);
  expect_near(rig.eye(), eye, 0);
  const Vec3 ahead = rig.forward();
  rig.fly(2, 0, 0);
  expect_near(rig.forward(), ahead, 0);
  expect_near(rig.eye(), eye + ahead * 2, 1e-5f);
}

TEST(Rig, ZoomStopsBeforeThePivotAndPanFollowsTheHand) {
  CameraRig rig(looking({0, 0, 10}, {0, 0, 0}, {0, 1, 0}), kBounds, UpAxis::kY);
  const Vec3 pivot = rig.pivot();
  rig.pan(0.25f, 0);  // a quarter of the height: the former middle moves by a quarter
  const auto spot = project(rig.camera(), 1, pivot, pivot);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->from.x, 0.25f, 1e-3f);
  for (int i = 0; i < 2000; ++i) rig.zoom(0.5f);
  EXPECT_GT(rig.distance(), 0);
  EXPECT_TRUE(is_finite(rig.eye()));
  Camera parallel = looking({0, 0, 10}, {0, 0, 0}, {0, 1, 0});
  parallel.orthographic = true;
  for (const Camera& camera : {looking({0, 0, 10}, {0, 0, 0}, {0, 1, 0}), parallel}) {
    CameraRig far(camera, kBounds, UpAxis::kY);
    for (int i = 0; i < 2000; ++i) far.zoom(2);  // and back
    EXPECT_TRUE(is_finite(far.eye()));
    for (int i = 0; i < 60; ++i) far.zoom(0.5f);
    EXPECT_LT(far.distance(), 10);
    EXPECT_LT(far.camera().y_mag, 10);
    expect_orthonormal(far.camera().to_world);
  }
}

TEST(Rig, FrameShowsTheWholeBox) {
  CameraRig rig(looking({1, 0.4f, 0.2f}, {0, 0, 0}, {0, 1, 0}), kBounds, UpAxis::kY);
  rig.frame(kBounds);
  for (unsigned bits = 0; bits < 8; ++bits) {
    const Vec3 corner{(bits & 1) != 0 ? kBounds.max.x : kBounds.min.x,
                      (bits & 2) != 0 ? kBounds.max.y : kBounds.min.y,
                      (bits & 4) != 0 ? kBounds.max.z : kBounds.min.z};
    const auto spot = project(rig.camera(), 1, corner, corner);
    ASSERT_TRUE(spot);
    EXPECT_TRUE(spot->from.x > 0 && spot->from.x < 1 && spot->from.y > 0 && spot->from.y < 1);
  }
}

TEST(Rig, LooksFromEverySideAndShowsTheWholeBox) {
  for (const UpAxis up : {UpAxis::kX, UpAxis::kY, UpAxis::kZ, UpAxis::kMinusY}) {
    for (const bool parallel : {false, true}) {
      for (const ViewSide side :
           {ViewSide::kFront, ViewSide::kBack, ViewSide::kLeft, ViewSide::kRight, ViewSide::kTop,
            ViewSide::kBottom, ViewSide::kIso}) {
        CameraRig rig(looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), kBounds, up);
        rig.set_orthographic(parallel, kBounds);
        rig.look_from(side, kBounds, 1.5f);
        EXPECT_EQ(rig.camera().orthographic, parallel);
        expect_orthonormal(rig.camera().to_world);
        float farthest = 0;
        for (unsigned bits = 0; bits < 8; ++bits) {
          const Vec3 corner{(bits & 1) != 0 ? kBounds.max.x : kBounds.min.x,
                            (bits & 2) != 0 ? kBounds.max.y : kBounds.min.y,
                            (bits & 4) != 0 ? kBounds.max.z : kBounds.min.z};
          const auto spot = project(rig.camera(), 1.5f, corner, corner);
          ASSERT_TRUE(spot);
          for (const float at : {spot->from.x, spot->from.y})
            farthest = std::max(farthest, std::fabs(at - 0.5f));
        }
        EXPECT_LT(farthest, 0.5f);
        EXPECT_GT(farthest, 0.4f);
      }
    }
  }
  CameraRig rig(looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), kBounds, UpAxis::kZ);
  rig.look_from(ViewSide::kFront, kBounds, 1);
  expect_near(rig.forward(), {0, 1, 0}, 1e-6f);
  expect_near(column(rig.camera().to_world, 1), rig.up(), 1e-6f);
}

TEST(Rig, OrthographicShowsTheSameAtThePivot) {
  CameraRig rig(looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), kBounds, UpAxis::kY);
  rig.zoom(0.1f);
  const Vec3 pivot = rig.pivot(), beside = pivot + column(rig.camera().to_world, 0);
  const auto before = project(rig.camera(), 1, beside, beside);
  rig.set_orthographic(true, kBounds);
  const auto parallel = project(rig.camera(), 1, beside, beside);
  ASSERT_TRUE(before && parallel);
  EXPECT_NEAR(parallel->from.x, before->from.x, 1e-4f);
  expect_near(rig.pivot(), pivot, 1e-4f);
  // The whole box is in front of the camera.
  for (const Vec3 corner : {kBounds.min, kBounds.max})
    EXPECT_GT(dot(corner - rig.eye(), rig.forward()), 0);
  rig.zoom(0.5f);
  rig.set_orthographic(false, kBounds);
  const auto after = project(rig.camera(), 1, beside, beside);
  ASSERT_TRUE(after);
  EXPECT_NEAR(after->from.x - 0.5f, 2 * (before->from.x - 0.5f), 1e-3f);
}

TEST(Projection, DepthsHoldTheWholeBox) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> in(-30, 30);
  for (int i = 0; i < 100; ++i) {
    Camera camera = looking({in(random), in(random), in(random)}, {0, 1, 0}, {0, 1, 0});
    camera.orthographic = i % 2 == 0;
    const DepthRange range = depth_range(camera, kBounds);
    EXPECT_LT(0, range.near);
    EXPECT_LT(range.near, range.far);
    for (const Vec3 corner : {kBounds.min, kBounds.max}) {
      const float depth = -dot(corner - column(camera.to_world, 3), column(camera.to_world, 2));
      EXPECT_LT(depth, range.far);
      EXPECT_TRUE(depth < 0.0011f * range.far || depth > range.near) << depth;
    }
  }
  // Scenes of any size.
  const DepthRange tiny = depth_range(looking({0, 0, 1e-5f}, {0, 0, 0}, {0, 1, 0}),
                                      {{-1e-6f, -1e-6f, -1e-6f}, {1e-6f, 1e-6f, 1e-6f}});
  EXPECT_LT(tiny.near, tiny.far);
}

TEST(Projection, TheGridLiesBelowTheBox) {
  const GroundGrid grid = ground_grid(kBounds, {0, 1, 0});
  EXPECT_EQ(grid.center.y, kBounds.min.y);
  EXPECT_EQ(grid.cell, 1);
  EXPECT_EQ(ground_grid(kBounds, {0, 0, -1}).center.z, kBounds.max.z);
  EXPECT_EQ(std::fabs(dot(cross(grid.right, grid.ahead), {0, 1, 0})), 1);
}

TEST(Projection, IsUndoneByUnproject) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> in(0, 1);
  Camera parallel = looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0});
  parallel.orthographic = true;
  parallel.y_mag = 3;
  for (const Camera& camera : {looking({2, 3, 9}, {0, 1, 0}, {0, 1, 0}), parallel}) {
    for (int i = 0; i < 100; ++i) {
      const Spot spot{in(random), in(random)};
      const Vec3 point = unproject(camera, 1.7f, spot, 0.5f + 20 * in(random));
      const auto seen = project(camera, 1.7f, point, point);
      ASSERT_TRUE(seen);
      EXPECT_NEAR(seen->from.x, spot.x, 1e-4f);
      EXPECT_NEAR(seen->from.y, spot.y, 1e-4f);
      // The matrix for OpenGL agrees.
      const auto m = view_projection(camera, 1.7f, 0.1f, 100);
      const auto row = [&](std::size_t r) {
        return m[r] * point.x + m[4 + r] * point.y + m[8 + r] * point.z + m[12 + r];
      };
      EXPECT_NEAR(row(0) / row(3), 2 * spot.x - 1, 1e-3f);
      EXPECT_NEAR(row(1) / row(3), 1 - 2 * spot.y, 1e-3f);
      EXPECT_LT(std::fabs(row(2) / row(3)), 1);
    }
  }
}

TEST(Projection, CutsOffWhatIsBehind) {
  const Camera camera = looking({0, 0, 0}, {0, 0, -1}, {0, 1, 0});
  EXPECT_FALSE(project(camera, 1, {0, 0, 1}, {1, 0, 5}));
  const auto crossing = project(camera, 1, {0, 0, -2}, {0.5f, 0, 3});
  ASSERT_TRUE(crossing);
  EXPECT_TRUE(std::isfinite(crossing->to.x));
  EXPECT_NEAR(crossing->from.x, 0.5f, 1e-5f);
}

}  // namespace
}  // namespace raysheaf::viewer
