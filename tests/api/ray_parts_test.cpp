// Rays in separate arrays, and batches that threads process tile by tile.
#include <algorithm>
#include <utility>

#include "raysheaf/types.h"

#include "api/api_support.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

/// Camera rays row by row, with `columns` per row: neighbours are coherent.
std::vector<Ray> picture(std::size_t count, std::size_t columns = 300) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % columns) / static_cast<float>(columns) - 0.5f;
    const float y = static_cast<float>(i / columns) / static_cast<float>(columns) - 0.5f;
    rays.push_back({{x, 0, -9}, 0, {x, y, 1}, kInfinity});
  }
  return rays;
}

/// Incoherent rays: neighbours have nothing in common.
std::vector<Ray> disorder(std::size_t count) {
  Random random(6);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({random.in_box(9), 0, random.direction(), kInfinity});
  return rays;
}

Scene scene_of(const RandomSoup& soup) {
  Scene scene;
  scene.add_soup(soup.positions);
  scene.commit();
  return scene;
}

/// Rays as separate arrays in a caller's layout; no memory follows the last number.
template <class Number>
struct Kept {
  std::vector<Number> numbers;
  NumberRows rows;
};

enum class Layout { kRows, kColumns, kBackwards, kApart };
constexpr Layout kLayouts[] = {Layout::kRows, Layout::kColumns, Layout::kBackwards, Layout::kApart};

template <class Number, class Get>
Kept<Number> kept(std::size_t count, std::size_t width, Layout layout, const Get& get) {
  const auto n = static_cast<std::ptrdiff_t>(count), w = static_cast<std::ptrdiff_t>(width);
  std::ptrdiff_t first = 0, row = w, column = 1;
  if (layout == Layout::kColumns) row = 1, column = n;
  if (layout == Layout::kBackwards) first = (n - 1) * w, row = -w;
  if (layout == Layout::kApart) row = 2 * w + 1, column = 2;
  Kept<Number> made;
  const std::ptrdiff_t last = first + std::max<std::ptrdiff_t>(0, (n - 1) * row) + (w - 1) * column;
  made.numbers.assign(static_cast<std::size_t>(last + 1), Number{77});
  for (std::ptrdiff_t i = 0; i < n; ++i)
    for (std::ptrdiff_t k = 0; k < w; ++k)
      made.numbers[static_cast<std::size_t>(first + i * row + k * column)] =
          get(static_cast<std::size_t>(i), static_cast<int>(k));
  made.rows = NumberRows(made.numbers.data() + first, row, column);
  return made;
}

template <class Number>
struct KeptRays {
  Kept<Number> origins, directions, t_min, t_max;

  KeptRays(const std::vector<Ray>& rays, Layout layout)
      : origins(kept<Number>(rays.size(), 3, layout,
                             [&](std::size_t i, int k) { return component(rays[i].origin, k); })),
        directions(
            kept<Number>(rays.size(), 3, layout,
                         [&](std::size_t i, int k) { return component(rays[i].direction, k); })),
        t_min(kept<Number>(rays.size(), 1, layout,
                           [&](std::size_t i, int) { return rays[i].t_min; })),
        t_max(kept<Number>(rays.size(), 1, layout,
                           [&](std::size_t i, int) { return rays[i].t_max; })),
        count(rays.size()) {}
  [[nodiscard]] RayParts parts() const {
    return {count, origins.rows, directions.rows, t_min.rows, t_max.rows};
  }

 private:
  std::size_t count;
};

void expect_same_answers(const Scene& scene, const RayParts& parts, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  closest_hit(scene, parts, hits);
  EXPECT_TRUE(std::ranges::equal(hits, closest_hit(scene, rays), same));
  std::vector<std::uint8_t> occluded(rays.size());
  any_hit(scene, parts, occluded);
  EXPECT_EQ(occluded, any_hit(scene, rays));
  std::vector<std::uint32_t> counts(rays.size());
  hit_counts(scene, parts, counts);
  EXPECT_EQ(counts, hit_counts(scene, rays));
  EXPECT_TRUE(std::ranges::equal(all_hits(scene, parts).hits, all_hits(scene, rays).hits, same));
}

TEST(RayParts, AnswerAsPackedRaysDo) {
  const RandomSoup soup(300, 0);
  const Scene scene = scene_of(soup);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    for (const std::size_t count : {1, 2, 511, 512, 513, 1500}) {
      std::vector<Ray> rays = picture(count);
      for (std::size_t i = 0; i < count; i += 3) rays[i].t_min = 2, rays[i].t_max = 9.5f;
      for (const Layout layout : kLayouts) {
        const KeptRays<float> floats(rays, layout);
        expect_same_answers(scene, floats.parts(), rays);
        const KeptRays<double> doubles(rays, layout);
        expect_same_answers(scene, doubles.parts(), rays);
      }
    }
  });
}

TEST(RayParts, MayShareOneOriginAndHaveNoLimits) {
  const RandomSoup soup(300, 0);
  const Scene scene = scene_of(soup);
  std::vector<Ray> rays = picture(1000);
  for (Ray& ray : rays) ray.origin = {0, 0, -9};
  const KeptRays<double> some(rays, Layout::kRows);
  const double origin[] = {0, 0, -9};
  const float limits[] = {0, kInfinity};
  expect_same_answers(scene, {rays.size(), NumberRows(origin, 0), some.directions.rows}, rays);
  expect_same_answers(scene,
                      {rays.size(), NumberRows(origin, 0), some.directions.rows,
                       NumberRows(limits, 0), NumberRows(limits + 1, 0)},
                      rays);
}

// All directions for all origins: each array is as short as what does not repeat in it.
TEST(RayParts, MayComeInBlocks) {
  const RandomSoup soup(300, 0);
  const Scene scene = scene_of(soup);
  const std::vector<Ray> some = picture(1500);
  for (const std::size_t block : {1, 2, 7, 300, 511, 600}) {
    const std::size_t blocks = 1000 / block + 1;
    std::vector<Ray> rays(blocks * block);
    for (std::size_t i = 0; i < rays.size(); ++i)
      rays[i] = {some[i % block].origin, static_cast<float>(i / block % 3),
                 some[i / block].direction, 9.5f - static_cast<float>(i % block % 2)};
    const std::vector<Ray> first(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(block));
    const std::vector<Ray> other(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(blocks));
    const KeptRays<double> inner(first, Layout::kRows);
    const KeptRays<float> outer(other, Layout::kColumns);
    std::vector<float> least, most;
    for (std::size_t b = 0; b < blocks; ++b) least.push_back(static_cast<float>(b % 3));
    for (std::size_t i = 0; i < block; ++i) most.push_back(9.5f - static_cast<float>(i % 2));
    NumberRows directions = outer.directions.rows, t_min(least.data(), 0);
    directions.block_stride = std::exchange(directions.row_stride, 0);
    t_min.block_stride = 1;
    RayParts parts(rays.size(), inner.origins.rows, directions, t_min, NumberRows(most.data(), 1));
    parts.block = block;
    expect_same_answers(scene, parts, rays);
  }
}

/// A batch of rays with the plan that it must get.
struct Batch {
  std::vector<Ray> rays;
  const char* plan;
};
std::vector<Batch> batches(std::size_t count) {
  return {{picture(count), "stages: one after the other for tiles of "},
          {disorder(count), "bundles: long streams"}};
}

/// Compares every 37th ray with brute force, because all of them would take too long.
void expect_right(const Scene& scene, const Batch& batch) {
  const std::vector<Ray>& rays = batch.rays;
  const KeptRays<double> kept(rays, Layout::kRows);
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  QueryStatistics statistics;
  const QueryOptions counting{.count_tests = true, .statistics = &statistics};
  closest_hit(scene, kept.parts(), hits, counting);
  EXPECT_GT(statistics.ray_bound_tests, 0u);
  EXPECT_TRUE(std::ranges::any_of(statistics.plan, [&](const std::string& sentence) {
    return sentence.starts_with(batch.plan);
  }));
  any_hit(scene, kept.parts(), occluded);
  std::vector<Ray> some;
  for (std::size_t i = 0; i < rays.size(); i += 37) some.push_back(rays[i]);
  const std::vector<Hit> expected = closest_hit(scene, some, {.method = QueryMethod::kBrute});
  for (std::size_t i = 0; i < some.size(); ++i) {
    ASSERT_TRUE(same(hits[37 * i], expected[i])) << 37 * i;
    ASSERT_EQ(occluded[37 * i] != 0, expected[i].prim_id != kInvalidId) << 37 * i;
  }
}

TEST(RayParts, TilesAnswerAsBruteForceDoes) {
  const RandomSoup soup(5000, 0, 0.1f);
  const Scene scene = scene_of(soup);
  for (const Batch& batch : batches(40001)) expect_right(scene, batch);
  expect_right(scene, {picture(40001), "order: tiles of four by four, because rows of 300 rays"});
}

/// Memory that is reused from query to query must fit batches of any size.
TEST(RayParts, BatchesOfOneSceneMayBeOfAnySize) {
  const RandomSoup soup(5000, 0, 0.1f);
  const Scene scene = scene_of(soup);
  for (const std::size_t count : {16384u, 16385u, 1000u, 100000u, 1024u})
    for (const Batch& batch : batches(count)) expect_right(scene, batch);
}

TEST(RayParts, CountsAreThoseOfAnyNumberOfThreads) {
  const RandomSoup soup(5000, 0, 0.1f);
  for (const Batch& batch : batches(40001)) {
    std::uint64_t tests = 0;
    for (const std::uint32_t threads : {1u, 2u, 5u}) {
      Scene scene(Context({.threads = threads}));
      scene.add_soup(soup.positions);
      scene.commit();
      QueryStatistics statistics;
      (void)closest_hit(scene, batch.rays, {.count_tests = true, .statistics = &statistics});
      if (threads == 1) tests = statistics.tests();
      EXPECT_EQ(statistics.tests(), tests);
      EXPECT_GE(statistics.total_ms,
                statistics.trace_ms + statistics.order_ms + statistics.check_ms);
    }
  }
}

void expect_first_wrong_ray_named(const Scene& scene, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  KeptRays<double> kept(rays, Layout::kRows);
  for (const std::size_t wrong : {59999u, 30001u, 9000u, 16u, 0u}) {
    kept.directions.numbers[3 * wrong + 1] = 1e300;
    const std::string place = "rays[" + std::to_string(wrong) + "].direction";
    for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute})
      expect_error(ErrorCode::kInvalidData, place, "not finite",
                   [&] { closest_hit(scene, kept.parts(), hits, {.method = method}); });
  }
  hits.pop_back();
  expect_error(ErrorCode::kInvalidArgument, "hits", "59999 results for 60000 rays",
               [&] { closest_hit(scene, kept.parts(), hits); });
}

TEST(RayParts, NumbersThatAreMissingAreNamed) {
  const Scene scene = scene_of(RandomSoup(10, 0, 0.1f));
  const std::vector<double> there(9, 1.0);
  const NumberRows given(there.data());
  std::vector<Hit> hits(3);
  for (const NumberRows& none : {NumberRows(), NumberRows(static_cast<const double*>(nullptr))}) {
    expect_error(ErrorCode::kInvalidArgument, "rays.origins", "no array for 3 rays",
                 [&] { closest_hit(scene, RayParts(3, none, given), hits); });
    expect_error(ErrorCode::kInvalidArgument, "rays.directions", "no array for 3 rays",
                 [&] { closest_hit(scene, RayParts(3, given, none), hits); });
    closest_hit(scene, RayParts(0, none, none), std::span<Hit>());
  }
}

TEST(RayParts, TheFirstWrongRayIsNamed) {
  const RandomSoup soup(5000, 0, 0.1f);
  const Scene scene = scene_of(soup);
  for (const Batch& batch : batches(60000)) expect_first_wrong_ray_named(scene, batch.rays);
}

}  // namespace
}  // namespace raysheaf::test
