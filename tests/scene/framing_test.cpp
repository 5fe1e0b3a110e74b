#include <gtest/gtest.h>

#include <cmath>

#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/studio.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::one_triangle;
using test::Random;

/// Expects that every vertex is in a square view, between the planes.
void expect_seen(const SceneDescription& scene, const Camera& camera) {
  const double slope = std::tan(camera.y_fov / 2.0);
  const Affine& m = camera.to_world;
  const Vec3 eye = column(m, 3);
  for (const Instance& instance : scene.instances) {
    for (const Vec3 position : scene.meshes[instance.mesh].positions) {
      const Vec3 p = transform_point(instance.to_world, position) - eye;
      const double depth = -dot(p, column(m, 2));
      ASSERT_GT(depth, camera.z_near);
      ASSERT_LT(depth, camera.z_far);
      ASSERT_LT(std::fabs(dot(p, column(m, 0))), slope * depth);
      ASSERT_LT(std::fabs(dot(p, column(m, 1))), slope * depth);
    }
  }
}

/// The larger of the fractions of the image's width and height that the triangles' vertices span;
/// expects that all of them are in the image.
float spanned(const SceneDescription& scene, const Camera& camera, float aspect) {
  const Affine& m = camera.to_world;
  Vec3 low{1, 1, 0}, high{-1, -1, 0};
  const double extent = camera.orthographic ? camera.y_mag : std::tan(camera.y_fov / 2.0);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t v : triangle) {
        const Vec3 p =
            transform_point(instance.to_world, mesh.positions[v]) - column(camera.to_world, 3);
        const double depth = -dot(p, column(m, 2));
        EXPECT_GT(depth, camera.z_near);
        EXPECT_LT(depth, camera.z_far);
        const double half = camera.orthographic ? extent : extent * depth;
        const Vec3 at{static_cast<float>(dot(p, column(m, 0)) / (half * aspect)),
                      static_cast<float>(dot(p, column(m, 1)) / half), 0};
        low = min(low, at);
        high = max(high, at);
      }
    }
  }
  EXPECT_GT(std::min(low.x, low.y), -1);
  EXPECT_LT(std::max(high.x, high.y), 1);
  return std::max(high.x - low.x, high.y - low.y) / 2;
}

constexpr ViewSide kViews[] = {ViewSide::kFront, ViewSide::kBack, ViewSide::kLeft,
                               ViewSide::kRight, ViewSide::kTop,  ViewSide::kBottom,
                               ViewSide::kIso};
constexpr UpAxis kAxes[] = {UpAxis::kX,      UpAxis::kY,      UpAxis::kZ,
                            UpAxis::kMinusX, UpAxis::kMinusY, UpAxis::kMinusZ};

/// A viewpoint on any side, for images of any aspect ratio.
Viewpoint random_viewpoint(Random& random) {
  Viewpoint view;
  if (random() % 2 == 0) view.view = kViews[random() % std::size(kViews)];
  view.up = kAxes[random() % std::size(kAxes)];
  view.orthographic = random() % 3 == 0;
  if (!view.orthographic && random() % 2 == 0) view.fov = test::uniform(random, 0.05f, 1.6f);
  view.aspect_ratio = std::pow(10.0f, test::uniform(random, -0.6f, 0.6f));
  return view;
}

TEST(Framing, FillsPicturesOfAnyShapeWithMeshesOfAnyShape) {
  Random random(11);
  for (int round = 0; round < 1000; ++round) {
    SceneDescription scene;
    const float scale = std::pow(10.0f, test::uniform(random, -9, 9));
    scene.meshes.push_back(test::random_mesh(random, 20, 100, scale));
    Vec3 shape{1, 1, 1};
    for (float* side : {&shape.x, &shape.y, &shape.z})
      if (random() % 3 == 0) *side = std::pow(10.0f, test::uniform(random, -1, 0));
    scene.instances.resize(2);
    const float away = std::pow(10.0f, test::uniform(random, -2, 2));
    const Affine place = compose(translation(test::random_point(random, away * scale)),
                                 compose(rotation({0, 0, 1}, 1), scaling(shape)));
    scene.instances[0].to_world = place;
    scene.instances[1].to_world = compose(translation(test::random_point(random, scale)), place);
    const Viewpoint view = random_viewpoint(random);
    const Camera camera = framing_camera(scene, view);
    EXPECT_GT(spanned(scene, camera, view.aspect_ratio), 0.85f)
        << round << " ortho " << view.orthographic << " fov " << view.fov.value_or(0) << " aspect "
        << view.aspect_ratio << " shape " << shape.x << " " << shape.y << " " << shape.z << " away "
        << away << " near " << camera.z_near / scale << " scale " << scale;
    EXPECT_LT(spanned(scene, camera, view.aspect_ratio), 0.97f) << round;
    scene.cameras.push_back(camera);
    EXPECT_NO_THROW(validate(scene));
  }
}

TEST(Framing, NothingLeavesThePictureOnATurntable) {
  Random random(12);
  for (int round = 0; round < 100; ++round) {
    SceneDescription scene;
    scene.meshes.push_back(test::random_mesh(random, 20, 40, 1));
    scene.instances.resize(1);
    scene.instances[0].to_world = compose(translation(test::random_point(random, 10)),
                                          scaling({test::uniform(random, 0.1f, 20), 1, 1}));
    Viewpoint view = random_viewpoint(random);
    view.all_around = true;
    const Camera camera = framing_camera(scene, view);
    const Box box = world_bounds(scene);
    const Vec3 center = (box.min + box.max) * 0.5f;
    for (int turn = 0; turn < 16; ++turn) {
      SceneDescription turned = scene;
      const Affine around = rotation(direction_of(view.up), 0.4f * static_cast<float>(turn));
      turned.instances[0].to_world =
          compose(translation(center),
                  compose(around, compose(translation(-center), scene.instances[0].to_world)));
      static_cast<void>(spanned(turned, camera, view.aspect_ratio));
    }
  }
}

TEST(Framing, ViewsLookAtTheSideThatTheyName) {
  struct Case {
    ViewSide view;
    UpAxis up;
    Vec3 back, above;
  };
  const Case cases[] = {
      {ViewSide::kFront, UpAxis::kY, {0, 0, 1}, {0, 1, 0}},
      {ViewSide::kBack, UpAxis::kY, {0, 0, -1}, {0, 1, 0}},
      {ViewSide::kLeft, UpAxis::kY, {-1, 0, 0}, {0, 1, 0}},
      {ViewSide::kRight, UpAxis::kY, {1, 0, 0}, {0, 1, 0}},
      {ViewSide::kTop, UpAxis::kY, {0, 1, 0}, {0, 0, -1}},
      {ViewSide::kBottom, UpAxis::kY, {0, -1, 0}, {0, 0, 1}},
      {ViewSide::kFront, UpAxis::kZ, {0, -1, 0}, {0, 0, 1}},
      {ViewSide::kRight, UpAxis::kZ, {1, 0, 0}, {0, 0, 1}},
      {ViewSide::kTop, UpAxis::kZ, {0, 0, 1}, {0, 1, 0}},
      {ViewSide::kFront, UpAxis::kMinusZ, {0, 1, 0}, {0, 0, -1}},
      {ViewSide::kFront, UpAxis::kX, {0, 0, 1}, {1, 0, 0}},
      {ViewSide::kFront, UpAxis::kMinusX, {0, 0, 1}, {-1, 0, 0}},
      {ViewSide::kFront, UpAxis::kMinusY, {0, 0, 1}, {0, -1, 0}},
  };
  for (const Case& c : cases) {
    Viewpoint view;
    view.view = c.view;
    view.up = c.up;
    const Affine m = framing_camera(one_triangle(), view).to_world;
    EXPECT_LT(length(column(m, 2) - c.back), 1e-6f);
    EXPECT_LT(length(column(m, 1) - c.above), 1e-6f);
    EXPECT_LT(length(cross(column(m, 1), column(m, 2)) - column(m, 0)), 1e-6f);
  }
  Viewpoint iso;
  iso.view = ViewSide::kIso;
  const Vec3 back = column(framing_camera(one_triangle(), iso).to_world, 2);
  EXPECT_FLOAT_EQ(back.x, back.y);
  EXPECT_FLOAT_EQ(back.x, back.z);
}

TEST(Framing, ACameraWithAPlaceKeepsIt) {
  Viewpoint view;
  view.position = Vec3{3, 2, 5};
  const Camera at_middle = framing_camera(one_triangle(), view);
  EXPECT_EQ(column(at_middle.to_world, 3), *view.position);
  EXPECT_LT(length(column(at_middle.to_world, 2) - normalized(Vec3{2.5f, 1.5f, 5})), 1e-6f);
  view.look_at = Vec3{3, 2, -1};
  view.fov = 0.5f;
  view.zoom = 2;
  const Camera ahead = framing_camera(one_triangle(), view);
  EXPECT_LT(length(column(ahead.to_world, 2) - Vec3{0, 0, 1}), 1e-6f);
  EXPECT_NEAR(std::tan(ahead.y_fov / 2), std::tan(0.25f) / 2, 1e-6f);
  view.fov.reset();
  view.orthographic = true;
  view.zoom = 1;
  view.look_at.reset();
  EXPECT_LT(spanned(one_triangle(), framing_camera(one_triangle(), view), 1), 0.97f);
}

/// The field that is refused.
std::string refused(const Viewpoint& view) {
  try {
    static_cast<void>(framing_camera(one_triangle(), view));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.place();
  }
  return "";
}

TEST(Framing, RefusesViewpointsThatMakeNoSense) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto with = [](const auto& change) {
    Viewpoint view;
    change(view);
    return refused(view);
  };
  EXPECT_EQ(with([](Viewpoint&) {}), "");
  for (const float zoom : {0.0f, -1.0f, kNan, HUGE_VALF, 1e38f, 1e-38f})
    EXPECT_EQ(with([&](Viewpoint& v) { v.zoom = zoom; }), "zoom") << zoom;
  for (const float fov : {0.0f, -1.0f, kNan, 3.1416f, HUGE_VALF})
    EXPECT_EQ(with([&](Viewpoint& v) { v.fov = fov; }), "fov") << fov;
  EXPECT_EQ(with([](Viewpoint& v) { v.fov = 1.0f, v.orthographic = true; }), "fov");
  EXPECT_EQ(with([](Viewpoint& v) { v.position = Vec3{kNan, 0, 0}; }), "camera_position");
  EXPECT_EQ(with([](Viewpoint& v) { v.position = Vec3{0.5f, 0.5f, 0}; }), "camera_position");
  EXPECT_EQ(with([](Viewpoint& v) { v.look_at = Vec3{0, 0, 0}; }), "look_at");
  EXPECT_EQ(with([](Viewpoint& v) { v.position = v.look_at = Vec3{1, 2, 3}; }), "look_at");
  EXPECT_EQ(with([](Viewpoint& v) {
              v.position = Vec3{1, 1, 1}, v.view = ViewSide::kTop;
            }),
            "view");
  EXPECT_EQ(with([](Viewpoint& v) { v.position = Vec3{0.5f, 9, 0}; }), "up");
  EXPECT_EQ(with([](Viewpoint& v) { v.aspect_ratio = 0; }), "aspect_ratio");
}

TEST(Framing, SeesAllOfRandomScenes) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    SceneDescription scene;
    const float scale = std::pow(10.0f, test::uniform(random, -12, 12));
    scene.meshes.push_back(test::random_mesh(random, 20, 100, scale));
    scene.instances.resize(2);
    scene.instances[1].to_world = translation(test::random_point(random, 10 * scale));
    const Camera camera = framing_camera(scene);
    expect_seen(scene, camera);
    scene.cameras.push_back(camera);
    scene.lights.push_back(showing_light(scene, camera));
    EXPECT_NO_THROW(validate(scene));
  }
}

TEST(Framing, LooksFromTheFrontRightAndAbove) {
  const Camera camera = framing_camera(one_triangle());
  const Vec3 eye = column(camera.to_world, 3);
  EXPECT_GT(eye.x, 1);
  EXPECT_GT(eye.y, 1);
  EXPECT_GT(eye.z, 1);
  EXPECT_GT(column(camera.to_world, 1).y, 0.5f);
}

TEST(Framing, FlatAndPointScenesWork) {
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{1e6f, -3, 1e-6f}}) {
    for (const Vec3 size : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 0, 1}}) {
      SceneDescription scene = one_triangle();
      scene.meshes[0].positions = {at, at + size, at - size};
      add_missing_camera_and_light(scene);
      expect_seen(scene, scene.cameras.at(0));
      EXPECT_NO_THROW(validate(scene));
    }
  }
}

TEST(Framing, IsTheSameWhereverTheMeshLies) {
  Random random(3);
  for (const float away : {1e3f, 1e5f, 1e6f}) {
    SceneDescription scene;
    scene.meshes.push_back(test::random_mesh(random, 20, 100, 5));
    scene.instances.resize(1);
    const Camera at_origin = framing_camera(scene);
    scene.instances[0].to_world = translation({away, -away, away});
    const Camera there = framing_camera(scene);
    const float spacing = away * 0x1p-22f;
    EXPECT_NEAR(there.z_near, at_origin.z_near, 8 * spacing);
    EXPECT_NEAR(there.z_far, at_origin.z_far, 16 * spacing);
    const Vec3 moved = column(there.to_world, 3) - column(at_origin.to_world, 3);
    EXPECT_NEAR(moved.x, away, 8 * spacing);
    EXPECT_NEAR(moved.y, -away, 8 * spacing);
    expect_seen(scene, there);
  }
}

TEST(Framing, LeavesOutTrianglesWithoutArea) {
  SceneDescription scene = one_triangle();
  const Box before = world_bounds(scene);
  Mesh& mesh = scene.meshes[0];
  mesh.positions.insert(mesh.positions.end(), {{1e6f, 0, 0}, {2e6f, 0, 0}, {4e6f, 0, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{3, 3, 3}, {3, 4, 4}, {3, 4, 5}});
  EXPECT_EQ(world_bounds(scene).max, before.max);
  EXPECT_EQ(world_bounds(scene).min, before.min);
  mesh.triangles.erase(mesh.triangles.begin());
  EXPECT_EQ(world_bounds(scene).max.x, 4e6f) << "nothing has an area";
}

TEST(Framing, AnEmptySceneStillHasACamera) {
  SceneDescription scene;
  EXPECT_TRUE(is_finite(column(framing_camera(scene).to_world, 3)));
}

TEST(Framing, TheLightIsAboveAndLeftOfTheCamera) {
  const SceneDescription scene = one_triangle();
  const Camera camera = framing_camera(scene);
  const Light light = showing_light(scene, camera);
  const Vec3 from_eye = light.position - column(camera.to_world, 3);
  EXPECT_GT(dot(from_eye, column(camera.to_world, 1)), 0);
  EXPECT_LT(dot(from_eye, column(camera.to_world, 0)), 0);
}

TEST(Studio, KeyFillAndRimStandWhereTheCameraSaysThatTheyStand) {
  Random random(21);
  for (int round = 0; round < 50; ++round) {
    SceneDescription scene = one_triangle();
    const Camera camera = framing_camera(scene, random_viewpoint(random));
    scene.lights = studio_lights(scene, camera);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_TRUE(has_studio_lights(scene));
    scene.cameras = {camera};
    EXPECT_NO_THROW(validate(scene));
    const auto toward = [&](int light, int axis) {
      return -dot(scene.lights[light].direction, column(camera.to_world, axis));
    };
    EXPECT_LT(toward(0, 0), 0) << "key: left";
    EXPECT_GT(toward(0, 1), 0) << "key: above";
    EXPECT_GT(toward(0, 2), 0) << "key: before the model";
    EXPECT_GT(toward(1, 0), 0) << "fill: right";
    EXPECT_LT(toward(2, 2), 0) << "rim: behind the model";
    EXPECT_LT(scene.lights[1].intensity.x, 0.5f * scene.lights[0].intensity.x);
    scene.lights[1].name = "lamp";
    EXPECT_FALSE(has_studio_lights(scene));
  }
}

TEST(Studio, ACameraInsideHasALightBesideItself) {
  SceneDescription scene;
  Random random(22);
  scene.meshes.push_back(test::random_mesh(random, 20, 100, 1));
  scene.instances.resize(1);
  Camera camera;
  scene.lights = studio_lights(scene, camera);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].type, Light::Type::kPoint);
  EXPECT_TRUE(has_studio_lights(scene));
}

TEST(Framing, OnlyWhatIsInFrontOfACameraCounts) {
  SceneDescription corridor = one_triangle();
  Mesh& mesh = corridor.meshes[0];
  mesh.positions.clear();
  for (const float z : {-100.0f, 100.0f})
    for (const Vec3 p : {Vec3{-1, -1, z}, Vec3{1, -1, z}, Vec3{1, 1, z}, Vec3{-1, 1, z}})
      mesh.positions.push_back(p);
  mesh.triangles = {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 6, 5},
                    {2, 3, 6}, {3, 7, 6}, {3, 0, 7}, {0, 4, 7}};
  Camera camera;
  EXPECT_TRUE(shows(camera, corridor)) << "its far end is small, but its walls fill the image";
  camera.to_world = translation({50, 0, 0});
  EXPECT_FALSE(shows(camera, corridor)) << "the camera looks past it, and half of it is behind";
  for (const float fov : {0.2f, 1.5f, 2.5f, 3.1f}) {
    camera.y_fov = fov;
    EXPECT_FALSE(shows(camera, corridor)) << "an angle of " << fov;
  }
  camera.y_fov = Camera().y_fov;
  camera.orthographic = true;
  EXPECT_FALSE(shows(camera, corridor));
  camera.to_world = translation({0, 0, 0});
  EXPECT_TRUE(shows(camera, corridor));
}

TEST(Framing, OnlyWhatTheImageShowsCounts) {
  SceneDescription scene = one_triangle();
  // The box around it fills the image, and the triangle passes next to the image's corner.
  scene.meshes[0].positions = {{-9, 0.5f, -1}, {0.5f, -9, -1}, {-9, -9, -1}};
  Camera camera;
  camera.y_fov = 2 * std::atan(1.0f);
  EXPECT_FALSE(shows(camera, scene));
  scene.meshes[0].positions[0].y = scene.meshes[0].positions[1].x = 9;
  EXPECT_TRUE(shows(camera, scene)) << "half of the image, though no corner is in it";
  camera.z_far = 0.5f;
  EXPECT_FALSE(shows(camera, scene)) << "beyond z_far";
  camera.z_near = 2;
  camera.z_far = 3;
  EXPECT_FALSE(shows(camera, scene)) << "nearer than z_near";
}

TEST(Framing, ClippedTrianglesSpanWhatTheirPointsDo) {
  Random random(35);
  int shown = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SceneDescription scene = one_triangle();
    for (Vec3& p : scene.meshes[0].positions) p = test::random_point(random, 3);
    Camera camera;
    camera.orthographic = trial % 2 == 0;
    camera.z_near = 0.5f;
    camera.z_far = 2.5f;
    constexpr int kSteps = 200;
    double left = 1, right = -1, low = 1, top = -1;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const auto& p = scene.meshes[0].positions;
        const float u = static_cast<float>(i) / kSteps, v = static_cast<float>(j) / kSteps;
        const Vec3 at = p[0] * (1 - u - v) + p[1] * u + p[2] * v;
        const double scale =
            camera.orthographic ? 1 : -1 / (double{at.z} * std::tan(camera.y_fov / 2.0));
        const double x = at.x * scale, y = at.y * scale;
        if (-at.z < camera.z_near || -at.z > camera.z_far || std::max(std::abs(x), std::abs(y)) > 1)
          continue;
        left = std::min(left, x), right = std::max(right, x);
        low = std::min(low, y), top = std::max(top, y);
      }
    }
    const double span = std::max(right - left, top - low);
    if (span < 0.9 || span > 1) {
      EXPECT_EQ(shows(camera, scene), span > 1) << trial;
    }
    shown += span > 1 ? 1 : 0;
  }
  EXPECT_GT(shown, 40);
  EXPECT_LT(shown, 160);
}

TEST(Framing, ACameraShowsASceneThatSpansHalfOfTheImage) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].positions = {{-1, -2, -1}, {1, -2, 1}, {0, 2, 1}};
  Camera camera;
  camera.y_fov = 2 * std::atan(0.5f);  // at the distance d, the image is d high
  const auto from = [&](float x, float y, float z) {
    camera.to_world = translation({x, y, z});
    return shows(camera, scene);
  };
  EXPECT_TRUE(from(0, 0, 8.5f));
  EXPECT_FALSE(from(0, 0, 9.5f));
  EXPECT_TRUE(from(0, 2, 5));   // the lower half is outside
  EXPECT_FALSE(from(0, 4, 5));  // nearly all is
  EXPECT_FALSE(from(40, 0, 5));
  EXPECT_FALSE(from(0, 0, -5));  // looks away
  EXPECT_FALSE(from(0, 0, 0));   // what is in front of the eye is outside the image
  camera.to_world = compose(translation({0, 0, 9.5f}), scaling({3, 3, 3}));
  EXPECT_FALSE(shows(camera, scene));
  camera.aspect_ratio = 0.2f;  // the triangle is wider than the image
  EXPECT_TRUE(shows(camera, scene));
  camera.aspect_ratio = 0;
  camera.orthographic = true;
  camera.y_mag = 3.9f;
  EXPECT_TRUE(from(0, 0, 100));
  camera.y_mag = 4.1f;
  EXPECT_FALSE(from(0, 0, 100));
  EXPECT_TRUE(shows(camera, SceneDescription{}));
}

TEST(Framing, AddsOnlyWhatIsMissing) {
  SceneDescription scene = one_triangle();
  scene.cameras.resize(2);
  scene.lights.resize(1);
  add_missing_camera_and_light(scene);
  EXPECT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.lights.size(), 1u);

  SceneDescription glowing = one_triangle();
  glowing.materials.resize(1);
  glowing.materials[0].emission = {0, 1, 0};
  add_missing_camera_and_light(glowing);
  EXPECT_EQ(glowing.cameras.size(), 1u);
  EXPECT_EQ(glowing.lights.size(), 3u);  // emissive surfaces do not light the rest
  EXPECT_TRUE(has_studio_lights(glowing));

  SceneDescription unlit = one_triangle();
  unlit.materials.resize(1);
  unlit.materials[0].unlit = true;
  add_missing_camera_and_light(unlit);
  EXPECT_TRUE(unlit.lights.empty());
}

}  // namespace
}  // namespace raysheaf
