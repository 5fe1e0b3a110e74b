// Fetching sixteen surfaces at a time gives the results of `SurfaceReader` bit for bit, for all
// kinds of triangles, attributes, materials and textures, on every SIMD target.
#include "render/frame/surface_fetcher.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "exec/executor.h"
#include "intersect/triangle_body.h"
#include "support/random.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

using test::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Image noise(Random& random, std::uint32_t width, std::uint32_t height) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.resize(std::size_t{4} * width * height);
  for (std::uint8_t& byte : image.rgba) byte = static_cast<std::uint8_t>(random.below(256));
  return image;
}

TextureSlot any_slot(Random& random, std::uint32_t textures) {
  TextureSlot slot;
  if (random.below(3) == 0) return slot;
  slot.texture = random.below(textures);
  if (random.below(2) == 0) return slot;
  slot.offset = {random.between(-2, 2), random.between(-2, 2)};
  slot.scale = {random.between(-3, 3), random.between(-3, 3)};
  slot.rotation = random.below(2) == 0 ? 0 : random.between(-3, 3);
  return slot;
}

Material any_material(Random& random, std::uint32_t textures) {
  Material m;
  m.base_color = {random.unit(), random.unit(), random.unit(), random.unit()};
  m.emission = {random.unit(), 0, random.unit()};
  m.metallic = random.unit();
  m.roughness = random.unit();
  m.transmission = random.below(3) == 0 ? random.unit() : 0;
  m.thin = random.below(2) == 0;
  m.unlit = random.below(6) == 0;
  m.base_color_texture = any_slot(random, textures);
  m.metallic_roughness_texture = any_slot(random, textures);
  m.emission_texture = any_slot(random, textures);
  if (random.below(6) == 0) m.normal_texture = any_slot(random, textures);
  return m;
}

float any_coordinate(Random& random) {
  switch (random.below(12)) {
    case 0:
      return 1e30f;
    case 1:
      return static_cast<float>(random.below(3));
    default:
      return random.between(-3, 3);
  }
}

/// `scale` is that of all lengths. Some triangles are degenerate, some smaller than binary32
/// resolves.
Mesh any_mesh(Random& random, std::size_t triangles, std::uint32_t materials, float scale) {
  Mesh mesh;
  const bool normals = random.below(3) != 0, uvs = random.below(4) != 0;
  const bool colors = random.below(4) == 0;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    mesh.materials.push_back(random.below(materials));
    const Vec3 corner = random.in_box(scale);
    const float size = random.below(5) == 0 ? 0 : scale * (random.below(4) == 0 ? 1e-5f : 1);
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(corner + random.in_box(size));
      if (normals)
        mesh.normals.push_back(random.below(20) == 0 ? Vec3{0, 0, 0} : random.direction());
      if (uvs) mesh.uvs.push_back({any_coordinate(random), any_coordinate(random)});
      if (colors) mesh.colors.push_back({random.unit(), random.unit(), random.unit()});
    }
  }
  return mesh;
}

SceneDescription any_scene(Random& random, float scale) {
  SceneDescription scene;
  constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kClampToEdge, Wrap::kMirroredRepeat};
  for (std::uint32_t i = 0; i < 6; ++i) {
    scene.images.push_back(noise(random, 1 + random.below(9), 1 + random.below(9)));
    Texture texture;
    texture.image = i;
    texture.wrap_u = kWraps[random.below(3)];
    texture.wrap_v = kWraps[random.below(3)];
    texture.filter = random.below(2) == 0 ? Filter::kNearest : Filter::kLinear;
    scene.textures.push_back(texture);
  }
  for (int i = 0; i < 5; ++i) scene.materials.push_back(any_material(random, 6));
  for (std::uint32_t i = 0; i < 5; ++i) {
    scene.meshes.push_back(any_mesh(random, 1 + random.below(30), 5, scale));
    for (std::uint32_t n = random.below(3) + 1; n > 0; --n) {
      Instance instance;
      instance.mesh = i;
      for (auto& row : instance.to_world.m)
        for (int c = 0; c < 3; ++c) row[c] = random.between(-2, 2);
      for (auto& row : instance.to_world.m) row[3] = scale * random.between(-1, 1);
      scene.instances.push_back(instance);
    }
  }
  return scene;
}

/// A ray that is mostly aimed at a point on the triangle.
Ray any_ray(Random& random, const FlatScene& flat, std::uint32_t triangle, float scale) {
  const auto [a, b, c] = flat.corners(triangle);
  const float u = random.unit(), v = random.unit() * (1 - u);
  const Vec3 origin = random.in_box(4 * scale);
  Vec3 direction = a + (b - a) * u + (c - a) * v - origin;
  switch (random.below(10)) {
    case 0:
      direction = random.direction();
      break;
    case 1:
      direction = b - origin;  // through a corner
      break;
    case 2:
      direction = direction * 1e-25f;
      break;
    default:
      break;
  }
  if (direction == Vec3{0, 0, 0}) direction = {0, 0, 1};
  return {origin, 0, direction, random.below(10) == 0 ? 0.5f : kInfinity};
}

Fragment expected(const SceneDescription& scene, const FlatScene& flat, const TextureSet& textures,
                  const Ray& ray, Arrival arrival, Fragment f) {
  if (arrival == Arrival::kSeen) f.incoming = normalized(ray.direction);
  if (f.triangle == kInvalidId) return f;
  SurfaceReader reader(scene, textures);
  reader.hold(flat, flat.at(f.triangle));
  const Vec3(&corner)[3] = reader.held().corner;
  TriangleHit where{};
  intersect_triangle(make_ray_setup(ray), corner[0], corner[1], corner[2], &where);
  const Vec2 uv = arrival == Arrival::kSeen
                      ? clamped_barycentrics(ray, corner[0], corner[1], corner[2])
                      : Vec2{where.u, where.v};
  f.surface = reader.at(uv.x, uv.y, f.incoming);
  return f;
}

bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}
bool same(Vec3 a, Vec3 b) {
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

void expect_same(const Fragment& a, const Fragment& b) {
  EXPECT_TRUE(same(a.incoming, b.incoming));
  const Surface &s = a.surface, &t = b.surface;
  EXPECT_TRUE(same(s.position, t.position));
  EXPECT_TRUE(same(s.geometric_normal, t.geometric_normal));
  EXPECT_TRUE(same(s.normal, t.normal));
  EXPECT_TRUE(same(s.diffuse, t.diffuse));
  EXPECT_TRUE(same(s.specular, t.specular));
  EXPECT_TRUE(same(s.coat, t.coat));
  EXPECT_TRUE(same(s.specular_edge, t.specular_edge));
  EXPECT_TRUE(same(s.coat_edge, t.coat_edge));
  EXPECT_TRUE(same(s.transmission_color, t.transmission_color));
  EXPECT_TRUE(same(s.emission, t.emission));
  EXPECT_TRUE(same(s.roughness, t.roughness));
  EXPECT_TRUE(same(s.transmission, t.transmission));
  EXPECT_TRUE(same(s.ior, t.ior));
  EXPECT_TRUE(same(s.clearance, t.clearance));
  EXPECT_EQ(s.unlit, t.unlit);
  EXPECT_EQ(s.thin, t.thin);
  EXPECT_EQ(s.front, t.front);
  EXPECT_EQ(s.material, t.material);
}

void expect_as_one_by_one(std::uint64_t seed, Arrival arrival) {
  Random random(seed);
  const Executor executor(1);
  for (int round = 0; round < 60 && !testing::Test::HasFailure(); ++round) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(40)) - 20);
    const SceneDescription scene = any_scene(random, scale);
    const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
    const TextureSet textures(scene);
    const std::vector<MaterialLook> looks = material_looks(scene);
    SurfaceFetcher fetcher({flat, textures, looks});
    for (int call = 0; call < 40; ++call) {
      const std::size_t count = 1 + random.below(kFetchedTogether);
      std::vector<Ray> rays;
      Fragments fragments(count), wanted(count);
      std::uint32_t triangle = 0;
      for (std::size_t i = 0; i < count; ++i) {
        Fragment& f = fragments[i] = {};
        if (random.below(2) == 0) triangle = random.below(flat.triangle_count);
        f.triangle = random.below(9) == 0 ? kInvalidId : triangle;
        rays.push_back(any_ray(random, flat, triangle, scale));
        f.incoming = normalized(rays[i].direction);
        wanted[i] = expected(scene, flat, textures, rays[i], arrival, f);
      }
      fetcher.fetch(rays, arrival, fragments);
      for (std::size_t i = 0; i < count; ++i) {
        SCOPED_TRACE(testing::Message() << "round " << round << ", lane " << i);
        expect_same(fragments[i], wanted[i]);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(SurfaceFetcher, SeesWhatTheReaderSees) {
  test::for_each_simd_target(
      [](const char* /*target*/) { expect_as_one_by_one(1, Arrival::kSeen); });
}

TEST(SurfaceFetcher, FollowsRaysAsTheReaderDoes) {
  test::for_each_simd_target(
      [](const char* /*target*/) { expect_as_one_by_one(2, Arrival::kTraced); });
}

}  // namespace
}  // namespace raysheaf
