// Large things next to small ones, and origins far away: answers are right, and rays meet few more
// triangles than without them.
#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

void add_plane(float half, float below, Soup* soup) {
  const Vec3 a{-half, -half, below}, b{half, -half, below}, c{half, half, below};
  soup->add(a, b, c);
  soup->add(a, c, {-half, half, below});
}

void add_sky(float half, Soup* soup) {
  for (const float side : {-half, half}) {
    soup->add({side, -half, -half}, {side, half, -half}, {side, half, half});
    soup->add({-half, side, -half}, {half, side, -half}, {half, side, half});
    soup->add({-half, -half, side}, {half, -half, side}, {half, half, side});
  }
}

Soup sphere(std::uint32_t side) {
  Soup soup;
  add_closed(side, &soup);
  return soup;
}

/// From `distance` lengths of a sphere, towards it.
std::vector<Ray> rays_at_sphere(float distance, std::size_t count, Random& random) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Vec3 o = random.direction() * (14 * distance);
    rays.push_back({o, 0, random.direction() * (6 * random.unit()) - o, kInfinity});
  }
  return rays;
}

TEST(DualFar, SmallNextToLarge) {
  Random random(41);
  for (const float half : {1e3f, 1e6f, 1e9f, 1e12f}) {
    for (const Shape shape : {Shape::kSmall, Shape::kLattice, Shape::kClosed, Shape::kManySizes}) {
      SCOPED_TRACE(testing::Message() << half << " " << static_cast<int>(shape));
      Soup soup = make_soup(shape, 60, random);
      std::vector<Ray> rays = any_rays(soup, 150, random);
      if (random.below(2) == 0) {
        add_plane(half, -11, &soup);
      } else {
        add_sky(half, &soup);
      }
      for (const Ray& ray : any_rays(soup, 50, random, half)) rays.push_back(ray);
      for (const Ray& ray : rays_at_sphere(half, 30, random)) rays.push_back(ray);
      expect_right(soup, rays);
      start_at(random.in_box(9), 0, &rays);
      expect_right(soup, rays);
    }
  }
}

TEST(DualFar, FromFarAndNear) {
  Random random(42);
  for (const float distance : {30.0f, 100.0f, 1e4f, 1e6f, 1e9f, 1e12f}) {
    for (const float offset : {0.0f, 1e5f}) {
      SCOPED_TRACE(testing::Message() << distance << " " << offset);
      Soup soup = make_soup(Shape::kClosed, 200, random, 1, {offset, -offset, offset});
      std::vector<Ray> rays = any_rays(soup, 150, random, 1, {offset, -offset, offset});
      for (Ray ray : rays_at_sphere(distance, 200, random)) {
        ray.origin = ray.origin + Vec3{offset, -offset, offset};
        if (random.below(4) == 0) ray.t_max = random.between(0.5f, 1.5f);
        if (random.below(4) == 0) ray.t_min = std::min(ray.t_max, random.between(0.5f, 1.5f));
        rays.insert(rays.begin() + random.below(static_cast<std::uint32_t>(rays.size())), ray);
      }
      expect_right(soup, rays);
      start_at(rays_at_sphere(distance, 1, random)[0].origin, 0, &rays);
      expect_right(soup, rays);
    }
  }
}

/// Long directions magnify a t that underflows.
TEST(DualFar, HitsJustBehindTheOrigin) {
  Random random(43);
  for (const float length : {1.0f, 1e10f, 1e30f, 1e38f}) {
    for (const float size : {1e-36f, 1e-20f, 1e-8f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << length << " " << size);
      Soup soup = make_soup(Shape::kSmall, 60, random, size);
      std::vector<Ray> rays;
      for (std::uint32_t i = 0; i < 200; ++i) {
        const auto t = soup.corners(random.below(soup.count()));
        const Vec3 d = random.direction();
        const Vec3 at = (t[0] + t[1] + t[2]) * (1 / 3.0f);
        rays.push_back({at + d * (size * 1e-7f * random.between(-1, 1)), 0, d * length, kInfinity});
        rays.push_back({t[0], 0, d * length, kInfinity});
      }
      expect_right(soup, rays);
    }
  }
}

std::uint64_t triangle_tests(Soup soup, const std::vector<Ray>& rays, Bundle bundle) {
  ObjectTree tree;
  make_tree(&soup, Tree::kFine, &tree);
  const DualScene scene{&tree, nullptr, Facing::kBoth, bundle};
  return ask(one_thread(), scene, rays, Sorting::kByQuarter).counts[0].triangle_tests;
}

TEST(DualFar, APlaneCostsNearRaysNothing) {
  Random random(44);
  const std::vector<Ray> rays = rays_at_sphere(1.5f, 2000, random);
  for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
    const std::uint64_t without = triangle_tests(sphere(100), rays, bundle);
    for (const float half : {1e3f, 1e6f, 1e9f}) {
      Soup soup = sphere(100);
      add_plane(half, -9, &soup);
      EXPECT_LT(triangle_tests(soup, rays, bundle), 2 * without) << half;
    }
  }
}

TEST(DualFar, RaysFromFarMeetFewTriangles) {
  Random random(45);
  const std::vector<Ray> near = rays_at_sphere(1.5f, 2000, random);
  for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
    const std::uint64_t of_near = triangle_tests(sphere(100), near, bundle);
    for (const float distance : {100.0f, 1e4f, 1e8f}) {
      const std::vector<Ray> far = rays_at_sphere(distance, 2000, random);
      EXPECT_LT(triangle_tests(sphere(100), far, bundle), 3 * of_near) << distance;
      std::vector<Ray> mixed = near;
      for (std::size_t i = 0; i < 16; ++i) mixed[i * 100] = far[i];
      EXPECT_LT(triangle_tests(sphere(100), mixed, bundle), 1.2 * static_cast<double>(of_near));
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
