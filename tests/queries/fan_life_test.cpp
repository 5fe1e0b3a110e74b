// Fans that are abandoned, and the engine's decisions when triangles change afterwards.
#include "dual/dual_scenes.h"
#include "queries/planned_queries.h"

namespace raysheaf::test {
namespace {

bool told(const QueryReport& report, const std::string& text) {
  return std::any_of(report.plan.begin(), report.plan.end(), [&](const std::string& reason) {
    return reason.find(text) != std::string::npos;
  });
}

/// Each triangle is in front of all rays of `rays_from_one_point`.
Soup dense_soup(Random& random) {
  Soup dense = make_soup(Shape::kSmall, 3000, random);
  for (std::size_t i = 0; i < dense.positions.size(); ++i) {
    constexpr Vec3 kCorners[] = {{-90, -90, 0}, {90, -90, 0}, {0, 120, 0}};
    dense.positions[i] = kCorners[i % 3] + Vec3{0, 0, 10 + random.unit()};
  }
  for (std::size_t t = 0; t < dense.indices.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      dense.indices[t][k] = static_cast<std::uint32_t>(3 * (t % (dense.positions.size() / 3))) + k;
  return dense;
}

std::vector<Ray> rays_from_one_point() {
  std::vector<Ray> rays(20000);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float x = static_cast<float>(i % 200) / 200 - 0.5f, y = static_cast<float>(i / 200) / 100;
    rays[i] = {{0, 0, 0}, 0, {x, y - 0.5f, 1}, kInfinity};
  }
  return rays;
}

/// The number of pairs of an abandoned fan predicts nothing about other triangles.
TEST(PlannedQueries, AnAbandonedFanIsTriedOnOtherTriangles) {
  Random random(17);
  Soup dense = dense_soup(random), sparse = make_soup(Shape::kSmall, 3000, random);
  const std::vector<Ray> rays = rays_from_one_point();
  std::vector<std::uint8_t> occluded(rays.size());
  PlannedQueries engine;
  const auto ask = [&] {
    QueryReport report;
    engine.any_hit(two_threads(), RaysInPlace(rays), {}, occluded, &report);
    return report;
  };
  engine.set_triangles(dense.source(), false);
  EXPECT_TRUE(told(ask(), "meet too many of their cells"));
  EXPECT_TRUE(told(ask(), "but streaming the triangles is")) << "these are known";
  engine.set_triangles(sparse.source(), false);
  EXPECT_FALSE(ask().used_tree);
}

/// If a fan fails for one set of triangles after another, it is rarely tried, and it is used again
/// when it succeeds. The answers do not change.
TEST(PlannedQueries, FansThatFailRepeatedlyAreTriedRarelyAndComeBack) {
  Random random(17);
  Soup dense = dense_soup(random), sparse = make_soup(Shape::kSmall, 3000, random);
  const std::vector<Ray> rays = rays_from_one_point();
  PlannedQueries engine;
  std::uint32_t given_up = 0, waited = 0, fans = 0;
  const auto frames = [&](Soup& soup, int count) {
    std::vector<std::uint8_t> expected;
    for (int i = 0; i < count; ++i) {
      engine.set_triangles(soup.source(), false);
      QueryReport report;
      std::vector<std::uint8_t> occluded(rays.size());
      engine.any_hit(two_threads(), RaysInPlace(rays), {}, occluded, &report);
      if (i == 0) expected = occluded;
      EXPECT_EQ(occluded, expected);
      given_up += told(report, "meet too many of their cells") ? 1 : 0;
      waited += told(report, "until the next attempt") ? 1 : 0;
      fans += report.used_tree ? 0 : 1;
    }
  };
  frames(dense, 40);
  EXPECT_EQ(given_up, 6u);  // at frames 0, 1, 3, 7, 15, 31
  EXPECT_EQ(waited, 34u);
  frames(sparse, 40);
  EXPECT_EQ(given_up, 6u);
  EXPECT_EQ(fans, 17u) << "from the 63rd frame on";
  frames(dense, 1);
  EXPECT_EQ(given_up, 7u);
}

}  // namespace
}  // namespace raysheaf::test
