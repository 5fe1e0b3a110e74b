// Queries: the reported hits, masks, and refused arguments.
#include "raysheaf/query.h"

#include "api/api_support.h"
#include "api/query_check.h"
#include "geom/ray_fault.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

constexpr QueryMethod kMethods[] = {QueryMethod::kDual, QueryMethod::kBrute};

Scene two_squares() {
  Scene scene;
  const Square near(1), far(2);
  scene.add(near.positions, near.triangles);
  scene.add(far.positions, far.triangles);
  scene.commit();
  return scene;
}

TEST(Query, ReportsIdsAndWeights) {
  Scene scene;
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles, {.place = false});
  scene.instance(mesh, translation({0, 0, 5}));
  const InstanceId nearer = scene.instance(mesh, translation({0, 0, 2}));
  scene.commit();
  const Hit hit = first_hit(scene, along_z(0.5f, -0.25f));
  EXPECT_EQ(hit.t, 12);
  EXPECT_EQ(hit.geom_id, mesh);
  EXPECT_EQ(hit.inst_id, nearer);
  EXPECT_EQ(hit.prim_id, 0u);
  // (1 - u - v) a + u b + v c is the ray's point.
  EXPECT_FLOAT_EQ(-1 + 2 * hit.u + 2 * hit.v, 0.5f);
  EXPECT_FLOAT_EQ(-1 + 2 * hit.v, -0.25f);
}

TEST(Query, EqualDistancesGoToTheLeastIds) {
  Scene scene;
  const Square square;
  const MeshId first = scene.add(square.positions, square.triangles, {.place = false});
  const MeshId second = scene.add(square.positions, square.triangles);
  const InstanceId a = scene.instance(first, Affine{});
  const InstanceId b = scene.instance(first, Affine{});
  scene.commit();
  ASSERT_LT(scene.instances(second).front(), a);
  // A ray through the diagonal hits both triangles of each of the three instances.
  const Ray ray = along_z(0.5f, 0.5f);
  for (const QueryMethod method : kMethods) {
    const Hit hit = first_hit(scene, ray, {.method = method});
    EXPECT_EQ(hit.geom_id, first);
    EXPECT_EQ(hit.inst_id, a);
    EXPECT_EQ(hit.prim_id, 0u);
    const HitRows rows = all_hits(scene, std::span(&ray, 1), {.method = method});
    ASSERT_EQ(rows.size(), 1u);
    ASSERT_EQ(rows[0].size(), 6u);
    EXPECT_EQ(rows[0][2].inst_id, b);
    EXPECT_EQ(rows[0][5].geom_id, second);
    EXPECT_EQ(rows[0][5].prim_id, 1u);
  }
}

TEST(Query, HitsLieBetweenTheEnds) {
  const Scene scene = two_squares();
  Ray ray = along_z();
  ray.t_min = 11, ray.t_max = 11;
  EXPECT_EQ(first_hit(scene, ray).geom_id, 0u);
  ray.t_min = std::nextafter(11.0f, 12.0f), ray.t_max = kInfinity;
  EXPECT_EQ(first_hit(scene, ray).geom_id, 1u);
  ray.t_max = 11.5f;
  EXPECT_TRUE(same(first_hit(scene, ray), Hit{}));
  ray.t_min = kInfinity, ray.t_max = kInfinity;
  EXPECT_TRUE(same(first_hit(scene, ray), Hit{}));
}

TEST(Query, AllFourAgree) {
  const Scene scene = two_squares();
  const std::vector<Ray> rays{along_z(), along_z(3, 3), along_z(0.5f, -0.5f)};
  for (const QueryMethod method : kMethods) {
    const QueryOptions options{.method = method};
    const HitRows rows = all_hits(scene, rays, options);
    EXPECT_EQ(rows.offsets, (LargeVector<std::uint64_t>{0, 2, 2, 4}));
    EXPECT_EQ(hit_counts(scene, rays, options), (std::vector<std::uint32_t>{2, 0, 2}));
    EXPECT_EQ(any_hit(scene, rays, options), (std::vector<std::uint8_t>{1, 0, 1}));
    const std::vector<Hit> hits = closest_hit(scene, rays, options);
    EXPECT_TRUE(same(hits[0], rows[0][0]));
    EXPECT_TRUE(same(hits[1], Hit{}));
    EXPECT_TRUE(same(hits[2], rows[2][0]));
  }
}

TEST(Query, SeesTheInstancesThatItsMaskShows) {
  Scene scene;
  constexpr std::uint32_t kMasks[] = {1, 2, 6, 0, 0x80000000, 2};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Square square(static_cast<float>(i));
    scene.add(square.positions, square.triangles, {.mask = kMasks[i]});
  }
  scene.commit();
  const Ray ray = along_z();
  for (const QueryMethod method : kMethods) {
    for (const std::uint32_t mask : {1u, 2u, 3u, 4u, 8u, 0u, 0x80000000u, 0xffffffffu, 2u, 7u}) {
      std::vector<std::uint32_t> expected, found;
      for (std::uint32_t i = 0; i < 6; ++i)
        if ((kMasks[i] & mask) != 0) expected.push_back(i);
      const QueryOptions options{.method = method, .mask = mask};
      const HitRows rows = all_hits(scene, std::span(&ray, 1), options);
      for (const Hit& hit : rows[0]) found.push_back(hit.geom_id);
      EXPECT_EQ(found, expected) << mask;
      EXPECT_EQ(first_hit(scene, ray, options).geom_id,
                expected.empty() ? kInvalidId : expected.front());
      EXPECT_EQ(any_hit(scene, std::span(&ray, 1), options)[0], expected.empty() ? 0 : 1);
    }
  }
}

TEST(Query, MasksChangeWithCommits) {
  Scene scene;
  const Square near(1), far(2);
  const InstanceId a = scene.instances(scene.add(near.positions, near.triangles, {.mask = 1}))[0];
  const MeshId mesh = scene.add(far.positions, far.triangles, {.mask = 2});
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z(), {.mask = 2}).geom_id, mesh);
  scene.set_mask(a, 2);
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z(), {.mask = 2}).geom_id, 0u);
  EXPECT_EQ(first_hit(scene, along_z(), {.mask = 1}).geom_id, kInvalidId);
  scene.set_mask(a, 4);
  scene.update(mesh, near.positions);
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z(), {.mask = 2}).t, 11);
  scene.set_mask(a, 4);
  EXPECT_TRUE(scene.is_committed()) << "nothing has changed";
}

TEST(Query, NeedsACommit) {
  Scene scene;
  const std::vector<Ray> rays{along_z()};
  const auto refused = [&] {
    expect_error(ErrorCode::kWrongState, "scene", "commit()",
                 [&] { (void)closest_hit(scene, rays); });
    expect_error(ErrorCode::kWrongState, "scene", "commit()", [&] { (void)any_hit(scene, rays); });
    expect_error(ErrorCode::kWrongState, "scene", "commit()", [&] { (void)all_hits(scene, rays); });
    expect_error(ErrorCode::kWrongState, "scene", "commit()",
                 [&] { (void)hit_counts(scene, rays); });
    expect_error(ErrorCode::kWrongState, "scene", "commit()", [&] { (void)scene.bounds(); });
    scene.commit();
    EXPECT_EQ(closest_hit(scene, rays).size(), 1u);
  };
  refused();
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  refused();
  scene.update(mesh, square.positions);
  refused();
  scene.replace(mesh, square.positions, square.triangles);
  refused();
  const InstanceId instance = scene.instance(mesh, Affine{});
  refused();
  scene.set_transform(instance, scaling({2, 2, 2}));
  refused();
  scene.set_mask(instance, 1);
  refused();
  scene.remove_instance(instance);
  refused();
  scene.remove(mesh);
  refused();
}

TEST(Query, SpansAreOfEqualLength) {
  const Scene scene = two_squares();
  const std::vector<Ray> rays(3, along_z());
  std::vector<Hit> hits(2);
  std::vector<std::uint8_t> occluded(4);
  std::vector<std::uint32_t> counts;
  const auto code = ErrorCode::kInvalidArgument;
  expect_error(code, "hits", "2 results for 3 rays", [&] { closest_hit(scene, rays, hits); });
  expect_error(code, "occluded", "4 results for 3", [&] { any_hit(scene, rays, occluded); });
  expect_error(code, "counts", "0 results for 3", [&] { hit_counts(scene, rays, counts); });
}

struct WrongRay {
  const char* field;
  const char* words;
  std::function<void(Ray&)> spoil;
};

const std::vector<WrongRay>& wrong_rays() {
  static const std::vector<WrongRay> all{
      {"origin", "not finite", [](Ray& r) { r.origin.x = kNaN; }},
      {"origin", "not finite", [](Ray& r) { r.origin.y = kInfinity; }},
      {"origin", "not finite", [](Ray& r) { r.origin.z = -kInfinity; }},
      {"direction", "not finite", [](Ray& r) { r.direction.x = kInfinity; }},
      {"direction", "not finite", [](Ray& r) { r.direction.y = kNaN; }},
      {"direction", "not finite", [](Ray& r) { r.direction.z = -kInfinity; }},
      {"direction", "zero",
       [](Ray& r) {
         r.direction = {0, -0.0f, 0};
       }},
      {"t_min", "not a number", [](Ray& r) { r.t_min = kNaN; }},
      {"t_max", "not a number", [](Ray& r) { r.t_max = kNaN; }},
      {"t_min", "negative", [](Ray& r) { r.t_min = -1e-30f; }},
      {"t_min", "larger than t_max", [](Ray& r) { r.t_min = 2, r.t_max = 1; }},
      {"t_min", "larger than t_max", [](Ray& r) { r.t_max = -1; }},
  };
  return all;
}

TEST(Query, NamesTheFirstRayThatIsWrong) {
  const Scene scene = two_squares();
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    for (std::size_t kind = 0; kind < wrong_rays().size(); ++kind) {
      const WrongRay& wrong = wrong_rays()[kind];
      for (const std::size_t at : {std::size_t{0}, 1 + kind, std::size_t{40}}) {
        std::vector<Ray> rays(41, along_z());
        wrong.spoil(rays[at]);
        wrong.spoil(rays[40]);
        const std::string place = "rays[" + std::to_string(at) + "]." + wrong.field;
        expect_error(ErrorCode::kInvalidData, place, wrong.words,
                     [&] { (void)closest_hit(scene, rays); });
      }
    }
  });
  std::vector<Ray> many(100000, along_z());
  many[77777].t_min = many[90000].t_min = -1;
  expect_error(ErrorCode::kInvalidData, "rays[77777].t_min", "negative",
               [&] { (void)any_hit(scene, many); });
}

TEST(Query, ValidatesRaysTogetherAsOneByOne) {
  Random random(3);
  // Arbitrary bit patterns, and numbers whose exponents share bits.
  const auto number = [&](std::size_t kind) {
    if (kind % 3 == 0) return std::bit_cast<float>(random.bits());
    const float size = std::ldexp(1.0f, static_cast<int>(random.below(12)) - 6);
    return kind % 3 == 1 ? random.between(-size, size) : size;
  };
  for_each_simd_target([&](const char* target) {
    for (std::size_t i = 0; i < 5000; ++i) {
      std::vector<Ray> rays(17, along_z());
      Ray& ray = rays[random.below(17)];
      ray = {{number(i), number(i), number(i)}, 0, {number(i), number(i), number(i)}, kInfinity};
      if (i % 2 == 0) ray.t_min = number(i), ray.t_max = number(i);
      ASSERT_EQ(are_right(View<const Ray>(rays)), fault_of(ray).field == nullptr)
          << i << " " << target;
    }
  });
}

TEST(Query, AcceptsBarelyValidRays) {
  const Scene scene = two_squares();
  constexpr float kMost = std::numeric_limits<float>::max();
  constexpr float kLeast = std::numeric_limits<float>::denorm_min();
  const std::vector<Ray> rays{
      {{kMost, -kMost, kMost}, 0, {0, 0, kLeast}, 0},
      {{0, 0, 0}, -0.0f, {-kMost, 0, 0}, kInfinity},
      {{0, 0, 0}, kMost, {0, -kLeast, 0}, kMost},
      {{0, 0, 0}, kInfinity, {1, 1, 1}, kInfinity},
  };
  for_each_simd_target([&](const char* target) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::vector<Ray> many(17, rays[i]);
      EXPECT_NO_THROW((void)closest_hit(scene, many, {.method = QueryMethod::kBrute}))
          << i << " " << target;
    }
  });
}

TEST(Query, SkipsValidationOnRequest) {
  const Scene scene = two_squares();
  Ray ray = along_z();
  ray.t_min = -1;
  EXPECT_EQ(first_hit(scene, ray, {.check = false}).t, 11);
}

TEST(Query, AnswersNoRays) {
  const Scene scene = two_squares();
  for (const QueryMethod method : kMethods) {
    EXPECT_TRUE(closest_hit(scene, std::vector<Ray>(), QueryOptions{.method = method}).empty());
    EXPECT_TRUE(any_hit(scene, std::vector<Ray>(), QueryOptions{.method = method}).empty());
    EXPECT_EQ(all_hits(scene, std::vector<Ray>(), {.method = method}).offsets,
              LargeVector<std::uint64_t>(1, 0));
    EXPECT_EQ(all_hits(scene, std::vector<Ray>(), {.method = method}).size(), 0u);
  }
}

TEST(Query, ReportsItsStatistics) {
  Scene scene = two_squares();
  const std::vector<Ray> rays(10, along_z());
  QueryStatistics statistics;
  (void)closest_hit(
      scene, rays, {.method = QueryMethod::kBrute, .count_tests = true, .statistics = &statistics});
  EXPECT_EQ(statistics.rays, 10u);
  EXPECT_EQ(statistics.triangles, 4u);
  EXPECT_EQ(statistics.triangle_tests, 40u);
  EXPECT_EQ(statistics.tests(), 40u);
  const double update_ms = statistics.update_ms;
  EXPECT_GT(update_ms, 0);
  EXPECT_GE(statistics.total_ms, statistics.trace_ms + statistics.check_ms);
  EXPECT_FALSE(statistics.plan.empty());
  scene.commit();
  (void)any_hit(scene, rays, {.mask = 0, .statistics = &statistics});
  EXPECT_EQ(statistics.update_ms, update_ms) << "nothing was committed";
  EXPECT_EQ(statistics.triangles, 0u);
  EXPECT_EQ(statistics.tests(), 0u);
  (void)any_hit(scene, std::span<const Ray>{}, QueryOptions{.statistics = &statistics});
  EXPECT_EQ(statistics.rays, 0u);
  EXPECT_EQ(statistics.triangles, 4u);
}

/// More incoherent rays than go through the tree at once (queries/quartered_rays.h).
TEST(Query, LargeScatteredBatchesAreAnsweredAsSmallOnes) {
  const RandomSoup soup(40, 5000);
  Scene scene(Context({.threads = 2}));
  scene.add_soup(soup.positions);
  scene.commit();
  std::vector<Ray> rays((std::size_t{1} << 21) + 7777);
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i] = soup.rays[i % soup.rays.size()];
  const auto hits = closest_hit(scene, soup.rays), all_hits = closest_hit(scene, rays);
  const auto occluded = any_hit(scene, soup.rays), all_occluded = any_hit(scene, rays);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t one = i % soup.rays.size();
    wrong += same(all_hits[i], hits[one]) && all_occluded[i] == occluded[one] ? 0 : 1;
  }
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace raysheaf::test
