#include "render/raster/resolve.h"

#include <gtest/gtest.h>

#include "exec/executor.h"
#include "pictures.h"

namespace raysheaf::test {
namespace {

constexpr std::uint32_t kWidth = 90, kHeight = 70;

std::vector<std::uint32_t> resolved(const FlatScene& scene, const Camera& camera,
                                    std::vector<std::uint32_t> picture, std::uint32_t threads = 2) {
  resolve_silhouettes(Executor(threads), scene, make_camera_frame(camera, kWidth, kHeight),
                      picture);
  return picture;
}

TEST(Resolve, KeepsCorrectPixels) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const MadeScene scene = soup(200, 0.6f, seed);
    const Camera camera = camera_at({1, 0.5f, 3}, {});
    const auto truth = cast(scene, camera, kWidth, kHeight);
    EXPECT_EQ(resolved(scene, camera, truth), truth);
  }
}

/// Moves ids across borders: some pixels take the id of their right or lower neighbour.
TEST(Resolve, CorrectsBorders) {
  for (std::uint32_t seed = 10; seed < 14; ++seed) {
    const MadeScene scene = soup(60, 1, seed);
    Camera camera = camera_at({1, 0.5f, 3}, {});
    camera.orthographic = seed % 2 == 1;
    const auto truth = cast(scene, camera, kWidth, kHeight);
    auto wrong = truth;
    Random random(seed);
    std::uint32_t moved = 0;
    for (std::uint32_t y = 0; y + 1 < kHeight; y += 2) {
      for (std::uint32_t x = 0; x + 1 < kWidth; x += 3) {
        const std::uint32_t i = y * kWidth + x;
        wrong[i] = truth[random.below(2) == 0 ? i + 1 : i + kWidth];
        if (wrong[i] != truth[i]) ++moved;
      }
    }
    ASSERT_GT(moved, 10u);
    // The resolve cannot restore a pixel whose triangle is in none of its neighbours.
    const Difference left = compare(truth, resolved(scene, camera, wrong), kWidth, kHeight);
    EXPECT_LE(left.pixels, moved / 10);
    EXPECT_EQ(left.interior, 0u);
  }
}

TEST(Resolve, CorrectsPixelsWhoseRayMissesTheirTriangle) {
  for (std::uint32_t seed = 20; seed < 24; ++seed) {
    const MadeScene scene = soup(100, 1.5f, seed);
    const Camera camera = camera_at({0.2f, 0.1f, seed % 2 == 0 ? 3.f : 0.5f}, {});
    const CameraFrame frame = make_camera_frame(camera, kWidth, kHeight);
    std::vector<std::uint32_t> noise(kWidth * kHeight);
    Random random(seed);
    for (std::uint32_t& id : noise) id = random.below(scene.triangle_count);
    const auto truth = cast(scene, camera, kWidth, kHeight);
    const auto found = resolved(scene, camera, noise);
    std::uint32_t missed = 0;
    for (std::uint32_t i = 0; i < noise.size(); ++i) {
      const RaySetup ray = make_ray_setup(camera_ray(frame, i % kWidth, i / kWidth));
      const auto sees = [&](std::uint32_t id) {
        TriangleHit hit;
        const auto [a, b, c] = scene.corners(id);
        return intersect_triangle(ray, a, b, c, &hit);
      };
      ASSERT_TRUE(found[i] == kInvalidId || sees(found[i]));
      if (sees(noise[i])) continue;
      ++missed;
      ASSERT_EQ(found[i], truth[i]);
    }
    EXPECT_GT(missed, noise.size() / 2);
  }
}

TEST(Resolve, SmallTrianglesAreFoundWhereNoPixelHoldsThem) {
  MadeScene scene = soup(3000, 0.02f, 25);
  add(scene, {-90, -90, -9}, {90, -90, -9}, {0, 90, -9});
  const Camera camera = camera_at({0, 0, 3}, {});
  const std::vector<std::uint32_t> only_the_wall(kWidth * kHeight, scene.triangle_count - 1);
  const auto truth = cast(scene, camera, kWidth, kHeight);
  ASSERT_NE(truth, only_the_wall);
  EXPECT_EQ(resolved(scene, camera, only_the_wall), truth);
}

TEST(Resolve, EmptyImagesStayEmpty) {
  const MadeScene scene = soup(50, 1, 26);
  const std::vector<std::uint32_t> noise(kWidth * kHeight, 7);
  const Camera away = camera_at({0, 0, 9}, {0, 0, 20});
  const auto found = resolved(scene, away, noise);
  EXPECT_EQ(found[0], kInvalidId);  // at the image's edge no id is trusted
  resolve_silhouettes(Executor(1), FlatScene{}, make_camera_frame(away, 0, 0), {});
}

TEST(Resolve, BacksOfSingleSidedTrianglesDoNotShow) {
  for (int flags = 0; flags < 4; ++flags) {
    MadeScene scene;
    add(scene, {-9, -9, -2}, {9, -9, -2}, {0, 9, -2}, static_cast<std::uint8_t>(flags));
    std::vector<std::uint32_t> picture(kWidth * kHeight, kInvalidId);
    picture[30 * kWidth + 45] = 0;
    const auto found = resolved(scene, Camera{}, picture);
    const bool shown = flags != (kSingleSided | kMirrored);
    EXPECT_EQ(found[30 * kWidth + 45], shown ? 0 : kInvalidId) << flags;
    EXPECT_EQ(found[31 * kWidth + 46], shown ? 0 : kInvalidId) << flags;
  }
}

TEST(Resolve, DoesNotDependOnThreads) {
  const MadeScene scene = soup(300, 0.5f, 30);
  const Camera camera = camera_at({1, 0.5f, 3}, {});
  std::vector<std::uint32_t> noise(kWidth * kHeight);
  Random random(31);
  for (std::uint32_t& id : noise) id = random.below(scene.triangle_count);
  const auto one = resolved(scene, camera, noise, 1);
  for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(resolved(scene, camera, noise, 2), one);
}

}  // namespace
}  // namespace raysheaf::test
