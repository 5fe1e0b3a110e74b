#include "methods/dual/ray_order.h"

#include <algorithm>
#include <numeric>

#include "dual/dual_scenes.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

std::vector<Ray> rays_of(std::size_t count, Random& random) {
  std::vector<Ray> rays;
  Ray ray;
  for (std::size_t i = 0; i < count; ++i) {
    if (i == 0 || random.below(4) != 0) {
      ray.origin = random.in_box(random.below(50) == 0 ? 1e6f : 3);
      ray.direction = any_direction(random);
    }
    rays.push_back(ray);
  }
  return rays;
}

/// The quarter's number by its definition, from the ray-triangle test's own axes.
std::uint32_t expected_quarter(const Ray& ray) {
  const RaySetup setup = make_ray_setup(ray);
  const int z = setup.axis_z, next = (z + 1) % 3, last = (z + 2) % 3;
  const auto against = [&](int axis) { return std::signbit(component(ray.direction, axis)); };
  return static_cast<std::uint32_t>(8 * z + (against(z) ? 4 : 0) + (against(next) ? 2 : 0) +
                                    (against(last) ? 1 : 0));
}

void expect_order(const std::vector<Ray>& rays, const RayOrder& order) {
  ASSERT_EQ(order.rays.size(), rays.size());
  std::vector<std::uint8_t> seen(rays.size(), 0);
  for (const std::uint32_t r : order.rays) {
    ASSERT_LT(r, rays.size());
    EXPECT_EQ(seen[r]++, 0);
  }
  EXPECT_EQ(order.starts[0], 0u);
  EXPECT_EQ(order.starts[kQuarters], rays.size());
  for (std::uint32_t q = 0; q < kQuarters; ++q)
    for (std::uint32_t i = order.starts[q]; i < order.starts[q + 1]; ++i)
      ASSERT_EQ(quarter_of(rays[order.rays[i]].direction), q);
}

TEST(RayOrder, QuartersAreThoseOfTheTest) {
  Random random(1);
  std::vector<std::uint8_t> met(kQuarters, 0);
  for (const Ray& ray : rays_of(20000, random)) {
    const std::uint32_t q = quarter_of(ray.direction);
    ASSERT_EQ(q, expected_quarter(ray)) << words(ray);
    // For a ray against its axis, the other two axes are swapped.
    const RaySetup setup = make_ray_setup(ray);
    const int next = (setup.axis_z + 1) % 3, last = (setup.axis_z + 2) % 3;
    EXPECT_EQ(setup.axis_x, (q & 4) != 0 ? last : next);
    EXPECT_EQ(setup.axis_y, (q & 4) != 0 ? next : last);
    met[q] = 1;
  }
  EXPECT_EQ(std::count(met.begin(), met.end(), 1), kQuarters);
}

TEST(RayOrder, QuartersAreTheSameOnEverySimdTarget) {
  Random random(4);
  std::vector<Ray> rays = rays_of(5000, random);
  constexpr float kValues[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e-40f, -1e-40f, 1e30f};
  for (const float x : kValues)
    for (const float y : kValues)
      for (const float z : kValues) rays.push_back({{0, 0, 0}, 0, {x, y, z}, 1});
  test::for_each_simd_target([&](const char* target) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{5}, rays.size()}) {
      std::vector<std::uint8_t> quarters(count + 1, 0xff);
      EXPECT_EQ(find_quarters(View<const Ray>(rays).slice(0, count), rays[0], quarters.data()),
                count == 0)
          << target;
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(quarters[i], quarter_of(rays[i].direction)) << target << ": " << words(rays[i]);
      EXPECT_EQ(quarters[count], 0xff);
    }
  });
}

TEST(RayOrder, KnowsRaysOfOneStart) {
  Random random(12);
  RayOrder order;
  test::for_each_simd_target([&](const char* target) {
    for (const std::size_t count : {1, 7, 40, 20000}) {
      std::vector<Ray> rays;
      while (rays.size() < count) rays.push_back({{1, -2, 0}, 0.5f, any_direction(random), 1});
      const auto is_one = [&] {
        order_rays(Executor(2), rays, &order);
        return order.one_start;
      };
      EXPECT_TRUE(is_one()) << target;
      if (count == 1) continue;
      for (const std::size_t i : {std::size_t{0}, count / 3, count - 1}) {
        const Ray kept = rays[i];
        rays[i].origin.z = -0.0f;
        EXPECT_FALSE(is_one()) << target << " " << i;
        rays[i] = kept;
        rays[i].t_min = 0.25f;
        EXPECT_FALSE(is_one()) << target << " " << i;
        rays[i] = kept;
      }
    }
  });
}

TEST(RayOrder, RaysOfAQuarterKeepTheirOrder) {
  Random random(5);
  std::vector<Ray> rays;
  while (rays.size() < 40000) {  // runs of all lengths
    const Vec3 direction = any_direction(random);
    for (std::uint32_t n = random.below(40); n > 0; --n)
      rays.push_back({random.in_box(1), 0, direction, 1});
  }
  RayOrder order;
  for (const std::uint32_t threads : {1u, 3u}) {
    order_rays(Executor(threads), View<const Ray>(rays), &order);
    expect_order(rays, order);
    for (std::uint32_t q = 0; q < kQuarters; ++q)
      EXPECT_TRUE(std::is_sorted(order.rays.begin() + order.starts[q],
                                 order.rays.begin() + order.starts[q + 1]));
  }
}

/// Rays whose quarters change within rows and from row to row.
std::vector<Ray> rays_of_picture(std::size_t row, std::size_t count) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % row) - 0.4f * static_cast<float>(row);
    const float y = static_cast<float>(i / row) - 10.5f;
    rays.push_back({{0, 0, 0}, 0, {x, y, 50}, 1});
  }
  return rays;
}

TEST(RayOrder, PicturesGoInTiles) {
  RayOrder order, other;
  for (const std::size_t row : {1u, 3u, 4u, 7u, 64u, 1001u, 9000u}) {
    for (const std::size_t count : {1u, 30u, 64u, 4000u, 40000u, 81001u}) {
      const std::vector<Ray> rays = rays_of_picture(row, count);
      order_rays(one_thread(), View<const Ray>(rays), &order, row);
      expect_order(rays, order);
      order_rays(two_threads(), View<const Ray>(rays), &other, row);
      ASSERT_TRUE(std::ranges::equal(order.rays, other.rays)) << row << ", " << count;
    }
  }
  // All rays are in one quarter, and the last row is incomplete.
  const std::vector<Ray> rays(5 * 10, Ray{{0, 0, 0}, 0, {1, 2, 3}, 1});
  order_rays(one_thread(), View<const Ray>(rays), &order, 10);
  std::vector<std::uint32_t> expected;
  for (const std::uint32_t x : {0u, 4u})
    for (std::uint32_t k = 0; k < 16; ++k) expected.push_back(x + k / 4 * 10 + k % 4);
  for (std::uint32_t k = 0; k < 8; ++k) expected.push_back(k / 2 * 10 + 8 + k % 2);
  for (std::uint32_t k = 40; k < 50; ++k) expected.push_back(k);
  EXPECT_TRUE(std::ranges::equal(order.rays, expected));
}

TEST(RayOrder, RowsOfTilesAreWhole) {
  for (const std::size_t row : {1u, 4u, 1000u, 9000u})
    for (const std::size_t size : {1u, 1024u, 16384u}) {
      const std::size_t rays = rows_of_tiles(size, row);
      EXPECT_EQ(rays % (4 * row), 0u);
      EXPECT_GE(rays, 4 * row);
      EXPECT_LE(rays, size + 4 * row);
    }
}

TEST(RayOrder, AnyNumberOfRays) {
  Random random(2);
  RayOrder order;
  for (const std::size_t count : {0, 1, 2, 3, 16, 17, 33, 1000, 16384, 16385, 70000, 5}) {
    const std::vector<Ray> rays = rays_of(count, random);
    order_rays(one_thread(), View<const Ray>(rays), &order);
    expect_order(rays, order);
  }
}

TEST(RayOrder, TiesKeepTheirOrder) {
  Random random(3);
  const std::vector<Ray> rays = rays_of(40000, random);
  RayOrder order;
  order_rays(two_threads(), View<const Ray>(rays), &order);
  for (std::uint32_t q = 0; q < kQuarters; ++q)
    EXPECT_TRUE(std::is_sorted(order.rays.begin() + order.starts[q],
                               order.rays.begin() + order.starts[q + 1]));
}

TEST(RayOrder, SameWithAnyThreads) {
  Random random(5);
  for (const std::size_t count : {100, 5000, 60000}) {
    const std::vector<Ray> rays = rays_of(count, random);
    RayOrder a, b;
    order_rays(one_thread(), View<const Ray>(rays), &a);
    order_rays(two_threads(), View<const Ray>(rays), &b);
    EXPECT_TRUE(std::equal(a.rays.begin(), a.rays.end(), b.rays.begin(), b.rays.end()));
    EXPECT_EQ(a.starts, b.starts);
  }
}

TEST(RayOrder, OriginsAtOnePlaceAndEverywhere) {
  Random random(6);
  RayOrder order;
  for (const float half : {0.0f, 1e-45f, 1e-30f, 1e30f, 3.4e38f}) {
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i) {
      rays.push_back({random.in_box(1) * half, 0, any_direction(random), kInfinity});
      if (i % 3 == 0) rays.back().direction = rays.back().direction * 1e-44f;
      if (!(max_component(abs(rays.back().direction)) > 0)) rays.back().direction = {1e-45f, 0, 0};
    }
    order_rays(one_thread(), View<const Ray>(rays), &order);
    expect_order(rays, order);
  }
}

}  // namespace
}  // namespace raysheaf::test
