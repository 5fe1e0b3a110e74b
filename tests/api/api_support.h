// Helpers of the API tests.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <string>
#include <vector>

#include "base/vec.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/scene.h"
#include "support/random.h"

namespace raysheaf::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Compares bit for bit.
inline bool same(const Hit& a, const Hit& b) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) &&
         a.prim_id == b.prim_id && a.geom_id == b.geom_id && a.inst_id == b.inst_id;
}

inline std::string shown(const Hit& hit) {
  return "t " + std::to_string(hit.t) + ", prim " + std::to_string(hit.prim_id) + ", geom " +
         std::to_string(hit.geom_id) + ", inst " + std::to_string(hit.inst_id);
}

/// Expects that `body` throws an Error with this code, this place and these words in its sentence.
inline void expect_error(ErrorCode code, const std::string& place, const std::string& words,
                         const std::function<void()>& body) {
  try {
    body();
    ADD_FAILURE() << "nothing was thrown; expected " << place << ": " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_EQ(error.place(), place) << error.what();
    EXPECT_NE(error.sentence().find(words), std::string::npos) << error.what();
  }
}

/// A square of two triangles perpendicular to the z axis; `half` is half its side.
struct Square {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};

  explicit Square(float z = 0, float half = 1)
      : positions{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}} {}
};

/// The cube from -1 to 1, whose sides face outwards.
struct Cube {
  std::vector<Vec3> positions{{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                              {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
  std::vector<Triangle> triangles{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                  {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
};

/// Random triangles with edges up to `size` within 4 of the origin, and rays from within 5.
struct RandomSoup {
  std::vector<Vec3> positions;
  std::vector<Ray> rays;

  RandomSoup(std::size_t triangles, std::size_t ray_count, float size = 1) {
    Random random(7);
    for (std::size_t i = 0; i < triangles; ++i) {
      const Vec3 p = random.in_box(4);
      positions.insert(positions.end(), {p, p + random.in_box(size), p + random.in_box(size)});
    }
    for (std::size_t i = 0; i < ray_count; ++i)
      rays.push_back({random.in_box(5), 0, random.direction(), kInfinity});
  }
};

/// A ray along +z at (x, y) from z = -10.
inline Ray along_z(float x = 0.25f, float y = 0.5f) {
  return {{x, y, -10}, 0, {0, 0, 1}, kInfinity};
}

inline std::vector<InstanceId> instances_of(const Scene& scene) {
  std::vector<InstanceId> ids;
  for (const MeshId mesh : scene.meshes())
    for (const InstanceId id : scene.instances(mesh)) ids.push_back(id);
  return ids;
}

inline Hit first_hit(const Scene& scene, const Ray& ray, const QueryOptions& options = {}) {
  return closest_hit(scene, std::span(&ray, 1), options).front();
}

}  // namespace raysheaf::test
