#include "render/raster/rasterizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <thread>

#include "exec/executor.h"
#include "pictures.h"
#include "render/raster/resolve.h"

namespace raysheaf::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<std::uint32_t> rendered(Rasterizer& rasterizer, const FlatScene& scene,
                                    const Camera& camera, std::uint32_t width,
                                    std::uint32_t height) {
  const Executor executor(2);
  std::vector<std::uint32_t> drawn;
  auto picture = rasterizer.visible_triangles(
      executor, scene, make_camera_frame(camera, width, height), nullptr, &drawn);
  auto resolved_by_drawn = picture;
  resolve_silhouettes(executor, scene, make_camera_frame(camera, width, height), picture);
  resolve_silhouettes(executor, scene, make_camera_frame(camera, width, height), drawn,
                      resolved_by_drawn);
  EXPECT_EQ(resolved_by_drawn, picture);
  return picture;
}

/// The contract: OpenGL's image differs from brute force in at most one pixel of a thousand (plus
/// one, for small images). After resolving, it differs in one of five thousand, and only at borders
/// between triangles.
void expect_like_brute_force(Rasterizer& rasterizer, const FlatScene& scene, const Camera& camera,
                             std::uint32_t width, std::uint32_t height) {
  const auto expected = cast(scene, camera, width, height);
  const auto drawn =
      rasterizer.visible_triangles(Executor(2), scene, make_camera_frame(camera, width, height));
  ASSERT_EQ(drawn.size(), std::size_t{width} * height);
  EXPECT_LE(compare(expected, drawn, width, height).pixels, 1 + width * height / 1000);

  const auto found = rendered(rasterizer, scene, camera, width, height);
  const Difference difference = compare(expected, found, width, height);
  EXPECT_LE(difference.pixels, 1 + width * height / 5000);
  EXPECT_EQ(difference.interior, 0u);
}

bool shows_something(const std::vector<std::uint32_t>& picture) {
  for (const std::uint32_t id : picture) {
    if (id != kInvalidId) return true;
  }
  return false;
}

class RasterizerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    RAYSHEAF_GRAPHICS_OR_SKIP();
    rasterizer_ = std::make_unique<Rasterizer>();
  }
  std::unique_ptr<Rasterizer> rasterizer_;
};

TEST_F(RasterizerTest, DescriptionNamesTheVersion) {
  EXPECT_NE(rasterizer_->description().find("OpenGL 4."), std::string::npos)
      << rasterizer_->description();
}

TEST_F(RasterizerTest, EmptySceneShowsBackground) {
  const auto picture = rendered(*rasterizer_, FlatScene{}, Camera{}, 5, 4);
  EXPECT_EQ(picture, std::vector<std::uint32_t>(20, kInvalidId));
}

TEST_F(RasterizerTest, FirstPixelIsTheTopLeftOne) {
  MadeScene scene;
  add(scene, {-4, 5, -2}, {-4, -3, -2}, {4, 5, -2});  // above the line y = x + 1
  const auto picture = rendered(*rasterizer_, scene, Camera{}, 4, 4);
  EXPECT_EQ(picture.front(), 0u);
  EXPECT_EQ(picture[3], kInvalidId);
  EXPECT_EQ(picture[12], kInvalidId);
  EXPECT_EQ(picture[15], kInvalidId);
}

TEST_F(RasterizerTest, SoupsOfAnySizeAndFlags) {
  const float sizes[] = {0.02f, 0.1f, 0.5f, 2};
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const MadeScene scene = soup(400, sizes[seed % 4], seed);
    Random random(seed + 100);
    const Camera camera = camera_at(random.in_box(3), random.in_box(0.5f));
    expect_like_brute_force(*rasterizer_, scene, camera, 160, 120);
  }
}

TEST_F(RasterizerTest, PicturesOfAnyShape) {
  const std::uint32_t shapes[][2] = {{1, 1},    {3, 1},   {1, 9}, {1000, 7},
                                     {7, 1000}, {64, 64}, {2, 2}};
  const MadeScene scene = soup(300, 0.7f, 3);
  const Camera camera = camera_at({0.5f, 0.3f, 3}, {});
  for (const auto& shape : shapes) {
    SCOPED_TRACE(shape[0]);
    expect_like_brute_force(*rasterizer_, scene, camera, shape[0], shape[1]);
  }
}

TEST_F(RasterizerTest, CameraAmongTheTriangles) {
  for (std::uint32_t seed = 20; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    // Many triangles cross the near plane or lie behind the camera.
    MadeScene scene = soup(200, 3, seed);
    Camera camera = camera_at({0.1f, 0, 0.05f}, {0.3f, 0.2f, -1});
    camera.z_near = 0.05f;
    expect_like_brute_force(*rasterizer_, scene, camera, 128, 96);
    camera.z_far = 0.8f;
    expect_like_brute_force(*rasterizer_, scene, camera, 128, 96);
  }
}

TEST_F(RasterizerTest, GroundFromUnderTheEyeToTheHorizon) {
  MadeScene scene;
  add(scene, {-1e5f, -1, 1e5f}, {1e5f, -1, 1e5f}, {0, -1, -1e5f});
  add(scene, {-1, -0.99f, -50}, {1, -0.99f, -50}, {0, 1, -50});
  for (const float z_far : {kInfinity, 1e6f, 100.0f}) {
    Camera camera;
    camera.z_far = z_far;
    expect_like_brute_force(*rasterizer_, scene, camera, 200, 150);
  }
}

TEST_F(RasterizerTest, NearAndFarCut) {
  MadeScene scene;
  for (const float z : {-1.0f, -2.0f, -3.0f, -4.0f}) {
    add(scene, {-9, -9, z}, {9, -9, z}, {0, 9, z});
  }
  Camera camera;
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    camera.z_near = 1.5f, camera.z_far = kInfinity;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], 1u);
    camera.z_near = 2.5f, camera.z_far = 3.5f;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], 2u);
    camera.z_near = 3.25f, camera.z_far = 3.75f;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], kInvalidId);
    camera.z_near = 0.5f, camera.z_far = 0.75f;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], kInvalidId);
    camera.z_near = 0, camera.z_far = 5;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], 0u);
    camera.z_near = 5, camera.z_far = 5;
    EXPECT_EQ(rendered(*rasterizer_, scene, camera, 1, 1)[0], kInvalidId);
  }
}

TEST_F(RasterizerTest, FarFromTheOrigin) {
  for (const Vec3 center : {Vec3{1e4f, 1e4f, -1e4f}, Vec3{-3e4f, 5, 1e4f}}) {
    const MadeScene scene = soup(300, 0.5f, 5, center);
    const Camera camera = camera_at(center + Vec3{0.5f, 1, 3}, center);
    expect_like_brute_force(*rasterizer_, scene, camera, 160, 120);
  }
}

TEST_F(RasterizerTest, AnyScale) {
  for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
    SCOPED_TRACE(scale);
    MadeScene scene;
    const MadeScene unit = soup(300, 0.5f, 6);
    for (std::uint32_t i = 0; i < unit.triangle_count; ++i) {
      const auto [a, b, c] = unit.corners(i);
      add(scene, a * scale, b * scale, c * scale, unit.flags[i]);
    }
    Camera camera = camera_at(Vec3{1, 1, 3} * scale, {});
    camera.z_near = 0.01f * scale;
    expect_like_brute_force(*rasterizer_, scene, camera, 120, 120);
  }
}

TEST_F(RasterizerTest, Orthographic) {
  for (const float z_far : {kInfinity, 100.0f, 3.0f}) {
    Camera camera = camera_at({1, 2, 3}, {});
    camera.orthographic = true;
    camera.y_mag = 0.8f;
    camera.z_far = z_far;
    expect_like_brute_force(*rasterizer_, soup(400, 0.3f, 7), camera, 160, 120);
  }
}

TEST_F(RasterizerTest, ScaledShearedAndMirroredCameras) {
  const MadeScene scene = soup(400, 0.4f, 8);
  Affine shear;
  shear.m[0][1] = 0.4f, shear.m[1][2] = -0.3f;
  for (const Affine& inner : {scaling({5, 0.1f, 3}), shear, scaling({-1, 1, 1})}) {
    for (const bool orthographic : {false, true}) {
      Camera camera = camera_at({1, 1, 3}, {});
      camera.to_world = compose(camera.to_world, inner);
      camera.orthographic = orthographic;
      expect_like_brute_force(*rasterizer_, scene, camera, 120, 100);
    }
  }
}

TEST_F(RasterizerTest, SidesAreShownAsTheFlagsSay) {
  for (int flags = 0; flags < 4; ++flags) {
    for (const bool clockwise : {false, true}) {
      MadeScene scene;
      const Vec3 b{9, -9, -2}, c{0, 9, -2};
      add(scene, {-9, -9, -2}, clockwise ? c : b, clockwise ? b : c,
          static_cast<std::uint8_t>(flags));
      const bool front = clockwise == ((flags & kMirrored) != 0);
      const bool shown = front || (flags & kSingleSided) == 0;
      for (const bool orthographic : {false, true}) {
        Camera camera;
        camera.orthographic = orthographic;
        EXPECT_EQ(rendered(*rasterizer_, scene, camera, 3, 3)[4], shown ? 0 : kInvalidId)
            << flags << clockwise << orthographic;
      }
    }
  }
}

TEST_F(RasterizerTest, SharedEdgesLeaveNoCracks) {
  // A wavy sheet that fills the image: no pixel may show the background behind it.
  MadeScene scene;
  Random random(9);
  constexpr int kSide = 24;
  std::vector<Vec3> points;
  for (int i = 0; i <= kSide * (kSide + 2); ++i) {
    points.push_back({static_cast<float>(i % (kSide + 1)) / 4 - 3 + random.between(-0.08f, 0.08f),
                      static_cast<float>(i / (kSide + 1)) / 4 - 3 + random.between(-0.08f, 0.08f),
                      random.between(-0.1f, 0.1f)});
  }
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const int i = y * (kSide + 1) + x;
      add(scene, points[i], points[i + 1], points[i + kSide + 2], kSingleSided);
      add(scene, points[i], points[i + kSide + 2], points[i + kSide + 1], kSingleSided);
    }
  }
  const Camera camera = camera_at({0, 0, 3}, {});
  const auto picture = rendered(*rasterizer_, scene, camera, 150, 150);
  EXPECT_EQ(std::count(picture.begin(), picture.end(), kInvalidId), 0);
  expect_like_brute_force(*rasterizer_, scene, camera, 150, 150);
}

TEST_F(RasterizerTest, DuplicatesGoToTheLeastNumber) {
  MadeScene scene;
  const MadeScene once = soup(200, 0.5f, 10);
  for (int copy = 0; copy < 3; ++copy) {
    for (std::uint32_t i = 0; i < once.triangle_count; ++i) {
      const auto [a, b, c] = once.corners(i);
      add(scene, a, b, c, once.flags[i]);
    }
  }
  expect_like_brute_force(*rasterizer_, scene, camera_at({0, 0, 3}, {}), 128, 128);
}

/// A rectangle in a plane through the origin.
void add_rectangle(MadeScene& scene, Vec3 right, Vec3 up, Vec3 center, float wide, float high) {
  const Vec3 x = right * wide, y = up * high;
  const Vec3 corners[4] = {center - x - y, center + x - y, center + x + y, center - x + y};
  add(scene, corners[0], corners[1], corners[2]);
  add(scene, corners[0], corners[2], corners[3]);
}

TEST_F(RasterizerTest, SurfacesThatCoincideAreThoseOfRays) {
  constexpr std::uint32_t kSide = 128;
  std::uint32_t drawn_wrong = 0, found_wrong = 0;
  for (std::uint32_t seed = 40; seed < 60; ++seed) {
    Random random(seed);
    const Vec3 normal = normalized(random.in_box(0.5f) + Vec3{0, 0, 1}, {0, 0, 1});
    const Vec3 right = normalized(cross({0, 1, 0}, normal), {1, 0, 0}), up = cross(normal, right);
    MadeScene scene;
    const float offset = seed % 3 == 0 ? 0 : 0.3f;  // 0: the one covers the other
    for (int i = 0; i < 3; ++i) {
      const Vec3 center = right * random.between(-offset, offset) +
                          up * random.between(-offset, offset) + Vec3{3, 0, 0};
      const float wide = random.between(0.2f, 0.9f), high = random.between(0.2f, 0.9f);
      add_rectangle(scene, right, up, center, wide, high);
    }
    Camera camera = camera_at({3, 0, 3}, {3, 0, 0});
    camera.orthographic = seed % 2 == 0;
    const auto expected = cast(scene, camera, kSide, kSide);
    const Executor executor(2);
    const CameraFrame frame = make_camera_frame(camera, kSide, kSide);
    drawn_wrong +=
        compare(expected, rasterizer_->visible_triangles(executor, scene, frame), kSide, kSide)
            .pixels;
    const auto found = rendered(*rasterizer_, scene, camera, kSide, kSide);
    found_wrong += compare(expected, found, kSide, kSide).pixels;
  }
  EXPECT_GT(drawn_wrong, 1000u);
  // Where rays find now the one and now the other, some pixels surrounded by others are missed.
  EXPECT_LT(found_wrong, drawn_wrong / 10);
}

TEST_F(RasterizerTest, DegenerateTrianglesAreHarmless) {
  MadeScene scene = soup(100, 0.5f, 11);
  Random random(12);
  const float huge = std::numeric_limits<float>::max();
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.in_box(1), b = random.in_box(1);
    add(scene, a, a, a);
    add(scene, a, b, b);
    add(scene, a, b, a + (b - a) * 0.5f);
    add(scene, a, b, b + random.in_box(1e-7f));
  }
  add(scene, {0, 0, 3}, {0, 0, 3}, {1, 0, 2});  // touches the eye
  add(scene, {-huge, 0, 0}, {huge, 0, 0}, {0, huge, -huge});
  const auto picture = rendered(*rasterizer_, scene, camera_at({0, 0, 3}, {}), 100, 100);
  EXPECT_TRUE(shows_something(picture));
}

TEST_F(RasterizerTest, ManyTrianglesInSeveralDrawCalls) {
  MadeScene scene;
  const std::uint32_t count = (1u << 20) + 1000;
  for (std::uint32_t i = 0; i < count; ++i) {
    add(scene, {-9, -9, -3}, {9, -9, -3}, {-9, -8, -3});  // outside of the image
  }
  add(scene, {-9, -9, -2}, {9, -9, -2}, {0, 9, -2});
  const auto picture = rendered(*rasterizer_, scene, Camera{}, 4, 4);
  EXPECT_EQ(picture, std::vector<std::uint32_t>(16, count));
}

TEST_F(RasterizerTest, DoesNotDependOnThreads) {
  const MadeScene scene = soup(20000, 0.05f, 13);
  const Camera camera = camera_at({1, 2, 3}, {});
  std::vector<std::uint32_t> first;
  for (const std::uint32_t threads : {1u, 2u}) {
    const Executor executor(threads);
    auto picture =
        rasterizer_->visible_triangles(executor, scene, make_camera_frame(camera, 200, 200));
    resolve_silhouettes(executor, scene, make_camera_frame(camera, 200, 200), picture);
    if (first.empty()) first = picture;
    EXPECT_EQ(picture, first) << threads;
  }
}

TEST_F(RasterizerTest, TwoAtOnceAndOneFromTwoThreads) {
  const MadeScene scenes[2] = {soup(3000, 0.2f, 14), soup(2000, 0.3f, 15)};
  const Camera camera = camera_at({1, 2, 3}, {});
  std::vector<std::uint32_t> expected[2];
  for (int i = 0; i < 2; ++i) expected[i] = rendered(*rasterizer_, scenes[i], camera, 90, 70);
  int wrong[2] = {};
  const auto work = [&](int i) {
    Rasterizer own;
    for (int frame = 0; frame < 10; ++frame) {
      Rasterizer& used = frame % 2 == 0 ? own : *rasterizer_;
      if (rendered(used, scenes[i], camera, 90, 70) != expected[i]) ++wrong[i];
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  EXPECT_EQ(wrong[0], 0);
  EXPECT_EQ(wrong[1], 0);
}

TEST_F(RasterizerTest, RefusesPicturesItCannotDraw) {
  const Executor executor(1);
  const MadeScene scene = soup(3, 1, 16);
  const auto code_for = [&](std::uint32_t width, std::uint32_t height) {
    try {
      static_cast<void>(
          rasterizer_->visible_triangles(executor, scene, make_camera_frame({}, width, height)));
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  EXPECT_EQ(code_for(0, 5), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_for(5, 0), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_for(1u << 20, 1), ErrorCode::kUnsupported);
  EXPECT_EQ(rendered(*rasterizer_, scene, Camera{}, 4, 4).size(), 16u);  // and it can go on
}

TEST(Rasterizer, SaysWhenThereIsNoGraphics) {
  setenv("RAYSHEAF_NO_GL", "1", 1);
  try {
    const Rasterizer rasterizer;
    ADD_FAILURE() << "a context although RAYSHEAF_NO_GL is set";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kNoGraphics);
    EXPECT_NE(error.sentence().find("`trace` as `primary`"), std::string::npos) << error.what();
    EXPECT_NE(error.sentence().find("RAYSHEAF_NO_GL"), std::string::npos) << error.what();
  }
  unsetenv("RAYSHEAF_NO_GL");
}

}  // namespace
}  // namespace raysheaf::test
