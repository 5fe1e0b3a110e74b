// The same at the ends of what a binary32 number can be: scales, places, lengths, origins, ranges.
#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

TEST(DualRange, Scales) {
  Random random(11);
  for (const float scale : {1e-15f, 1e-9f, 1e-4f, 1e4f, 1e9f, 1e15f, 1e25f, 1e36f}) {
    for (const Shape shape : {Shape::kSmall, Shape::kLarge, Shape::kSlivers, Shape::kLattice,
                              Shape::kAxisAligned, Shape::kClosed}) {
      SCOPED_TRACE(testing::Message() << scale << " " << static_cast<int>(shape));
      const Heap heap = make_heap(shape, 80, random, scale);
      expect_right(heap, any_rays(heap, 150, random, scale));
    }
  }
}

TEST(DualRange, OffTheOrigin) {
  Random random(12);
  for (const float far : {1e3f, 1e6f, 1e7f, 1e12f}) {
    for (const Shape shape : kShapes) {
      SCOPED_TRACE(testing::Message() << far << " " << static_cast<int>(shape));
      const Vec3 offset{far, -0.7f * far, 0.3f * far};
      const Heap heap = make_heap(shape, 80, random, 0.3f, offset);
      expect_right(heap, any_rays(heap, 150, random, 0.3f, offset));
    }
  }
}

TEST(DualRange, LengthsOfDirections) {
  Random random(13);
  for (const float scale : {1e-15f, 1e-6f, 1.0f, 1e6f, 1e15f}) {
    for (const float length :
         {1e-44f, 1e-41f, 3e-39f, 1e-37f, 1e-30f, 1e-15f, 1e15f, 1e30f, 1e37f}) {
      SCOPED_TRACE(testing::Message() << scale << " " << length);
      const Shape shape = kShapes[random.below(7)];
      const Heap heap = make_heap(shape, 60, random, scale);
      std::vector<Ray> rays = any_rays(heap, 200, random, scale);
      for (Ray& ray : rays) {
        ray.direction = ray.direction * (1 / max_component(abs(ray.direction))) * length;
        if (!(max_component(abs(ray.direction)) > 0)) ray.direction = {0, length, 0};
        if (ray.t_max == 1) ray.t_max = scale / length;
        if (ray.t_min == 1) ray.t_min = std::min(ray.t_max, scale / length);
        if (random.below(8) == 0) ray.t_min = ray.t_max;
        if (random.below(8) == 0) ray.t_min = std::min(ray.t_max, 1e36f);
        if (random.below(8) == 0) ray.t_min = std::min(ray.t_max, 1e25f);
      }
      expect_right(heap, rays);
      keep_one_hit(heap, &rays, random);
      expect_right(heap, rays);
    }
  }
}

TEST(DualRange, NowhereToLook) {
  Random random(14);
  const Heap heap = make_heap(Shape::kLarge, 50, random);
  std::vector<Ray> rays = any_rays(heap, 200, random);
  for (Ray& ray : rays) ray.t_min = ray.t_max = random.below(2) == 0 ? kInfinity : 3e38f;
  EXPECT_EQ(expect_right(heap, rays), 0u);
}

/// Parameters that overflow are infinite, and in [inf, inf].
TEST(DualRange, InfiniteHits) {
  Random random(15);
  const Heap heap = make_heap(Shape::kLarge, 50, random);
  std::vector<Ray> rays = any_rays(heap, 300, random);
  for (Ray& ray : rays) {
    ray.direction = ray.direction * (1e-39f / max_component(abs(ray.direction)));
    ray.t_min = random.below(2) == 0 ? kInfinity : 1e38f;
    ray.t_max = kInfinity;
  }
  EXPECT_GT(expect_right(heap, rays), 100u);
}

}  // namespace
}  // namespace raysheaf::test
