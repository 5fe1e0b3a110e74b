#include "raster/resolve.h"

#include <gtest/gtest.h>

#include "exec/executor.h"
#include "pictures.h"

namespace raysheaf::test {
namespace {

constexpr std::uint32_t kWidth = 90, kHeight = 70;

std::vector<std::uint32_t> resolved(const FlatScene& scene, const Camera& camera,
                                    std::vector<std::uint32_t> picture, std::uint32_t threads = 2) {
  resolve_silhouettes(Executor(threads), scene, camera, kWidth, kHeight, picture);
  return picture;
}

TEST(Resolve, LeavesTheTruthAlone) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const FlatScene scene = soup(200, 0.6f, seed);
    const Camera camera = camera_at({1, 0.5f, 3}, {});
    const auto truth = cast(scene, camera, kWidth, kHeight);
    EXPECT_EQ(resolved(scene, camera, truth), truth);
  }
}

/// Moves ids across borders: some pixels take the id of their right or lower neighbour.
TEST(Resolve, SetsBordersRight) {
  for (std::uint32_t seed = 10; seed < 14; ++seed) {
    const FlatScene scene = soup(60, 1, seed);
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
    // The truth is found again where a neighbour still holds it: nearly everywhere.
    const Difference left = compare(truth, resolved(scene, camera, wrong), kWidth, kHeight);
    EXPECT_LE(left.pixels, moved / 10);
    EXPECT_EQ(left.interior, 0u);
  }
}

TEST(Resolve, PixelsAwayFromBordersAreNotLookedAt) {
  const FlatScene scene = soup(5, 1, 20);
  const std::vector<std::uint32_t> nonsense(kWidth * kHeight, 3);
  EXPECT_EQ(resolved(scene, Camera{}, nonsense), nonsense);
}

TEST(Resolve, WhereNothingIsHitTheBackgroundOrTheOldTriangleStays) {
  FlatScene scene;
  for (int i = 0; i < 2; ++i) add(scene, {5, 5, 5}, {6, 5, 5}, {5, 6, 5});  // behind the eye
  std::vector<std::uint32_t> picture(kWidth * kHeight, 0);
  for (std::uint32_t y = 0; y < kHeight; ++y) picture[y * kWidth + 40] = 1;
  EXPECT_EQ(resolved(scene, Camera{}, picture), picture);

  auto with_background = picture;
  for (std::uint32_t& id : with_background) id = id == 1 ? kInvalidId : id;
  const auto found = resolved(scene, Camera{}, with_background);
  EXPECT_EQ(found[39], kInvalidId);
  EXPECT_EQ(found[41], kInvalidId);
  EXPECT_EQ(found[38], 0u);
}

TEST(Resolve, BacksOfSingleSidedTrianglesDoNotShow) {
  for (int flags = 0; flags < 4; ++flags) {
    FlatScene scene;
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
  const FlatScene scene = soup(300, 0.5f, 30);
  const Camera camera = camera_at({1, 0.5f, 3}, {});
  std::vector<std::uint32_t> noise(kWidth * kHeight);
  Random random(31);
  for (std::uint32_t& id : noise) id = random.below(scene.triangle_count);
  const auto one = resolved(scene, camera, noise, 1);
  for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(resolved(scene, camera, noise, 2), one);
}

}  // namespace
}  // namespace raysheaf::test
