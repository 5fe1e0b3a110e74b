// Cameras along paths and around scenes.
#include "raysheaf/cameras.h"

#include <gtest/gtest.h>

#include <cstring>

#include "base/vec.h"
#include "raysheaf/error.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

void expect_close(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-5f);
  EXPECT_NEAR(a.y, b.y, 1e-5f);
  EXPECT_NEAR(a.z, b.z, 1e-5f);
}
Vec3 eye_of(const Camera& camera) {
  return column(camera.to_world, 3);
}

/// Key positions along x at 10 s, 11 s and 14 s, always looking at a point ahead on z.
CameraPath path(bool smooth) {
  CameraPath path;
  path.smooth = smooth;
  path.keys = {{10, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1},
               {11, {2, 0, 0}, {2, 0, -1}, {0, 1, 0}, 1.5f},
               {14, {4, 0, 0}, {4, 0, -1}, {0, 1, 0}, 0.5f}};
  return path;
}

TEST(CameraPath, PassesItsKeysAndStaysBeyondThem) {
  for (const bool smooth : {false, true}) {
    const CameraPath p = path(smooth);
    validate(p);
    expect_close(eye_of(camera_at(p, 0)), {0, 0, 0});
    expect_close(eye_of(camera_at(p, 10)), {0, 0, 0});
    expect_close(eye_of(camera_at(p, 11)), {2, 0, 0});
    expect_close(eye_of(camera_at(p, 99)), {4, 0, 0});
    EXPECT_NEAR(camera_at(p, 11).y_fov, 1.5f, 1e-6f);
    expect_close(column(camera_at(p, 11).to_world, 2), {0, 0, 1});
  }
}

TEST(CameraPath, RunsStraightOrGlides) {
  expect_close(eye_of(camera_at(path(false), 10.5)), {1, 0, 0});
  EXPECT_NEAR(camera_at(path(false), 12.5).y_fov, 1, 1e-6f);
  // Hermite interpolation half-way through the first segment: (0 + 2) / 2 + (2 - 1) / 8. The first
  // key has the velocity 2 per second, the second that between its neighbours, 4 in 4 seconds.
  expect_close(eye_of(camera_at(path(true), 10.5)), {1.125f, 0, 0});
  const double h = 1e-3;
  const float before =
      eye_of(camera_at(path(true), 11)).x - eye_of(camera_at(path(true), 11 - h)).x;
  const float after = eye_of(camera_at(path(true), 11 + h)).x - eye_of(camera_at(path(true), 11)).x;
  EXPECT_NEAR(before, after, 1e-5f);
}

TEST(CameraPath, RefusesInvalidKeys) {
  const auto refused = [](auto change, const char* place) {
    CameraPath p = path(true);
    change(p);
    try {
      validate(p);
      ADD_FAILURE() << place;
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), place) << error.what();
    }
  };
  refused([](CameraPath& p) { p.keys.clear(); }, "keys");
  refused([](CameraPath& p) { p.keys[2].time = 11; }, "keys[2].time");
  refused([](CameraPath& p) { p.keys[1].look_at = p.keys[1].position; }, "keys[1].look_at");
  refused([](CameraPath& p) { p.keys[1].up = {0, 0, 5}; }, "keys[1].up");
  refused([](CameraPath& p) { p.keys[0].y_fov = 4; }, "keys[0].y_fov");
  refused([](CameraPath& p) { p.keys[0].position.x = INFINITY; }, "keys[0].position");
}

TEST(Turntable, GoesAroundTheCenterAndComesBack) {
  const Camera camera = test::camera_at({0, 2, 5}, {0, 0, 0});
  const Vec3 center{0, 0, 1};
  expect_close(eye_of(turned_camera(camera, center, 0.25)), {4, 2, 1});
  expect_close(eye_of(turned_camera(camera, center, 0.5)), {0, 2, -3});
  const Camera again = turned_camera(camera, center, 3);
  EXPECT_EQ(std::memcmp(&again.to_world, &camera.to_world, sizeof(Affine)), 0);
}

TEST(FindCamera, ByNameThenByIndex) {
  SceneDescription scene = test::ball_on_floor();
  scene.cameras.push_back(test::camera_at({1, 1, 1}, {}));
  scene.cameras[1].name = "0";
  expect_close(eye_of(find_camera(scene, "0")), {1, 1, 1});
  expect_close(eye_of(find_camera(scene, "1")), {1, 1, 1});
  expect_close(eye_of(find_camera(scene, "")), eye_of(scene.cameras[0]));
  EXPECT_THROW(static_cast<void>(find_camera(scene, "2")), Error);
  SceneDescription one = test::ball_on_floor();
  one.cameras.resize(1);
  one.cameras[0].name.clear();
  try {
    static_cast<void>(find_camera(one, "5"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.sentence(), "the scene has no camera \"5\"; its only camera is 0");
  }
  SceneDescription bare = test::ball_on_floor();
  bare.cameras.clear();
  for (const bool framed : {false, true}) {
    if (framed) add_missing_camera_and_light(bare);
    try {
      static_cast<void>(find_camera(bare, "5"));
      ADD_FAILURE() << framed;
    } catch (const Error& error) {
      EXPECT_NE(error.sentence().find("the file has no cameras"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace raysheaf
