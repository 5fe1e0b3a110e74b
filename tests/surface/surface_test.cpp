#include "render/surface/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "exec/executor.h"
#include "geom/surface_body.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::one_triangle;
using test::Random;

/// The surface at a point of one triangle in a scene.
Surface seen(const SceneDescription& scene, Vec3 direction, float u = 0.25f, float v = 0.25f,
             std::uint32_t triangle = 0) {
  const Executor executor(1);
  const FlatScene flat = flatten(executor, scene, mesh_bounds(executor, scene));
  return surface_at(flat, TextureSet(scene), triangle, u, v, direction);
}

void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-6f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

SceneDescription with_material(const Material& material) {
  SceneDescription scene = one_triangle();
  scene.materials = {material};
  scene.meshes[0].materials = {0};
  return scene;
}

TEST(Surface, PlacesAreOffByAtMostOneRounding) {
  Random random(1);
  for (int round = 0; round < 200000; ++round) {
    const float scale = std::pow(10.0f, test::uniform(random, -30, 15));
    const Vec3 shift = test::random_point(random, scale) * (round % 2 == 0 ? 1e4f : 0);
    const Vec3 a = test::random_point(random, scale) + shift;
    const Vec3 b = test::random_point(random, scale) + shift;
    const Vec3 c = test::random_point(random, scale * (round % 3 == 0 ? 1e-4f : 1)) + shift;
    float u = test::uniform(random, 0, 1), v = test::uniform(random, 0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const MixedPoint point = mixed_point(a, b, c, u, v);
    for (int axis = 0; axis < 3; ++axis) {
      const double w = 1 - static_cast<double>(u) - v;
      const double exact = w * component(a, axis) + static_cast<double>(u) * component(b, axis) +
                           static_cast<double>(v) * component(c, axis);
      ASSERT_LE(std::fabs(component(point.position, axis) - exact),
                1.0001 * kUnitRoundoff * std::fabs(exact) + 0x1p-149);
      for (const Vec3 corner : {a, b, c}) {
        const float reach = std::fabs(component(corner, axis) - component(point.position, axis));
        ASSERT_LE(reach, point.reach);
      }
    }
  }
}

TEST(Surface, CornersAndWeights) {
  const SceneDescription scene = one_triangle();
  expect_near(seen(scene, {0, 0, -1}, 0, 0).position, {0, 0, 0});
  expect_near(seen(scene, {0, 0, -1}, 1, 0).position, {1, 0, 0});
  expect_near(seen(scene, {0, 0, -1}, 0, 1).position, {0, 1, 0});
  expect_near(seen(scene, {0, 0, -1}, 0.25f, 0.5f).position, {0.25f, 0.5f, 0});
}

TEST(Surface, NormalsFaceTheViewer) {
  SceneDescription scene = one_triangle();
  for (const bool with_normals : {false, true}) {
    if (with_normals) scene.meshes[0].normals.assign(3, {0, 0, 1});
    const Surface front = seen(scene, {0.1f, 0.2f, -1}), back = seen(scene, {0.1f, 0.2f, 1});
    EXPECT_TRUE(front.front);
    EXPECT_FALSE(back.front);
    expect_near(front.geometric_normal, {0, 0, 1});
    expect_near(front.normal, {0, 0, 1});
    expect_near(back.geometric_normal, {0, 0, -1});
    expect_near(back.normal, {0, 0, -1});
  }
}

TEST(Surface, ShadingNormalsMayLeanAway) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].normals.assign(3, {0.8f, 0, 0.6f});
  const Surface s = seen(scene, {0.95f, 0, -0.1f});
  EXPECT_TRUE(s.front);
  expect_near(s.normal, {0.8f, 0, 0.6f});
}

TEST(Surface, NormalsThatOpposeTheWindingAreTurned) {
  Random random(7);
  for (int round = 0; round < 1000; ++round) {
    SceneDescription scene = one_triangle();
    for (Vec3& p : scene.meshes[0].positions) p = test::random_point(random, 1);
    for (int k = 0; k < 3; ++k)
      scene.meshes[0].normals.push_back(normalized(test::random_point(random, 1)));
    if (round % 2 == 0) scene.instances[0].to_world = scaling({-1, 1, 1});
    const Vec3 along = normalized(test::random_point(random, 1));
    const Surface s = seen(scene, along);
    EXPECT_LE(dot(s.geometric_normal, along), 0);
    EXPECT_GE(dot(s.geometric_normal, s.normal), -1e-6f);
    for (Vec3& n : scene.meshes[0].normals) n = -n;
    expect_near(seen(scene, along).normal, s.normal, 1e-5f);
  }
}

TEST(Surface, InstancesCarryNormalsAlong) {
  // Under any map, the normals of a sphere stay orthogonal to the tangents of its image and point
  // outwards.
  Random random(2);
  for (int round = 0; round < 2000; ++round) {
    Affine map = test::random_map(random);
    if (round % 4 == 0) {
      const float scale = round % 8 == 0 ? 1e-14f : 1e12f;
      for (auto& row : map.m) {
        for (float& x : row) x = test::uniform(random, -1, 1) * scale;
      }
    }
    const Vec3 normal = normalized(test::random_point(random, 1));
    const Vec3 tangent = normalized(cross(normal, normalized(test::random_point(random, 1))));
    const Vec3 image = unit_normal(normal_map(map), normal, {0, 0, 0});
    if (image == Vec3{0, 0, 0}) continue;  // the map flattens the sphere to a line
    EXPECT_NEAR(length(image), 1, 1e-5);
    const Vec3 along = transform_vector(map, tangent);
    double reach = 0;
    for (const auto& row : map.m)
      reach += std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]);
    EXPECT_LE(std::fabs(dot(image, along)), 1e-5 * reach);
    EXPECT_GE(dot(image, transform_vector(map, normal)), -1e-5 * reach);
  }
}

TEST(Surface, MirroringKeepsTheFrontInFront) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].normals.assign(3, {0, 0, 1});
  scene.instances[0].to_world = scaling({-1, 1, 1});
  const Surface s = seen(scene, {0, 0, -1});
  EXPECT_TRUE(s.front);
  expect_near(s.geometric_normal, {0, 0, 1});
  expect_near(s.normal, {0, 0, 1});
  scene.instances[0].to_world = scaling({1, 1, -1});
  EXPECT_FALSE(seen(scene, {0, 0, -1}).front);
  EXPECT_TRUE(seen(scene, {0, 0, 1}).front);
}

TEST(Surface, TinyTrianglesHaveNormals) {
  SceneDescription scene = one_triangle();
  for (const float scale : {1e-30f, 1e-12f, 1e12f, 1e17f}) {
    scene.instances[0].to_world = scaling({scale, scale, scale});
    expect_near(seen(scene, {0, 0, -1}).geometric_normal, {0, 0, 1});
  }
}

TEST(Surface, DielectricsFollowTheirIor) {
  Material glass;
  glass.base_color = {0.5f, 0.6f, 0.7f, 1};
  glass.transmission = 0.75f;
  glass.ior = 2;
  const Surface s = seen(with_material(glass), {0, 0, -1});
  expect_near(s.specular, Vec3{1, 1, 1} * (1.0f / 9));
  expect_near(s.diffuse, {0.125f, 0.15f, 0.175f});
  expect_near(s.transmission_color, {0.5f, 0.6f, 0.7f});
  EXPECT_FLOAT_EQ(s.transmission, 0.75f);
  EXPECT_EQ(s.ior, 2);
}

TEST(Surface, SpecularColorIsBoundedBeforeItIsWeighed) {
  Material material;
  material.specular = 0.5f;
  material.specular_color = {100, 1, 0};
  expect_near(seen(with_material(material), {0, 0, -1}).specular, {0.5f, 0.02f, 0});
  material.ior = 0;
  const Surface all = seen(with_material(material), {0, 0, -1});
  expect_near(all.specular, {0.5f, 0.5f, 0});
  EXPECT_EQ(all.ior, 1);
}

TEST(Surface, SpecularFactorIsTheReflectanceAtGrazingAngles) {
  Material material;
  material.specular = 0.3f;
  Surface s = seen(with_material(material), {0, 0, -1});
  EXPECT_EQ(s.specular_edge, 0.3f);
  EXPECT_EQ(s.coat_edge, 0.3f);
  material.metallic = 0.5f;
  s = seen(with_material(material), {0, 0, -1});
  EXPECT_NEAR(s.specular_edge, 0.65f, 1e-6f);
  EXPECT_EQ(s.coat_edge, 0.3f);
}

TEST(Surface, MetalsReflectTheirColor) {
  Material metal;
  metal.base_color = {0.9f, 0.6f, 0.3f, 1};
  metal.metallic = 1;
  metal.transmission = 1;
  const Surface s = seen(with_material(metal), {0, 0, -1});
  expect_near(s.specular, {0.9f, 0.6f, 0.3f});
  expect_near(s.diffuse, {0, 0, 0});
  EXPECT_EQ(s.transmission, 0);
}

TEST(Surface, ReflectsNoMoreThanArrives) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    Material m;
    m.base_color = {test::uniform(random, 0, 1), test::uniform(random, 0, 1),
                    test::uniform(random, 0, 1), 1};
    m.metallic = test::uniform(random, 0, 1);
    m.specular = test::uniform(random, 0, 1);
    m.transmission = test::uniform(random, 0, 1);
    m.ior = test::uniform(random, 1, 3);
    const Surface s = seen(with_material(m), {0, 0, -1});
    EXPECT_LE(max_component(s.specular), 1 + 1e-6f);
    EXPECT_LE(max_component(s.diffuse) + s.transmission * max_component(s.transmission_color),
              1 + 1e-6f);
  }
}

TEST(Surface, UnlitShinesWithItsBaseColor) {
  Material unlit;
  unlit.base_color = {0.2f, 0.4f, 0.6f, 1};
  unlit.emission = {9, 9, 9};
  unlit.unlit = true;
  const Surface s = seen(with_material(unlit), {0, 0, -1});
  EXPECT_TRUE(s.unlit);
  expect_near(s.emission, {0.2f, 0.4f, 0.6f});
  expect_near(s.diffuse, {0, 0, 0});
  expect_near(s.specular, {0, 0, 0});
}

/// A one-pixel image in every slot.
SceneDescription textured(std::vector<std::uint8_t> pixel) {
  Material material;
  material.base_color = {0.5f, 1, 1, 1};
  material.metallic = 1;
  material.emission = {2, 2, 2};
  material.base_color_texture.texture = 0;
  material.metallic_roughness_texture.texture = 0;
  material.emission_texture.texture = 0;
  SceneDescription scene = with_material(material);
  scene.images.push_back({"", 1, 1, std::move(pixel)});
  scene.textures.push_back({0});
  return scene;
}

TEST(Surface, TexturesMultiplyTheirFactors) {
  SceneDescription scene = textured({255, 51, 0, 255});
  scene.meshes[0].uvs.assign(3, {0.5f, 0.5f});
  const Surface s = seen(scene, {0, 0, -1});
  const float green = std::pow((0.2f + 0.055f) / 1.055f, 2.4f);
  expect_near(s.transmission_color, {0.5f, green, 0});
  EXPECT_FLOAT_EQ(s.roughness, 0.2f);              // green, linear
  expect_near(s.specular, {0.04f, 0.04f, 0.04f});  // blue is 0: not a metal
  expect_near(s.emission, {2, 2 * green, 0});
}

TEST(Surface, ColoursOfVerticesMultiplyTheBaseColour) {
  Material material;
  material.base_color = {0.5f, 1, 1, 1};
  SceneDescription scene = with_material(material);
  scene.meshes[0].colors = {{1, 0.5f, 0}, {0, 0.5f, 0}, {0, 0.5f, 1}};
  const auto at = [&](float u, float v) { return seen(scene, {0, 0, -1}, u, v).diffuse; };
  expect_near(at(0, 0), {0.5f, 0.5f, 0});
  expect_near(at(1, 0), {0, 0.5f, 0});
  expect_near(at(0.25f, 0.25f), {0.25f, 0.5f, 0.25f});
  SceneDescription both = textured({255, 51, 0, 255});
  both.meshes[0].uvs.assign(3, {0.5f, 0.5f});
  both.meshes[0].colors.assign(3, {0.5f, 0, 1});
  expect_near(seen(both, {0, 0, -1}).transmission_color, {0.25f, 0, 0});
}

/// A triangle in the plane z = 0, and a normal texture with a single colour, whose u runs along x
/// and whose v runs against y, as in images.
SceneDescription bumpy(std::vector<std::uint8_t> pixel) {
  Material material;
  material.normal_texture.texture = 0;
  material.double_sided = true;
  SceneDescription scene = with_material(material);
  scene.meshes[0].positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  scene.meshes[0].uvs = {{0, 1}, {1, 1}, {0, 0}};
  scene.images.push_back({"", 1, 1, std::move(pixel)});
  scene.textures.push_back({0});
  return scene;
}

TEST(Surface, NormalTexturesTurnTheShadingNormal) {
  constexpr float kHalf = 128.0f / 127.5f - 1;  // the byte closest to zero
  constexpr float kQuarterTurn = std::numbers::pi_v<float> / 2;
  const auto unit = [](Vec3 v) { return v / length(v); };
  expect_near(seen(bumpy({255, 128, 255, 255}), {0, 0, -1}).normal, unit({1, kHalf, 1}));
  expect_near(seen(bumpy({128, 255, 255, 255}), {0, 0, -1}).normal, unit({kHalf, 1, 1}));
  expect_near(seen(bumpy({128, 255, 255, 255}), {0, 0, 1}).normal, -unit({kHalf, 1, 1}));
  expect_near(seen(bumpy({128, 255, 255, 255}), {0, 0, -1}).geometric_normal, {0, 0, 1});
  SceneDescription scene = bumpy({255, 255, 255, 255});
  scene.materials[0].normal_scale = 0.5f;
  expect_near(seen(scene, {0, 0, -1}).normal, unit({0.5f, 0.5f, 1}));
  scene.materials[0].normal_texture.rotation = kQuarterTurn;  // u goes against y, v against x
  expect_near(seen(scene, {0, 0, -1}).normal, unit({0.5f, -0.5f, 1}));
  scene.materials[0].normal_texture.rotation = 0;
  for (Vec2& uv : scene.meshes[0].uvs) uv.x = -uv.x;  // mirrors the image
  expect_near(seen(scene, {0, 0, -1}).normal, unit({-0.5f, 0.5f, 1}));
  scene.instances[0].to_world = rotation({0, 0, 1}, kQuarterTurn);
  expect_near(seen(scene, {0, 0, -1}).normal, unit({-0.5f, -0.5f, 1}));
  scene.meshes[0].uvs.assign(3, {0.5f, 0.5f});  // no tangent frame
  expect_near(seen(scene, {0, 0, -1}).normal, {0, 0, 1});
  scene.meshes[0].uvs.clear();
  expect_near(seen(scene, {0, 0, -1}).normal, {0, 0, 1});
}

TEST(Surface, WithoutCoordinatesTexturesAreLeftOut) {
  const Surface s = seen(textured({0, 0, 0, 255}), {0, 0, -1});
  expect_near(s.emission, {2, 2, 2});
  EXPECT_EQ(s.roughness, 1);
}

TEST(Surface, TrianglesWithoutMaterialHaveTheDefault) {
  SceneDescription scene = with_material({});
  scene.materials[0].base_color = {0, 0, 0, 1};
  scene.meshes[0].materials = {kInvalidId};
  const Surface s = seen(scene, {0, 0, -1});
  EXPECT_EQ(s.material, kInvalidId);
  expect_near(s.diffuse, {1, 1, 1});
}

}  // namespace
}  // namespace raysheaf
