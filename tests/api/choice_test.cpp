// Queries in which not all hits count: sides, masks of rays, skipped triangles, and the beginnings
// of rows. Their answers are the rows of all hits, filtered hit by hit.
#include <algorithm>
#include <set>

#include "api/api_support.h"
#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/hit_points.h"
#include "support/guarded_memory.h"
#include "support/simd_targets.h"
#include "support/soups.h"

namespace raysheaf::test {
namespace {

/// Soups of a kind, and a closed box; instances with masks, some mirrored, one that is flat.
void fill_choice(Scene* scene, SoupKind kind, std::uint64_t seed, int triangles = 120) {
  Random random(seed);
  Mesh mesh;
  for (int i = 0; i < triangles; ++i) add_soup_triangle(&mesh, kind, random);
  const MeshId soup = scene->add(mesh.positions, mesh.triangles, {.mask = 1});
  const Cube cube;
  const MeshId box = scene->add(cube.positions, cube.triangles, {.place = false});
  for (std::uint32_t i = 0; i < 12; ++i) {
    Affine map = translation(random.in_box(6));
    map.m[i % 3][i % 3] = i % 2 == 0 ? -1.5f : 0.7f;
    scene->instance(box, map, 1u << i % 5);
  }
  Affine mirror;
  mirror.m[0][0] = -1;
  scene->instance(soup, mirror, 6);
  Affine flat;
  flat.m[2][2] = 0;
  scene->instance(box, flat, 9);
  scene->commit();
}

enum class Mix { kWild, kOneOrigin, kCamera, kOnSurfaces };
constexpr Mix kMixes[] = {Mix::kWild, Mix::kOneOrigin, Mix::kCamera, Mix::kOnSurfaces};

std::vector<Ray> mixed_rays(const Scene& scene, Mix batch, std::size_t count) {
  Random random(count);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % 256) / 128 - 1;
    const float y = static_cast<float>(i / 256) / 12 - 1;
    if (batch == Mix::kCamera)
      rays.push_back({{0, 0, -15}, 0, {x, y, 4}, kInfinity});
    else
      rays.push_back({batch == Mix::kOneOrigin ? Vec3{0.1f, 0.2f, 0.3f} : random.in_box(12), 0,
                      random.direction(), i % 5 == 0 ? 9.0f : kInfinity});
  }
  if (batch != Mix::kOnSurfaces) return rays;
  const std::vector<Hit> hits = closest_hit(scene, rays);
  const std::vector<HitPoint> points = hit_points(scene, rays, hits);
  for (std::size_t i = 0; i < count; ++i)
    if (hits[i].prim_id != kInvalidId) rays[i].origin = points[i].position;
  return rays;
}

/// The options, and whether they take a hit.
struct Chosen {
  std::vector<std::uint32_t> masks;
  std::vector<TriangleId> skip;
  QueryOptions options;

  Chosen(const HitRows& rows, Sides sides, bool by_mask, bool skipping) {
    Random random(rows.size());
    options.sides = sides;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      masks.push_back(static_cast<std::uint32_t>(random.in_box(16).x + 16));
      // Mostly the nearest or second triangle, at times none, or one that there is not.
      skip.push_back(i % 7 == 0 ? TriangleId{99, 3} : TriangleId{0, i % 3 == 0 ? 5u : 0xfffffffeu});
      if (rows[i].size() > i % 2) skip.back() = triangle_of(rows[i][i % 2]);
      if (i % 11 == 0) skip.back() = {};
    }
    if (by_mask) options.ray_masks = masks;
    if (skipping) options.skip = skip;
  }
  [[nodiscard]] bool takes(const Scene& scene, std::size_t ray, const Hit& hit, bool front) const {
    if (!options.skip.empty() && skip[ray].inst_id == hit.inst_id &&
        skip[ray].prim_id == hit.prim_id)
      return false;
    if (!options.ray_masks.empty() && (scene.mask(hit.inst_id) & options.mask & masks[ray]) == 0)
      return false;
    return options.sides == Sides::kBoth || front == (options.sides == Sides::kFront);
  }
};

std::vector<std::vector<Hit>> chosen_rows(const Scene& scene, const std::vector<Ray>& rays,
                                          const HitRows& rows, const Chosen& chosen) {
  std::vector<Ray> ray_of_hit;
  for (std::size_t i = 0; i < rays.size(); ++i)
    ray_of_hit.insert(ray_of_hit.end(), rows[i].size(), rays[i]);
  const std::vector<HitPoint> points = hit_points(scene, ray_of_hit, rows.hits);
  std::vector<std::vector<Hit>> expected(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t k = rows.offsets[i]; k < rows.offsets[i + 1]; ++k)
      if (chosen.takes(scene, i, rows.hits[k], points[k].front))
        expected[i].push_back(rows.hits[k]);
  return expected;
}

void expect_rows(const HitRows& rows, const std::vector<std::vector<Hit>>& expected,
                 std::size_t most) {
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), std::min(most, expected[i].size())) << i;
    for (std::size_t k = 0; k < rows[i].size(); ++k)
      ASSERT_TRUE(same(rows[i][k], expected[i][k])) << i << ": " << shown(rows[i][k]);
  }
}

void expect_chosen(const Scene& scene, const std::vector<Ray>& rays,
                   const std::vector<std::vector<Hit>>& expected, const QueryOptions& options) {
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const std::vector<std::uint8_t> occluded = any_hit(scene, rays, options);
  const std::vector<std::uint32_t> counts = hit_counts(scene, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit right = expected[i].empty() ? Hit{} : expected[i].front();
    ASSERT_TRUE(same(hits[i], right)) << i << ": " << shown(hits[i]) << ", not " << shown(right);
    ASSERT_EQ(occluded[i], expected[i].empty() ? 0 : 1) << i;
    ASSERT_EQ(counts[i], expected[i].size()) << i;
  }
  expect_rows(all_hits(scene, rays, options), expected, ~std::size_t{0});
  expect_rows(first_hits(scene, rays, 2, options), expected, 2);
}

struct AskedChoice {
  Sides sides;
  bool by_mask, skipping;
};
constexpr AskedChoice kChoices[] = {{Sides::kFront, false, false}, {Sides::kBack, false, false},
                                    {Sides::kBoth, true, false},   {Sides::kBoth, false, true},
                                    {Sides::kFront, true, true},   {Sides::kBack, false, true}};

void expect_choices(const Scene& scene, Mix batch, std::size_t count, bool by_brute_force) {
  const std::vector<Ray> rays = mixed_rays(scene, batch, count);
  const HitRows rows = all_hits(scene, rays, {.method = QueryMethod::kBrute});
  for (const AskedChoice& choice : kChoices) {
    Chosen chosen(rows, choice.sides, choice.by_mask, choice.skipping);
    const std::vector<std::vector<Hit>> expected = chosen_rows(scene, rays, rows, chosen);
    expect_chosen(scene, rays, expected, chosen.options);
    chosen.options.method = QueryMethod::kBrute;
    if (by_brute_force) expect_chosen(scene, rays, expected, chosen.options);
  }
}

TEST(Choice, OnEverySimdTarget) {
  Scene scene, large;
  fill_choice(&scene, SoupKind::kSmall, 1);
  fill_choice(&large, SoupKind::kSmall, 1, 2500);  // for streams in blocks
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    for (const Mix batch : kMixes) expect_choices(scene, batch, 200, false);
    expect_choices(large, Mix::kCamera, 300, false);
  });
}

TEST(Choice, OnEverySoup) {
  for (const SoupKind kind : soup_kinds()) {
    SCOPED_TRACE(static_cast<int>(kind));
    Scene scene;
    fill_choice(&scene, kind, 2);
    for (const Mix batch : kMixes) expect_choices(scene, batch, 60, true);
  }
}

/// How a query's rays go together, as its plan says.
std::string bundles_of(const Scene& scene, Mix batch, std::size_t count) {
  const std::vector<std::uint32_t> masks(count, 7);
  QueryStatistics statistics;
  static_cast<void>(closest_hit(scene, mixed_rays(scene, batch, count),
                                {.statistics = &statistics, .ray_masks = masks}));
  for (const std::string& sentence : statistics.plan)
    if (sentence.starts_with("bundles: ")) return sentence.substr(9, sentence.find(',') - 9);
  return "none";
}

TEST(Choice, InBundlesOfEveryKind) {
  std::set<std::string> bundles;
  for (const int triangles : {120, 2500}) {
    Scene scene;
    fill_choice(&scene, SoupKind::kSmall, 3, triangles);
    for (const Mix batch : kMixes) {
      const std::size_t count = triangles == 120 ? 6000 : 2500;
      bundles.insert(bundles_of(scene, batch, count));
      expect_choices(scene, batch, count, false);
    }
  }
  EXPECT_EQ(bundles, (std::set<std::string>{"streams", "long streams"}));
}

TEST(Choice, WhileTheSceneMoves) {
  Scene scene;
  fill_choice(&scene, SoupKind::kSmall, 4);
  for (int frame = 0; frame < 3; ++frame) {
    expect_choices(scene, Mix::kWild, 200, false);
    for (const InstanceId instance : scene.instances(1)) {
      Affine map = scene.transform(instance);
      map.m[frame][frame] *= -1;  // instances that were mirrored are not, and the reverse
      scene.set_transform(instance, map);
    }
    scene.commit();
  }
}

TEST(Choice, WithMasksOfQueriesToo) {
  Scene scene;
  fill_choice(&scene, SoupKind::kLarge, 5);
  const std::vector<Ray> rays = mixed_rays(scene, Mix::kWild, 500);
  for (const std::uint32_t mask : {1u, 6u, 16u}) {
    const HitRows rows = all_hits(scene, rays, {.method = QueryMethod::kBrute, .mask = mask});
    Chosen chosen(rows, Sides::kFront, true, true);
    chosen.options.mask = mask;
    expect_chosen(scene, rays, chosen_rows(scene, rays, rows, chosen), chosen.options);
  }
}

/// One bit has to be in the masks of the instance, of the query and of the ray.
TEST(Choice, MasksShareABit) {
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles, {.mask = 6});
  scene.commit();
  const std::vector<Ray> rays(3, along_z());
  const std::vector<std::uint32_t> masks{2, 4, 6};
  for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute})
    EXPECT_EQ(any_hit(scene, rays, {.method = method, .mask = 4, .ray_masks = masks}),
              (std::vector<std::uint8_t>{0, 1, 1}));
}

TEST(Choice, OnDevicesByTheCpu) {
  const Executor executor(2);
  GuardedMemory memory;
  const Context context =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory));
  Scene scene(context);
  fill_choice(&scene, SoupKind::kSmall, 6);
  for (const Mix batch : kMixes) expect_choices(scene, batch, 200, false);
}

TEST(Choice, ABoxIsEnteredByItsFronts) {
  Scene scene;
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}};
  const MeshId mesh = scene.add(positions, triangles);
  scene.commit();
  const Ray ray = along_z(0.25f, 0.25f);  // towards +z, where the front looks
  EXPECT_EQ(first_hit(scene, ray, {.sides = Sides::kFront}).prim_id, kInvalidId);
  EXPECT_EQ(first_hit(scene, ray, {.sides = Sides::kBack}).t, 10);
  Affine mirror;
  mirror.m[2][2] = -1;
  scene.set_transform(scene.instances(mesh).front(), mirror);
  scene.commit();
  EXPECT_EQ(first_hit(scene, ray, {.sides = Sides::kFront}).t, 10);
}

TEST(Choice, FirstHitsAreThoseOfAll) {
  Scene scene;
  fill_choice(&scene, SoupKind::kLarge, 7);
  const std::vector<Ray> rays = mixed_rays(scene, Mix::kWild, 300);
  const HitRows all = all_hits(scene, rays);
  for (const std::uint32_t most : {0u, 1u, 3u, 0xffffffffu}) {
    const HitRows first = first_hits(scene, rays, most);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(first[i].size(), std::min<std::size_t>(most, all[i].size()));
      for (std::size_t k = 0; k < first[i].size(); ++k) EXPECT_TRUE(same(first[i][k], all[i][k]));
    }
  }
}

TEST(Choice, RefusesWhatDoesNotFit) {
  Scene scene;
  fill_choice(&scene, SoupKind::kSmall, 8);
  const std::vector<Ray> rays(3, along_z());
  const std::vector<std::uint32_t> masks(2, 1);
  const std::vector<TriangleId> skip(4);
  const auto refuse = [&](const char* place, const char* words, const QueryOptions& options) {
    expect_error(ErrorCode::kInvalidArgument, place, words,
                 [&] { static_cast<void>(closest_hit(scene, rays, options)); });
    expect_error(ErrorCode::kInvalidArgument, place, words,
                 [&] { static_cast<void>(all_hits(scene, rays, options)); });
  };
  refuse("ray_masks", "2 are given for 3 rays", {.ray_masks = masks});
  refuse("skip", "4 are given for 3 rays", {.skip = skip});
  refuse("sides", "there is no value 3", {.sides = static_cast<Sides>(3)});
}

}  // namespace
}  // namespace raysheaf::test
