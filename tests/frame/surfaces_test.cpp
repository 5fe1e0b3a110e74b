// Images of features in scene files: normals against the winding, second texture coordinates,
// vertex alpha, cameras with an aspect ratio.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/cameras.h"
#include "raysheaf/render.h"
#include "raysheaf/stream.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

/// The images of the scene in memory and of its blocks.
std::vector<RenderResult> pictures(const SceneDescription& scene, const RenderOptions& options) {
  BlockList blocks;
  const SceneDescription rest = cut_into_blocks(scene, &blocks, 16);
  std::vector<RenderResult> all;
  all.push_back(render(scene, options));
  all.push_back(render(BlocksInScene(blocks, rest), options));
  return all;
}

TEST(Surfaces, WithOpposedNormalsLookTheSame) {
  for (const float roughness : {0.0f, 0.6f}) {
    Material material;
    material.metallic = roughness == 0 ? 1.0f : 0.0f;
    material.roughness = roughness;
    const SceneDescription right = test::ball_on_floor(material);
    SceneDescription opposed = right;
    for (Mesh& mesh : opposed.meshes)
      for (Vec3& normal : mesh.normals) normal = {-normal.x, -normal.y, -normal.z};
    ASSERT_FALSE(opposed.meshes[0].normals.empty());
    const RenderOptions options = test::small_options(32);
    const RenderResult expected = render(right, options);
    for (const RenderResult& result : pictures(opposed, options))
      EXPECT_TRUE(test::same_bits(result.beauty, expected.beauty)) << roughness;
  }
}

/// A square that fills the image of an orthographic camera.
SceneDescription square() {
  SceneDescription scene;
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0};
  test::add_mesh(&scene, std::move(mesh));
  scene.materials.resize(1);
  scene.materials[0].unlit = true;
  Camera camera;
  camera.orthographic = true;
  camera.to_world = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  scene.cameras.push_back(camera);
  return scene;
}

TEST(Surfaces, ReadTexturesAtEitherSetOfCoordinates) {
  SceneDescription scene = square();
  scene.images.push_back({"halves", 2, 1, {255, 0, 0, 255, 0, 0, 255, 255}});
  scene.textures.push_back({0, Wrap::kRepeat, Wrap::kRepeat, Filter::kNearest});
  scene.materials[0].base_color_texture.texture = 0;
  scene.meshes[0].uvs.assign(4, {0.25f, 0.5f});
  scene.meshes[0].second_uvs.assign(4, {0.75f, 0.5f});
  for (const bool second : {false, true}) {
    scene.materials[0].base_color_texture.second_uvs = second;
    for (const RenderResult& result : pictures(scene, test::small_options(8)))
      for (const Vec3 c : result.beauty) EXPECT_EQ(c, second ? (Vec3{0, 0, 1}) : (Vec3{1, 0, 0}));
  }
  scene.meshes[0].second_uvs.clear();
  for (const Vec3 c : render(scene, test::small_options(8)).beauty)
    EXPECT_EQ(c, (Vec3{1, 0, 0})) << "the first set replaces it";
}

TEST(Surfaces, FadeByTheAlphaOfTheirVertices) {
  SceneDescription scene = square();
  scene.materials[0].alpha_blend = true;
  scene.meshes[0].alphas = {1, 0, 0, 1};
  for (const std::uint32_t samples : {1u, 16u}) {
    RenderOptions options = test::small_options(64);
    options.samples = samples;
    options.ambient = Vec3{0, 0, 0};
    const RenderResult result = render(scene, options);
    for (std::uint32_t part = 0; part < 4; ++part) {
      double sum = 0;
      for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 16 * part; x < 16 * part + 16; ++x)
          sum += double{result.beauty[64 * y + x].x};
      EXPECT_NEAR(sum / 1024, 0.875 - 0.25 * part, 0.05) << samples;
    }
  }
  scene.materials[0].alpha_blend = false;
  scene.materials[0].alpha_cutoff = 0.25f;
  RenderOptions options = test::small_options(64);
  options.ambient = Vec3{0, 0, 0};
  const RenderResult cut = render(scene, options);
  for (std::uint32_t x = 0; x < 64; ++x) EXPECT_EQ(cut.beauty[x].x, x < 48 ? 1 : 0) << x;
}

TEST(Surfaces, OfWideCamerasAreNeverCropped) {
  SceneDescription scene = square();
  scene.cameras[0].y_mag = 0.5f;
  scene.cameras[0].aspect_ratio = 2;
  RenderOptions options = test::small_options(16);
  options.ambient = Vec3{0, 0, 0};
  const auto covered = [&] {
    std::size_t count = 0;
    for (const PixelIds& ids : render(scene, options).ids)
      count += ids.geom_id == kInvalidId ? 0 : 1;
    return count;
  };
  EXPECT_EQ(covered(), 256u) << "all of the square's width is seen, and so its height";
  options.height = 32;
  EXPECT_EQ(covered(), 256u);
  options.width = 32;
  options.height = 8;  // an aspect ratio of 4 : 1 shows more of the width
  EXPECT_EQ(covered(), 128u);
  options.width = options.height = 0;
  const RenderResult result = render(scene, options);
  EXPECT_EQ(result.width, 512u);
  EXPECT_EQ(result.height, 256u);
  EXPECT_EQ(default_size(Camera{}).height, 512u);
}

}  // namespace
}  // namespace raysheaf
