// Scenes whose instances have more triangles in all than 32 bits can number: rays enter them where
// they stand. The answers follow from a formula.
#include <memory>

#include "api/api_support.h"
#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/hit_points.h"
#include "raysheaf/points.h"
#include "support/guarded_memory.h"

namespace raysheaf::test {
namespace {

/// Layers of squares at the heights 0, 2, 4, ..., each of kSide by kSide cells of two triangles, at
/// multiples of kApart. All coordinates are whole numbers.
class Layers {
 public:
  static constexpr std::uint32_t kSide = 100, kApart = 128;

  Layers(std::uint32_t across, std::uint32_t layers,
         const Context& context = Context({.threads = 2}))
      : scene(context), across_(across), layers_(layers) {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    for (std::uint32_t y = 0; y <= kSide; ++y)
      for (std::uint32_t x = 0; x <= kSide; ++x)
        positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
    for (std::uint32_t y = 0; y < kSide; ++y)
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t a = y * (kSide + 1) + x, b = a + kSide + 1;
        triangles.push_back({a, a + 1, b});
        triangles.push_back({a + 1, b + 1, b});
      }
    mesh = scene.add(positions, triangles, {.place = false});
    for (std::uint32_t layer = 0; layer < layers; ++layer)
      for (std::uint32_t y = 0; y < across; ++y)
        for (std::uint32_t x = 0; x < across; ++x)
          scene.instance(mesh, translation(to(x, y, layer)), mask_of(x, y, layer));
    scene.commit();
  }

  [[nodiscard]] std::uint64_t triangles() const {
    return std::uint64_t{2} * kSide * kSide * across_ * across_ * layers_;
  }
  /// A ray down from above all layers, which meets no edge.
  [[nodiscard]] Ray ray(Random& random) const {
    const auto at = [&] { return static_cast<float>(random.below(4 * across_ * kApart)) / 4; };
    const Vec3 corner{at(), at(), static_cast<float>(2 * layers_)};
    return {corner + Vec3{0.125f, 0.0625f, 0}, 0, {0, 0, -1}, kInfinity};
  }
  /// Its hits with the instances that share a bit with `mask`, in order.
  [[nodiscard]] std::vector<Hit> hits(const Ray& ray, std::uint32_t mask = 0xffffffff) const {
    const auto column = static_cast<std::uint32_t>(ray.origin.x) / kApart,
               row = static_cast<std::uint32_t>(ray.origin.y) / kApart;
    const float x = ray.origin.x - static_cast<float>(column * kApart),
                y = ray.origin.y - static_cast<float>(row * kApart);
    const auto cell_x = static_cast<std::uint32_t>(x), cell_y = static_cast<std::uint32_t>(y);
    std::vector<Hit> all;
    if (cell_x >= kSide || cell_y >= kSide) return all;
    const float u = x - static_cast<float>(cell_x), v = y - static_cast<float>(cell_y);
    const bool upper = u + v > 1;
    const std::uint32_t prim = 2 * (cell_y * kSide + cell_x) + (upper ? 1 : 0);
    for (std::uint32_t layer = layers_; layer-- > 0;) {
      if ((mask_of(column, row, layer) & mask) == 0) continue;
      const float t = ray.origin.z - static_cast<float>(2 * layer);
      all.push_back({t, upper ? u + v - 1 : u, upper ? 1 - u : v, prim, mesh,
                     (layer * across_ + row) * across_ + column});
    }
    return all;
  }
  [[nodiscard]] static Vec3 to(std::uint32_t x, std::uint32_t y, std::uint32_t layer) {
    return {static_cast<float>(x * kApart), static_cast<float>(y * kApart),
            static_cast<float>(2 * layer)};
  }
  /// Bit 0, and for a few instances, bit 1.
  [[nodiscard]] static std::uint32_t mask_of(std::uint32_t x, std::uint32_t y,
                                             std::uint32_t layer) {
    return x == 3 && y < 3 && layer == 1 ? 3 : 1;
  }

  Scene scene;
  MeshId mesh = 0;

 private:
  std::uint32_t across_, layers_;
};

std::vector<Ray> rays_down(const Layers& layers, std::size_t count) {
  Random random(count);
  std::vector<Ray> rays;
  while (rays.size() < count) rays.push_back(layers.ray(random));
  // On a diagonal that two triangles share.
  rays.push_back({{1.5f, 2.5f, rays[0].origin.z}, 0, {0, 0, -1}, kInfinity});
  return rays;
}

TEST(ManyTriangles, HaveTheHitsOfAFormula) {
  const Layers layers(224, 4);
  ASSERT_GT(layers.triangles(), std::uint64_t{4'000'000'000});
  EXPECT_EQ(layers.scene.triangle_count(), layers.triangles());
  const std::vector<Ray> rays = rays_down(layers, 4000);
  QueryStatistics statistics;
  QueryOptions options;
  options.statistics = &statistics;
  const std::vector<Hit> hits = closest_hit(layers.scene, rays, options);
  EXPECT_EQ(statistics.triangles, layers.triangles());
  EXPECT_NE(statistics.plan[0].find("cannot be placed"), std::string::npos) << statistics.plan[0];
  const auto occluded = any_hit(layers.scene, rays);
  const auto counts = hit_counts(layers.scene, rays);
  const HitRows rows = all_hits(layers.scene, rays), two = first_hits(layers.scene, rays, 2);
  const std::vector<HitPoint> points = hit_points(layers.scene, rays, hits);
  for (std::size_t i = 0; i + 1 < rays.size(); ++i) {
    const std::vector<Hit> right = layers.hits(rays[i]);
    ASSERT_TRUE(same(hits[i], right.empty() ? Hit() : right[0])) << shown(hits[i]);
    ASSERT_EQ(occluded[i], right.empty() ? 0 : 1);
    ASSERT_EQ(counts[i], right.size());
    ASSERT_EQ(rows[i].size(), right.size());
    for (std::size_t k = 0; k < right.size(); ++k) {
      ASSERT_TRUE(same(rows[i][k], right[k])) << shown(rows[i][k]) << ", not " << shown(right[k]);
      if (k < 2) {
        ASSERT_TRUE(same(two[i][k], right[k]));
      }
    }
    ASSERT_EQ(two[i].size(), std::min<std::size_t>(2, right.size()));
    if (!right.empty()) {
      ASSERT_EQ(points[i].position.x, rays[i].origin.x);
      ASSERT_EQ(points[i].position.z, rays[i].origin.z - hits[i].t);
    }
  }
  EXPECT_EQ(counts.back(), 8u);  // both triangles of a cell, in each layer
  const Box box = layers.scene.bounds();
  EXPECT_EQ(box.min, Vec3());
  EXPECT_EQ(box.max, Layers::to(223, 223, 3) + (Vec3{Layers::kSide, Layers::kSide, 0}));
  // Some 900 bytes an instance, and the mesh.
  EXPECT_LT(layers.scene.memory_bytes(), std::size_t{1000} * 4 * 224 * 224);
}

/// 1 and more instances, chosen by a mask, and sides and triangles chosen besides; against brute
/// force, too.
TEST(ManyTriangles, AreChosen) {
  const Layers layers(170, 4);
  ASSERT_GT(layers.triangles(), std::uint64_t{0x7fffffff});
  std::vector<Ray> rays = rays_down(layers, 60);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    rays[i].origin.x = 3 * Layers::kApart + static_cast<float>(i) + 0.125f;
    rays[i].origin.y = static_cast<float>(i % 3 * Layers::kApart + i) + 0.0625f;
  }
  std::vector<TriangleId> skip(rays.size());
  for (std::size_t i = 0; i < rays.size(); i += 3) {
    const std::vector<Hit> right = layers.hits(rays[i], 2);
    if (!right.empty()) skip[i] = triangle_of(right[0]);
  }
  for (const Sides sides : {Sides::kBoth, Sides::kFront, Sides::kBack}) {
    QueryOptions options;
    options.mask = 2;
    options.sides = sides;
    options.skip = skip;
    const std::vector<Hit> hits = closest_hit(layers.scene, rays, options);
    const HitRows rows = all_hits(layers.scene, rays, options);
    QueryOptions brute = options;
    brute.method = QueryMethod::kBrute;
    const std::vector<Hit> expected = closest_hit(layers.scene, rays, brute);
    const HitRows all = all_hits(layers.scene, rays, brute);
    EXPECT_EQ(hit_counts(layers.scene, rays, options), hit_counts(layers.scene, rays, brute));
    EXPECT_EQ(any_hit(layers.scene, rays, options), any_hit(layers.scene, rays, brute));
    std::size_t met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::vector<Hit> right = layers.hits(rays[i], 2);
      const bool counts =
          !right.empty() && sides != Sides::kBack && skip[i].inst_id != right[0].inst_id;
      EXPECT_TRUE(same(hits[i], expected[i])) << shown(hits[i]) << ", not " << shown(expected[i]);
      if (i + 1 < rays.size()) {
        EXPECT_TRUE(same(hits[i], counts ? right[0] : Hit())) << shown(hits[i]);
      }
      ASSERT_EQ(rows[i].size(), all[i].size());
      for (std::size_t k = 0; k < rows[i].size(); ++k) EXPECT_TRUE(same(rows[i][k], all[i][k]));
      met += counts ? 1 : 0;
    }
    EXPECT_EQ(met > 10, sides != Sides::kBack);
  }
}

TEST(ManyTriangles, SayWhatCannotBeAnswered) {
  Layers layers(170, 4);
  Scene& scene = layers.scene;
  const std::vector<Ray> rays = rays_down(layers, 10);
  const InstanceId flat = scene.instance(layers.mesh, scaling({1, 0, 1}), 4);
  scene.commit();
  for (int again = 0; again < 2; ++again)
    expect_error(ErrorCode::kUnsupported, "instances[" + std::to_string(flat) + "].transform",
                 "no ray can enter it", [&] { static_cast<void>(closest_hit(scene, rays)); });
  const std::vector<Vec3> points{rays[0].origin, rays[1].origin};
  for (const ClosestPoint& found : closest_point(scene, points, {.mask = 4}))
    EXPECT_EQ(found.inst_id, flat);  // points enter it
  for (const ClosestPoint& found : closest_point(scene, points, {.mask = 4, .points_per_world = 1}))
    EXPECT_EQ(found.inst_id, flat);
  scene.set_transform(flat, Affine());
  scene.commit();
  EXPECT_FALSE(closest_hit(scene, rays).empty());
  scene.set_transform(flat, scaling({1, 0, 1}));
  scene.commit();
  expect_error(ErrorCode::kUnsupported, "instances[" + std::to_string(flat) + "].transform",
               "more than 2^31 - 1", [&] { static_cast<void>(all_hits(scene, rays)); });
  QueryOptions brute;
  brute.method = QueryMethod::kBrute;
  brute.mask = 6;  // brute force places what it meets
  EXPECT_EQ(closest_hit(scene, rays, brute).size(), rays.size());
  scene.remove_instance(flat);
  scene.commit();
  EXPECT_FALSE(closest_hit(scene, rays).empty());
}

TEST(ManyTriangles, OnDevicesAreForRays) {
  const Executor executor(2);
  GuardedMemory memory;
  const Layers layers(
      170, 4,
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory)));
  const std::vector<Ray> rays = rays_down(layers, 10);
  QueryOptions fronts, backs;
  fronts.sides = Sides::kFront;
  backs.sides = Sides::kBack;
  const std::vector<Hit> hits = closest_hit(layers.scene, rays),
                         of_fronts = closest_hit(layers.scene, rays, fronts);
  const HitRows rows = all_hits(layers.scene, rays);
  for (std::size_t i = 0; i + 1 < rays.size(); ++i) {  // the last is on a diagonal
    const std::vector<Hit> right = layers.hits(rays[i]);
    EXPECT_TRUE(same(hits[i], right.empty() ? Hit() : right[0])) << shown(hits[i]);
    EXPECT_TRUE(same(of_fronts[i], hits[i]));
    EXPECT_EQ(rows[i].size(), right.size());
  }
  EXPECT_EQ(any_hit(layers.scene, rays, backs), std::vector<std::uint8_t>(rays.size()));
  expect_error(ErrorCode::kUnsupported, "scene", "more than 2^31 - 1", [&] {
    static_cast<void>(closest_point(layers.scene, std::vector<Vec3>{{1, 2, 3}}));
  });
}

}  // namespace
}  // namespace raysheaf::test
