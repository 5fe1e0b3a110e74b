// How many closed surfaces contain a point? A ray from the point leaves each of these surfaces once
// more often than it enters it.
#include <raysheaf/query.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

constexpr float kPi = 3.14159265f;

/// A sphere as a soup: three successive positions are a triangle, counter-clockwise from outside.
std::vector<raysheaf::Vec3> sphere(float radius) {
  constexpr int kRings = 24;
  const auto at = [radius](int ring, int step) {
    const float polar = kPi * static_cast<float>(ring) / kRings;
    const float azimuth = kPi * static_cast<float>(step % (2 * kRings)) / kRings;
    return raysheaf::Vec3{radius * std::sin(polar) * std::cos(azimuth),
                          radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar)};
  };
  std::vector<raysheaf::Vec3> soup;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int step = 0; step < 2 * kRings; ++step) {
      const raysheaf::Vec3 a = at(ring, step), b = at(ring + 1, step), c = at(ring + 1, step + 1),
                           d = at(ring, step + 1);
      for (const raysheaf::Vec3 p : {a, b, c, a, c, d}) soup.push_back(p);
    }
  }
  return soup;
}

}  // namespace

int main() {
  using namespace raysheaf;
  Scene scene;
  for (const float radius : {1.0f, 2.0f, 3.0f}) scene.add_soup(sphere(radius));
  scene.commit();

  // A direction that avoids edges, where a ray hits both triangles.
  const Vec3 anywhere{0.3f, 0.57f, 0.71f};
  const std::vector<Ray> rays{{{0.01f, 0.02f, 0.03f}, 0, anywhere},
                              {{1.5f, 0.02f, 0.03f}, 0, anywhere},
                              {{5, 0.02f, 0.03f}, 0, anywhere}};

  // Rows of different lengths: rows[i] has the hits of ray i, nearest first. If their numbers are
  // enough, use `hit_counts`.
  const HitRows rows = all_hits(scene, rays);
  const char* const names[] = {"the centre", "x = 1.5", "x = 5"};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    int crossings[3] = {};
    for (const Hit& hit : rows[i]) ++crossings[hit.geom_id];
    int inside = 0;
    for (const int count : crossings) inside += count % 2;
    std::printf("at %s: inside %d spheres\n", names[i], inside);
  }
}
