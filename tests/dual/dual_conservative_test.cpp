// Bounds are conservative: for a million pairs of ray and triangle (a hundred million with
// RAYSHEAF_LONG=1), no bound excludes a pair that the ray-triangle test calls a hit.
#include <cstdlib>

#include "dual/dual_scenes.h"

namespace raysheaf::test {
namespace {

TEST(DualConservative, FindsEveryHit) {
  const std::size_t wanted = std::getenv("RAYSHEAF_LONG") != nullptr ? 100000000 : 1000000;
  Random random(31);
  std::size_t pairs = 0;
  for (std::uint32_t round = 0; pairs < wanted; ++round) {
    const Shape shape = kShapes[random.below(std::size(kShapes))];
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(80)) - 40);
    const float far = random.below(3) == 0 ? scale * std::pow(10.0f, random.between(0, 7)) : 0;
    const Vec3 offset = random.in_box(far);
    Soup soup = make_soup(shape, random.below(4) == 0 ? 1000 : 30, random, scale, offset);
    if (random.below(2) == 0) {
      const Soup more = make_soup(Shape::kLarge, soup.count(), random, scale, offset);
      soup.positions.insert(soup.positions.end(), more.positions.begin(), more.positions.end());
    }
    std::vector<Ray> rays =
        any_rays(soup, random.below(4) == 0 ? 3000 : 300, random, scale, offset);
    if (random.below(2) == 0) turn_into_one_quarter(&rays);
    if (random.below(2) == 0) start_at(offset + random.in_box(12 * scale), 0, &rays);
    const HitRows rows = brute_force(soup, rays);
    pairs += hit_count(rows) + 1;
    ObjectTree tree;
    make_tree(&soup, static_cast<Tree>(round % 3), &tree);
    for (const Bundle bundle : {Bundle::kStream, Bundle::kLongStream}) {
      const DualScene scene{&tree, nullptr, Facing::kBoth, bundle};
      const Sorting sorting = random.below(2) == 0 ? Sorting::kCurve : Sorting::kByQuarter;
      ASSERT_TRUE(right(rows, ask(one_thread(), scene, rays, sorting), rays))
          << "round " << round << " bundle " << static_cast<int>(bundle);
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
