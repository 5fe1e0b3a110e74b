// A sphere above a floor and a lamp above the sphere: which points of the floor does the lamp
// reach?
#include <raysheaf/error.h>
#include <raysheaf/query.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr float kPi = 3.14159265f;

/// A sphere of radius 1 around (0, 0, 2), as rings of a soup.
std::vector<raysheaf::Vec3> ball() {
  constexpr int kRings = 32;
  const auto at = [](int ring, int step) {
    const float polar = kPi * static_cast<float>(ring) / kRings;
    const float azimuth = kPi * static_cast<float>(step % (2 * kRings)) / kRings;
    return raysheaf::Vec3{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                          2 + std::cos(polar)};
  };
  std::vector<raysheaf::Vec3> soup;
  for (int ring = 0; ring < kRings; ++ring)
    for (int step = 0; step < 2 * kRings; ++step)
      for (const auto& [r, s] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        soup.push_back(at(ring + r, step + s));
  return soup;
}

}  // namespace

int main() try {
  using namespace raysheaf;
  constexpr int kWidth = 64, kHeight = 36;
  Scene scene;
  scene.add_soup(ball());
  scene.commit();

  // From the lamp to each point of the floor, z = 0. Directions need not be unit vectors: with the
  // full vector as the direction, the floor is at t = 1, and the ray ends just before.
  const Vec3 lamp{-1, 0, 6};
  std::vector<Ray> rays;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 point{0.125f * static_cast<float>(x - kWidth / 2),
                       0.25f * static_cast<float>(y - kHeight / 2), 0};
      rays.push_back({lamp, 0, {point.x - lamp.x, point.y - lamp.y, point.z - lamp.z}, 0.9999f});
    }
  }

  QueryStatistics statistics;
  const std::vector<std::uint8_t> dark =
      any_hit(scene, rays, {.count_tests = true, .statistics = &statistics});

  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) std::putchar(dark[y * kWidth + x] != 0 ? '#' : '.');
    std::putchar('\n');
  }
  std::printf("%llu tests of %llu, %.2f ms\n", static_cast<unsigned long long>(statistics.tests()),
              static_cast<unsigned long long>(statistics.rays * statistics.triangles),
              statistics.total_ms);
  for (const std::string& sentence : statistics.plan) std::printf("  %s\n", sentence.c_str());

  // All methods give the same answers. This one tests every triangle.
  const bool same = dark == any_hit(scene, rays, {.method = QueryMethod::kBrute});
  std::printf("%td of %zu points in shadow, %s\n", std::count(dark.begin(), dark.end(), 1),
              dark.size(), same ? "as brute force says" : "but brute force differs");
} catch (const raysheaf::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
