// Results are right at the limits of binary32: scales, positions, lengths, origins, intervals.
#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

TEST(DualRange, Scales) {
  Random random(11);
  for (const float scale : {1e-37f, 1e-30f, 1e-15f, 1e-9f, 1e-4f, 1e4f, 1e9f, 1e15f, 6e16f}) {
    for (const Shape shape : {Shape::kSmall, Shape::kLarge, Shape::kSlivers, Shape::kLattice,
                              Shape::kAxisAligned, Shape::kClosed}) {
      SCOPED_TRACE(testing::Message() << scale << " " << static_cast<int>(shape));
      const Soup soup = make_soup(shape, 80, random, scale);
      std::vector<Ray> rays = any_rays(soup, 150, random, scale);
      expect_right(soup, rays);
      start_at(random.in_box(9) * scale, 0, &rays);
      expect_right(soup, rays);
    }
  }
}

TEST(DualRange, OffTheOrigin) {
  Random random(12);
  for (const float far : {1e3f, 1e6f, 1e7f, 1e12f}) {
    for (const Shape shape : kShapes) {
      SCOPED_TRACE(testing::Message() << far << " " << static_cast<int>(shape));
      const Vec3 offset{far, -0.7f * far, 0.3f * far};
      const Soup soup = make_soup(shape, 80, random, 0.3f, offset);
      std::vector<Ray> rays = any_rays(soup, 150, random, 0.3f, offset);
      expect_right(soup, rays);
      start_at(offset + random.in_box(2), 0, &rays);
      expect_right(soup, rays);
    }
  }
}

TEST(DualRange, LengthsOfDirections) {
  Random random(13);
  for (const float scale : {1e-15f, 1e-6f, 1.0f, 1e6f, 1e15f}) {
    for (const float length :
         {1e-44f, 1e-41f, 3e-39f, 1e-37f, 1e-30f, 1e-15f, 1e15f, 1e30f, 1e37f, 3e38f}) {
      SCOPED_TRACE(testing::Message() << scale << " " << length);
      const Shape shape = kShapes[random.below(7)];
      const Soup soup = make_soup(shape, 60, random, scale);
      std::vector<Ray> rays = any_rays(soup, 200, random, scale);
      for (Ray& ray : rays) {
        ray.direction = ray.direction * (1 / max_component(abs(ray.direction))) * length;
        if (!(max_component(abs(ray.direction)) > 0)) ray.direction = {0, length, 0};
        if (ray.t_max == 1) ray.t_max = scale / length;
        if (ray.t_min == 1) ray.t_min = std::min(ray.t_max, scale / length);
        if (random.below(8) == 0) ray.t_min = ray.t_max;
        if (random.below(8) == 0) ray.t_min = std::min(ray.t_max, 1e36f);
        if (random.below(8) == 0) ray.t_min = std::min(ray.t_max, 1e25f);
      }
      expect_right(soup, rays);
      keep_one_hit(soup, &rays, random);
      expect_right(soup, rays);
      for (Ray& ray : rays) {
        ray.origin = rays[0].origin, ray.t_min = 0;
        if (random.below(2) == 0) ray.t_max = kInfinity;
      }
      expect_right(soup, rays);
    }
  }
}

TEST(DualRange, EmptyIntervals) {
  Random random(14);
  const Soup soup = make_soup(Shape::kLarge, 50, random);
  std::vector<Ray> rays = any_rays(soup, 200, random);
  for (Ray& ray : rays) ray.t_min = ray.t_max = random.below(2) == 0 ? kInfinity : 3e38f;
  EXPECT_EQ(expect_right(soup, rays), 0u);
}

/// A hit whose parameter overflows is a miss.
TEST(DualRange, ParametersThatOverflow) {
  Random random(15);
  const Soup soup = make_soup(Shape::kLarge, 50, random);
  std::vector<Ray> rays = any_rays(soup, 300, random);
  for (Ray& ray : rays) {
    ray.direction = ray.direction * (1e-39f / max_component(abs(ray.direction)));
    ray.t_min = 1e38f;
    ray.t_max = kInfinity;
  }
  for (std::size_t i = 0; i < rays.size(); i += 2) rays[i].t_min = kInfinity;
  EXPECT_LT(expect_right(soup, rays), 20u);
  for (Ray& ray : rays) ray.origin = rays[0].origin, ray.t_min = 1e38f;
  EXPECT_LT(expect_right(soup, rays), 20u);
}

TEST(DualRange, OriginsFarAway) {
  Random random(16);
  const float far[] = {1e4f, 1e7f, 1e10f, 1e15f, 1e20f, 1e29f, 3e30f, 1e36f, 3.4e38f};
  for (const Shape shape : {Shape::kSmall, Shape::kLarge, Shape::kLattice, Shape::kClosed}) {
    const Soup soup = make_soup(shape, 60, random);
    std::vector<Ray> rays = any_rays(soup, 80, random);
    for (const float distance : far) {
      for (int i = 0; i < 15; ++i) {
        const auto t = soup.corners(random.below(soup.count()));
        Vec3 o = random.direction() * distance, d = t[0] - o;
        if (i % 3 == 0) {
          o = {i % 2 == 0 ? distance : -distance, t[1].y, t[1].z};
          d = {i % 2 == 0 ? -1.0f : 1.0f, 0, -0.0f};
        }
        if (i % 10 == 0) d = any_direction(random);
        rays.push_back({o, 0, d, kInfinity});
      }
    }
    // The rays together with nearby ones in bundles and streams, and separately.
    expect_right(soup, rays);
    for (const float distance : far) {
      std::vector<Ray> together(rays.begin(), rays.begin() + 30);
      start_at(random.direction() * distance, 0, &together);
      expect_right(soup, together);
    }
    const std::vector<Ray> mixed = [&] {
      std::vector<Ray> r = rays;
      for (std::size_t i = r.size(); i > 1; --i)
        std::swap(r[i - 1], r[random.below(static_cast<std::uint32_t>(i))]);
      return r;
    }();
    EXPECT_GT(expect_right(soup, mixed), 20u);
  }
}

/// Up to the largest coordinate that a scene may have.
TEST(DualRange, SceneOfAllSizes) {
  Random random(17);
  Soup soup = make_soup(Shape::kLarge, 60, random, 6e16f);
  const Soup small = make_soup(Shape::kSmall, 60, random);
  soup.positions.insert(soup.positions.end(), small.positions.begin(), small.positions.end());
  std::vector<Ray> rays = any_rays(soup, 80, random, 6e16f);
  for (const Ray& ray : any_rays(small, 80, random)) rays.push_back(ray);
  EXPECT_GT(expect_right(soup, rays), 10u);
  for (const float from : {1.0f, 1e10f, 1e30f, 1e37f}) {
    start_at(random.direction() * from, 0, &rays);
    expect_right(soup, rays);
  }
}

}  // namespace
}  // namespace raysheaf::test
