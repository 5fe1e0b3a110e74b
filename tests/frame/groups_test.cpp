// `dual` traces paths in groups of pixels, one per thread: it gives the image of the methods that
// process all pixels at once, and the same counts with any number of threads.
#include <gtest/gtest.h>

#include <vector>

#include "raysheaf/render.h"
#include "render/frame/primary.h"
#include "render/shade/shade.h"
#include "support/pictures.h"
#include "support/same_picture.h"

namespace raysheaf {
namespace {

RenderOptions of_size(std::uint32_t width, std::uint32_t height) {
  RenderOptions options = test::small_options(width);
  options.height = height;
  return options;
}

void expect_as_whole(const SceneDescription& scene, RenderOptions options) {
  options.method = Method::kGl10;
  const RenderResult whole = render(scene, options);
  options.method = Method::kDual;
  const RenderResult groups = render(scene, options);
  test::expect_same_picture(groups, whole);
  const auto &ours = groups.statistics.batches, &theirs = whole.statistics.batches;
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].kind, theirs[i].kind);
    EXPECT_EQ(ours[i].rays, theirs[i].rays);
    EXPECT_EQ(ours[i].hits, theirs[i].hits);
    // The plan describes one group, except that all groups share one tree.
    EXPECT_FALSE(ours[i].plan.empty());
    for (const std::string& sentence : ours[i].plan)
      EXPECT_TRUE(sentence.starts_with("[") || sentence.starts_with("object tree: ")) << sentence;
  }
}

/// Every pixel occurs once, in ascending order within a group; and each group's parts are parts of
/// the image.
void expect_groups_hold_all(PictureSize size) {
  const std::size_t pixels = std::size_t{size.width} * size.height;
  std::vector<int> held(pixels);
  for (const PixelGroup& group : groups_of(size)) {
    ASSERT_GT(group.count, 0u);
    ASSERT_LE(group.count, 4096u);
    for (std::size_t i = 0; i < group.count; ++i) {
      const std::size_t pixel = group.pixel(i);
      ASSERT_LT(pixel, pixels);
      ++held[pixel];
      if (i > 0) {
        ASSERT_GT(pixel, group.pixel(i - 1));
      }
      const std::size_t start = group.pixel(i / kSkyPart * kSkyPart);
      ASSERT_EQ(start % kSkyPart, 0u);
      ASSERT_EQ(pixel - start, i % kSkyPart);
    }
  }
  EXPECT_EQ(held, std::vector<int>(pixels, 1));
}

TEST(Groups, HoldEveryPixelOnce) {
  for (const PictureSize size : {PictureSize{1, 1},
                                 {64, 1},
                                 {64, 64},
                                 {63, 65},
                                 {128, 77},
                                 {500, 333},
                                 {512, 512},
                                 {640, 1100},
                                 {1000, 70},
                                 {1920, 1080}}) {
    SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
    expect_groups_hold_all(size);
  }
}

TEST(Groups, AreTilesWhereThePictureIsWholeOnesWide) {
  const std::vector<PixelGroup> groups = groups_of({512, 512});
  ASSERT_EQ(groups.size(), 64u);
  EXPECT_EQ(groups[9].first, 64u * 512 + 64);
  EXPECT_EQ(groups[9].pixel(4095), 127u * 512 + 127);
  EXPECT_EQ(groups_of({500, 512})[1].first, 4032u);
}

TEST(Groups, OfOneSampleGiveTheWholePicture) {
  Material glass;
  glass.transmission = 1;
  glass.roughness = 0;
  SceneDescription scene = test::ball_on_floor(glass);
  scene.lights.push_back(test::point_light({-3, 4, 1}, 50));
  expect_as_whole(scene, of_size(640, 480));
}

TEST(Groups, OfSeveralSamplesGiveTheWholePicture) {
  SceneDescription scene = test::ball_on_floor();
  scene.lights[0].radius = 0.5f;
  scene.cameras[0].aperture = 0.1f;
  RenderOptions options = of_size(640, 480);
  options.samples = 2;
  options.bounces = 0;
  expect_as_whole(scene, options);
}

/// So many groups that the primary hits of most are computed twice: for the sky, and for shading.
TEST(Groups, ComputedTwiceGiveTheWholePicture) {
  RenderOptions options = of_size(2048, 1200);
  options.bounces = 0;
  expect_as_whole(test::ball_on_floor(), options);
}

/// The pixels' tests add up over groups. The sky at the top, which sends no secondary rays, is a
/// group.
TEST(Groups, CountTheTestsOfTheirPixels) {
  SceneDescription scene = test::ball_on_floor();
  scene.cameras[0] = test::camera_at({0, 2.5f, 9}, {0, 4.5f, 0});
  RenderOptions options = of_size(512, 1100);
  options.count_pixel_tests = true;
  options.bounces = 0;
  const RenderResult result = render(scene, options);
  double sum = 0, total = 0;
  for (const float tests : result.tests) sum += double{tests};
  for (const BatchStatistics& batch : result.statistics.batches) {
    total += static_cast<double>(batch.total_tests());
    EXPECT_FALSE(batch.plan.empty());
  }
  EXPECT_NEAR(sum, total, 1e-5 * total);
}

TEST(Groups, AreReportedAsOneStageAndCanBeCancelled) {
  RenderOptions options = of_size(512, 1100);
  std::uint64_t told = 0;
  options.progress = [&](const Progress& progress) {
    if (progress.stage != "parts") {
      EXPECT_EQ(told, 0u) << progress.stage;
      return true;
    }
    EXPECT_EQ(progress.total, 144u);
    EXPECT_GE(progress.done, told);
    told = progress.done;
    return true;
  };
  (void)render(test::ball_on_floor(), options);
  EXPECT_EQ(told, 144u);
  options.progress = [](const Progress& progress) {
    return progress.stage != "parts" || progress.done < 1;
  };
  EXPECT_THROW((void)render(test::ball_on_floor(), options), Error);
}

}  // namespace
}  // namespace raysheaf
