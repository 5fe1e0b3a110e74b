// Detects which batches are rows of an image.
#include "queries/ray_samples.h"

#include <cmath>

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

/// Computes an image's ray from its column and row in pixels.
using Pixel = Ray (*)(float x, float y);

Ray perspective(float x, float y) {
  const float u = x / 300 - 1, v = 1 - y / 300;
  return {{0, 0, 3}, 0, Vec3{u, v, -1} / std::sqrt(u * u + v * v + 1), kInfinity};
}
Ray orthographic(float x, float y) {
  return {{1e3f + x, 1e3f - y, 0}, 0, {0, 0, 1}, kInfinity};
}

std::vector<Ray> picture(std::size_t row, std::size_t rows, Pixel pixel, float jitter) {
  Random random(7);
  std::vector<Ray> rays;
  const auto somewhere = [&] { return jitter * random.unit(); };
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < row; ++x)
      rays.push_back(
          pixel(static_cast<float>(x) + somewhere(), static_cast<float>(y) + somewhere()));
  return rays;
}

std::size_t row_of(const std::vector<Ray>& rays) {
  return find_picture_row(RaysInPlace(View<const Ray>(rays)));
}

TEST(PictureRows, AreFound) {
  for (const Pixel pixel : {perspective, orthographic})
    for (const float jitter : {0.0f, 0.9f})
      for (const std::size_t row : {40u, 512u, 513u, 600u})
        EXPECT_EQ(row_of(picture(row, 9, pixel, jitter)), row) << row << ", " << jitter;
  EXPECT_EQ(row_of(picture(kLongestRow, 8, orthographic, 0)), kLongestRow);
}

/// Rays that leave a wall and three pillars in front of it: steps at the pillars' edges are nearly
/// as long as those from the end of a row to the next.
Ray reflected(float x, float y) {
  const bool on_pillar = static_cast<int>(x / 50) % 3 == 1;
  return {{x, y, on_pillar ? 400.0f : 0.0f}, 0, {on_pillar ? 0.5f : -0.5f, 0.1f, 1}, kInfinity};
}

TEST(PictureRows, AreFoundAcrossSilhouettes) {
  for (const std::size_t row : {301u, 512u})
    EXPECT_EQ(row_of(picture(row, 40, reflected, 0)), row) << row;
}

TEST(PictureRows, AreNotFoundWhereRaysAreMissing) {
  for (const Pixel pixel : {perspective, reflected}) {
    Random random(5);
    std::vector<Ray> some;
    for (const Ray& ray : picture(512, 64, pixel, 0))
      if (some.size() < 4096 || random.unit() < 0.97f) some.push_back(ray);
    EXPECT_EQ(row_of(some), 0u);
  }
}

TEST(PictureRows, AreNotFoundWhereThereAreNone) {
  EXPECT_EQ(row_of({}), 0u);
  EXPECT_EQ(row_of(std::vector<Ray>(1)), 0u);
  EXPECT_EQ(row_of(std::vector<Ray>(5000, Ray{{0, 0, 0}, 0, {0, 0, 1}, 1})), 0u);
  EXPECT_EQ(row_of(picture(64, 7, perspective, 0)), 0u) << "too few rows";
  EXPECT_EQ(row_of(picture(20, 100, perspective, 0)), 0u) << "too short";
  EXPECT_EQ(row_of(picture(kLongestRow + 1, 9, orthographic, 0)), 0u) << "too long";
  Random random(3);
  std::vector<Ray> scattered;
  for (int i = 0; i < 5000; ++i)
    scattered.push_back({random.in_box(5), 0, random.direction(), kInfinity});
  EXPECT_EQ(row_of(scattered), 0u);
}

/// A scanner's rings are much farther apart than the rays within a ring.
TEST(PictureRows, AreNotTakenForTilesWhereTheyLieFarApart) {
  EXPECT_EQ(row_of(picture(
                600, 20, [](float x, float y) { return perspective(x, 9 * y); }, 0)),
            0u);
}

/// Rays that come in tiles, row after row of them, are already in a good order.
TEST(PictureRows, AreNotThoseOfTiles) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < 40000; ++i) {
    const std::size_t tile = i / 16, k = i % 16;
    rays.push_back(perspective(static_cast<float>(4 * (tile % 100) + k % 4),
                               static_cast<float>(4 * (tile / 100) + k / 4)));
  }
  EXPECT_EQ(row_of(rays), 0u);
}

TEST(PictureRows, MayBeWrong) {
  std::vector<Ray> rays = picture(100, 20, perspective, 0);
  for (const std::size_t wrong : {0u, 50u, 99u, 100u, 300u}) {
    std::vector<Ray> some = rays;
    some[wrong].direction.x = std::nanf("");
    const std::size_t row = row_of(some);
    EXPECT_TRUE(row == 0 || row == 100);
  }
}

}  // namespace
}  // namespace raysheaf::test
