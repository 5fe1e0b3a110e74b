// Pictures and their statistics: the same bits on every machine. Primary visibility is traced,
// because OpenGL's drivers differ.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/cameras.h"
#include "raysheaf/io.h"
#include "raysheaf/lab.h"
#include "raysheaf/render.h"
#include "support/pictures.h"
#include "tests/bits/checksums.h"

namespace raysheaf::test {
namespace {

Checksum layers_of(const RenderResult& result) {
  Checksum sum;
  sum.add_all(result.width, result.height, result.samples, result.beauty, result.position,
              result.normal, result.albedo, result.specular, result.shadow, result.tests,
              result.exposure, result.ambient);
  for (const PixelIds& ids : result.ids) sum.add_all(ids.inst_id, ids.geom_id, ids.prim_id);
  return sum;
}

/// The counts, without times and without the plan of `dual`.
void add_counts(Checksum* sum, const BatchStatistics& batch) {
  sum->add_all(batch.kind, batch.bounce, batch.rays, batch.triangles, batch.chunks,
               batch.mesh_sphere_tests, batch.final_tests, batch.hits);
  for (const LevelStatistics& level : batch.levels)
    sum->add_all(level.level, level.tests, level.hits);
}
Checksum counts_of(const FrameStatistics& statistics) {
  Checksum sum;
  for (const BatchStatistics& batch : statistics.batches) add_counts(&sum, batch);
  return sum;
}

void expect_picture(const std::string& name, const SceneDescription& scene,
                    const RenderOptions& options) {
  const RenderResult result = render(scene, options);
  expect_bits(name + ": layers", layers_of(result));
  const Image image = tone_mapped(result);
  expect_bits(name + ": image", checksum_of(image.width, image.height, image.rgba));
  if (options.method != Method::kDual)  // its counts depend on the SIMD width
    expect_bits(name + ": counts", counts_of(result.statistics));
  if (options.count_pixel_tests)
    expect_bits(name + ": heat map", checksum_of(heatmap(result).rgba));
}

class PicturesOfScenes : public testing::TestWithParam<const char*> {};

TEST_P(PicturesOfScenes, AreTheSameEverywhere) {
  const SceneDescription scene = builtin_scene(GetParam());
  Checksum geometry;
  for (const Mesh& mesh : scene.meshes)
    geometry.add_all(mesh.positions, mesh.normals, mesh.uvs, mesh.second_uvs, mesh.colors,
                     mesh.alphas, mesh.triangles, mesh.materials);
  for (const Instance& instance : scene.instances)
    geometry.add_all(instance.mesh, instance.to_world);
  expect_bits(std::string(GetParam()) + ": geometry", geometry);
  Checksum images;
  for (const Image& image : scene.images) images.add(image.rgba);
  expect_bits(std::string(GetParam()) + ": textures", images);
  for (const Method method : {Method::kDual, Method::kCrsh, Method::kRah, Method::kGl10}) {
    RenderOptions options = small_options(32);
    options.method = method;
    options.count_pixel_tests = method == Method::kCrsh;
    expect_picture(std::string(GetParam()) + " by " + to_string(method), scene, options);
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, PicturesOfScenes, testing::Values("office", "cornell", "atrium"),
                         [](const auto& test) { return std::string(test.param); });

TEST(PicturesOfSamples, AreTheSameEverywhere) {
  SceneDescription scene = ball_on_floor();
  add_curtain(&scene, -1.5f, 3);
  scene.lights[0].radius = 0.5f;
  Light panel;
  panel.type = Light::Type::kRectangle;
  panel.position = {-3, 4, 2};
  panel.direction = {0, -1, 0};
  panel.width = 2, panel.height = 1;
  scene.lights.push_back(panel);
  Light spot = point_light({0, 5, 0}, 40);
  spot.type = Light::Type::kSpot;
  spot.direction = {0, -1, 0};
  spot.inner_angle = 0.2f, spot.outer_angle = 0.6f;
  scene.lights.push_back(spot);
  RenderOptions options = small_options(24);
  options.samples = 4;
  expect_picture("soft lights", scene, options);
  options.aperture = 0.3f;
  expect_picture("lens", scene, options);

  Random random(11);
  scene.environment.width = 16, scene.environment.height = 8;
  for (int i = 0; i < 16 * 8; ++i)
    scene.environment.radiance.push_back({random.unit(), random.unit(), 4 * random.unit()});
  scene.environment.rotation = 0.7f;
  expect_picture("environment", scene, options);
  scene.lights.clear();
  scene.environment = {};
  scene.cameras.clear();
  add_missing_camera_and_light(scene);
  expect_picture("studio", scene, options);
}

TEST(BitsOfCameras, AreTheSameEverywhere) {
  const SceneDescription scene = ball_on_floor();
  Checksum sum;
  for (const ViewSide side : {ViewSide::kFront, ViewSide::kTop, ViewSide::kIso}) {
    Viewpoint viewpoint;
    viewpoint.view = side;
    viewpoint.zoom = 1.25f;
    sum.add(framing_camera(scene, viewpoint).to_world);
    sum.add(framing_camera(scene, viewpoint).y_fov);
  }
  for (int i = 0; i < 16; ++i)
    sum.add(turned_camera(scene.cameras[0], {0, 1, 0}, i / 16.0).to_world);
  expect_bits("cameras", sum);
}

TEST(CountsOfKeysAndBounds, AreTheSameEverywhere) {
  Laboratory laboratory(builtin_scene("cornell"), 40, 30, 1);
  for (const RayKeyEntry& entry : kRayKeys) {
    Checksum sum;
    for (const LabRays rays : {LabRays::kShadow, LabRays::kReflection1}) {
      MethodSettings settings = method_settings(Method::kCrsh);
      settings.key = entry.key;
      add_counts(&sum, laboratory.measure(rays, settings, false));
    }
    expect_bits(std::string("counts with key ") + entry.name, sum);
  }
  for (const BundleBound bound :
       {BundleBound::kSphereCone, BundleBound::kFiniteCone, BundleBound::kShaft,
        BundleBound::kFrustum, BundleBound::kShaftAndCone}) {
    MethodSettings settings = method_settings(Method::kCrsh);
    settings.bound = bound;
    Checksum sum;
    add_counts(&sum, laboratory.measure(LabRays::kAmbientOcclusion, settings, false));
    expect_bits(std::string("counts with bound ") + to_string(bound), sum);
  }
  Checksum published;
  for (const Method method : {Method::kRah, Method::kCrsh})
    add_counts(&published, laboratory.measure_as_published(LabRays::kShadow, method, Quirks{}));
  expect_bits("counts as published", published);
}

}  // namespace
}  // namespace raysheaf::test
