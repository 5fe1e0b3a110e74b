// The memory of scenes and queries per triangle and per ray: with a few hundred thousand triangles,
// or ten million with RAYSHEAF_LONG=1.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>
#include <optional>

#include "api/api_support.h"

namespace raysheaf::test {
namespace {

bool is_long() {
  return std::getenv("RAYSHEAF_LONG") != nullptr;
}

/// The largest memory use of the process so far.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// The current memory use of the process, without the allocator's free lists.
double resident_bytes() {
  malloc_trim(0);
  std::ifstream pages("/proc/self/statm");
  double all = 0, resident = 0;
  pages >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// A square with waves of `side` by `side` quads.
MeshId add_waves(std::uint32_t side, Scene* scene) {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t y = 0; y <= side; ++y) {
    for (std::uint32_t x = 0; x <= side; ++x) {
      const float u = static_cast<float>(x), v = static_cast<float>(y);
      positions.push_back({u, v, 3 * std::sin(0.05f * u) * std::cos(0.03f * v)});
    }
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = y * (side + 1) + x, b = a + side + 1;
      triangles.push_back({a, a + 1, b + 1});
      triangles.push_back({a, b + 1, b});
    }
  }
  return scene->add(positions, triangles);
}

/// Small triangles in random order.
MeshId add_soup(std::size_t count, float side, Random& random, Scene* scene) {
  std::vector<Vec3> corners;
  corners.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = random.in_box(side);
    for (int k = 0; k < 3; ++k) corners.push_back(at + random.in_box(1));
  }
  return scene->add_soup(corners);
}

std::vector<Ray> rays_from_above(std::size_t count, float side, Random& random) {
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = random.in_box(side);
    ray.direction = random.direction();
  }
  return rays;
}

void expect_small(const Scene& scene, const std::vector<Ray>& rays) {
  std::size_t hits = 0;
  for (const Hit& hit : closest_hit(scene, rays)) hits += hit.prim_id != kInvalidId ? 1 : 0;
  EXPECT_GT(hits, rays.size() / 100);
  EXPECT_EQ(any_hit(scene, rays).size(), rays.size());
  // docs/dual.md: a tree of 73 bytes per triangle, and 161 to build it; 36 per triangle for a soup
  // in the scene; 36 per ray; and streams, two of half a mebibyte per thread.
  const double limit = 290.0 * static_cast<double>(scene.triangle_count()) +
                       70.0 * static_cast<double>(rays.size()) + (8 << 20);
  EXPECT_LT(static_cast<double>(scene.memory_bytes()), limit);
  EXPECT_GT(static_cast<double>(scene.memory_bytes()),
            60.0 * static_cast<double>(scene.triangle_count()));
}

TEST(Memory, OfTrianglesAndRays) {
  const std::uint32_t side = is_long() ? 2236 : 316;
  const std::size_t ray_count = is_long() ? 1000000 : 20000;
  const auto size = static_cast<float>(side);
  Random random(1);
  for (const bool soup : {false, true}) {
    SCOPED_TRACE(soup ? "soup" : "waves");
    Scene scene;
    if (soup)
      add_soup(std::size_t{2} * side * side, 0.5f * size, random, &scene);
    else
      add_waves(side, &scene);
    scene.commit();
    expect_small(scene, rays_from_above(ray_count, 0.5f * size, random));
  }
  if (is_long()) {
    EXPECT_LT(peak_bytes(), 3.0 * (1 << 30));
  }
}

/// The old contents are found again, so the memory was reused: a fresh page would be zero.
TEST(Memory, OfDeletedRowsIsReused) {
  Scene scene;
  for (int layer = 0; layer < 8; ++layer) {
    const Square square(static_cast<float>(layer));
    scene.add(square.positions, square.triangles);
  }
  scene.commit();
  const std::vector<Ray> rays(20000, along_z());
  const std::uint64_t hits = all_hits(scene, rays).hits.size();
  ASSERT_EQ(hits, 8 * rays.size());
  const LargeVector<Hit> again(hits);
  for (std::size_t i = 0; i < hits; ++i) ASSERT_EQ(again[i].t, 10.0f + static_cast<float>(i % 8));
}

// Sizes are also refused while freed blocks are cached, whose reuse doubles the requested size.
TEST(Memory, ImpossibleSizesAreRefused) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "a sanitizer's allocator ends the program instead";
#endif
  constexpr std::size_t kHalf = std::numeric_limits<std::size_t>::max() / 2;
  for (const bool keeps : {false, true}) {
    std::optional<Scene> keeper;
    if (keeps) keeper.emplace(Context({.threads = 1}));
    for (const std::size_t bytes : {kHalf / 2, kHalf / 2 + 2, kHalf - 1, kHalf, kHalf + 1,
                                    kHalf + 2, 2 * kHalf - 4095, 2 * kHalf + 1})
      EXPECT_THROW(static_cast<void>(allocate_large(bytes)), std::bad_alloc) << bytes;
    LargeVector<Hit> hits;
    EXPECT_THROW(hits.resize(std::size_t{300'000'000'000'000'000}), std::bad_alloc);
  }
}

/// Deleted scenes leave no memory allocated, whatever number of threads answered their queries.
TEST(Memory, TenThousandScenesLeaveNothing) {
  std::vector<Ray> rays(4096);
  for (Ray& ray : rays)
    ray = {{0.3f, 0.2f, 5}, 0, {0, 0, -1}, std::numeric_limits<float>::infinity()};
  const auto make = [&](std::uint32_t threads) {
    Scene scene(Context({.threads = threads}));
    add_waves(4, &scene);
    scene.commit();
    EXPECT_EQ(any_hit(scene, rays)[7], 1);
  };
  for (int i = 0; i < 500; ++i) make(i % 2 == 0 ? 2 : 4);
  const double before = resident_bytes();
  for (int i = 0; i < 10'000; ++i) make(i % 2 == 0 ? 2 : 4);
  EXPECT_LT(resident_bytes() - before, 1e6);
}

}  // namespace
}  // namespace raysheaf::test
