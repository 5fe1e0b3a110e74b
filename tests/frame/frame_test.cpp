// The complete renderer: a white furnace, methods, threads, primary visibility, bounces.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/render.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

const BatchStatistics* find_batch(const RenderResult& result, RayKind kind, std::uint32_t bounce) {
  for (const BatchStatistics& batch : result.statistics.batches)
    if (batch.kind == kind && batch.bounce == bounce) return &batch;
  return nullptr;
}

/// A surface with checks, lit by a lamp in front of it, and seen through a pane between the lamp
/// and the camera.
SceneDescription checks_behind(const Material& pane, bool is_there, bool turned) {
  SceneDescription scene;
  Material board;
  board.specular = 0;
  board.base_color_texture.texture = 0;
  scene.images.push_back({"checks", 2, 2, {}});
  for (const int shade : {250, 60, 60, 250})
    for (const int c : {shade, shade, shade, 255})
      scene.images[0].rgba.push_back(static_cast<std::uint8_t>(c));
  scene.textures.push_back({0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear});
  scene.materials = {board, pane};
  scene.materials[1].double_sided = true;
  const auto square = [](float half, float z, std::uint32_t material) {
    Mesh mesh;
    mesh.positions = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    mesh.uvs = {{0, 3}, {3, 3}, {3, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {material};
    return mesh;
  };
  test::add_mesh(&scene, square(6, -3, 0));
  if (is_there) test::add_mesh(&scene, square(4, 0, 1));
  if (is_there && turned)
    for (auto& t : scene.meshes[1].triangles) std::swap(t[1], t[2]);
  scene.lights.push_back(test::point_light({0.5f, 1, -0.5f}, 100));
  scene.cameras.push_back(test::camera_at({1, 1, 4}, {0, 0, 0}));
  return scene;
}

Material material(float metallic, float roughness, float transmission) {
  Material m;
  m.metallic = metallic;
  m.roughness = roughness;
  m.transmission = transmission;
  return m;
}

TEST(Frame, AWhiteFurnaceStaysWhite) {
  Material thin = material(0, 0, 1);
  thin.thin = true;
  for (const Material& m :
       {material(0, 1, 0), material(0, 0, 0), material(1, 0, 0), material(1, 0.5f, 0),
        material(0, 0, 1), material(0, 0.3f, 0.5f), material(0.5f, 0.4f, 0),
        material(0.5f, 0, 0.5f), material(0.9f, 0, 1), thin}) {
    for (const std::uint32_t bounces : {0u, 1u, 3u}) {
      SceneDescription scene = test::ball_on_floor(m);
      scene.lights[0].intensity = {0, 0, 0};
      RenderOptions options = test::small_options();
      options.ambient = Vec3{1, 1, 1};
      options.bounces = bounces;
      const RenderResult result = render(scene, options);
      for (const Vec3& pixel : result.beauty) {
        ASSERT_NEAR(pixel.x, 1, 2e-3f)
            << "metallic " << m.metallic << " roughness " << m.roughness << " transmission "
            << m.transmission << " bounces " << bounces;
      }
    }
  }
}

TEST(Frame, AThinPaneTintsAndBendsNothing) {
  Material pane = material(0, 0, 1);
  pane.base_color = {0.25f, 0.5f, 1, 1};
  RenderOptions options = test::small_options();
  options.ambient = Vec3{0, 0, 0};
  const RenderResult bare = render(checks_behind(pane, false, false), options);
  const auto least_and_most_through = [&](bool turned) {
    const RenderResult seen = render(checks_behind(pane, true, turned), options);
    float least = 2, most = 0;
    for (std::size_t i = 0; i < bare.beauty.size(); ++i) {
      const Vec3 through = seen.beauty[i], behind = bare.beauty[i];
      least = std::min(least, through.z / behind.z);
      most = std::max(most, through.z / behind.z);
      if (!pane.thin) continue;
      EXPECT_NEAR(through.x, 0.25f * through.z, 1e-4f * through.z);
      EXPECT_NEAR(through.y, 0.5f * through.z, 1e-4f * through.z);
    }
    return std::pair(least, most);
  };
  pane.thin = true;
  for (const bool turned : {false, true}) {
    const auto [least, most] = least_and_most_through(turned);
    EXPECT_GT(least, 0.93f) << turned << ": what is not reflected at this pane's angles";
    EXPECT_LT(most, 0.961f) << turned << ": at least 0.04 is reflected";
  }
  pane.thin = false;
  EXPECT_LT(least_and_most_through(false).first, 0.8f) << "solid glass shifts the checks";
}

class Methods : public testing::TestWithParam<std::string> {};

TEST_P(Methods, GiveTheSameBitsOnBuiltinScenes) {
  const SceneDescription scene = builtin_scene(GetParam());
  RenderOptions options = test::small_options(40);
  options.method = Method::kBrute;
  const RenderResult brute = render(scene, options);
  for (const Method method : {Method::kRah, Method::kCrsh, Method::kDual}) {
    options.method = method;
    const RenderResult result = render(scene, options);
    EXPECT_TRUE(test::same_bits(result.beauty, brute.beauty)) << to_string(method);
    EXPECT_EQ(result.exposure, brute.exposure);
    ASSERT_EQ(result.statistics.batches.size(), brute.statistics.batches.size());
    for (std::size_t i = 0; i < brute.statistics.batches.size(); ++i) {
      EXPECT_EQ(result.statistics.batches[i].rays, brute.statistics.batches[i].rays);
      EXPECT_EQ(result.statistics.batches[i].hits, brute.statistics.batches[i].hits);
      EXPECT_EQ(brute.statistics.batches[i].total_tests(),
                brute.statistics.batches[i].brute_force_tests());
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Builtin, Methods, testing::Values("office", "cornell", "atrium"));

TEST(Frame, MethodsGiveTheSameBitsOnSoups) {
  for (const test::SoupKind kind : test::soup_kinds()) {
    const SceneDescription scene = test::soup(kind, 400, 17);
    RenderOptions options = test::small_options(32);
    options.method = Method::kBrute;
    const RenderResult brute = render(scene, options);
    for (const Method method : {Method::kRah, Method::kCrsh, Method::kDual}) {
      options.method = method;
      EXPECT_TRUE(test::same_bits(render(scene, options).beauty, brute.beauty))
          << to_string(method) << " kind " << static_cast<int>(kind);
    }
  }
}

TEST(Frame, DoesNotDependOnTheNumberOfThreadsNorOnLevelsAndBranching) {
  const SceneDescription scene = builtin_scene("office");
  RenderOptions options = test::small_options(64);
  options.method = Method::kCrsh;
  options.threads = 1;
  const RenderResult one = render(scene, options);
  options.threads = 3;
  const RenderResult three = render(scene, options);
  EXPECT_TRUE(test::same_bits(one.beauty, three.beauty));
  for (std::size_t i = 0; i < one.statistics.batches.size(); ++i)
    EXPECT_EQ(one.statistics.batches[i].total_tests(), three.statistics.batches[i].total_tests());
  options.levels = 4;
  options.branching = 4;
  EXPECT_TRUE(test::same_bits(one.beauty, render(scene, options).beauty));
  options.early_out = true;
  EXPECT_TRUE(test::same_bits(one.beauty, render(scene, options).beauty));
}

TEST(Frame, ManyLightsGoInGroupsAndGiveTheSamePicture) {
  SceneDescription scene = test::ball_on_floor();
  for (int i = 0; i < 9; ++i) {
    Light light = scene.lights[0];
    light.position = light.position + Vec3{static_cast<float>(i) * 0.3f, 0, 0};
    scene.lights.push_back(light);
  }
  RenderOptions options = test::small_options();
  options.method = Method::kBrute;
  const RenderResult brute = render(scene, options);
  options.method = Method::kCrsh;
  EXPECT_TRUE(test::same_bits(brute.beauty, render(scene, options).beauty));
}

/// Panes of glass in front of a wall: paths split at each pane and merge in the same pixels.
SceneDescription stacked_glass(int panes) {
  SceneDescription scene;
  scene.materials = {material(0, 0, 1), material(0, 1, 0)};
  scene.materials[0].double_sided = true;
  for (int i = 0; i <= panes; ++i) {
    const float z = -static_cast<float>(i);
    Mesh pane;
    pane.positions = {{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
    pane.triangles = {{0, 1, 2}, {0, 2, 3}};
    pane.materials = {i < panes ? 0u : 1u};
    test::add_mesh(&scene, std::move(pane));
  }
  scene.lights.push_back(test::point_light({1, 2, 4}, 100));
  scene.cameras.push_back(test::camera_at({0, 0, 5}, {0.3f, 0.2f, 0}));
  return scene;
}

TEST(Frame, SplittingPathsAddUpTheSameOnEveryNumberOfThreads) {
  const SceneDescription scene = stacked_glass(4);
  RenderOptions options = test::small_options(96);
  options.bounces = 5;
  options.threads = 1;
  const RenderResult one = render(scene, options);
  EXPECT_GT(find_batch(one, RayKind::kRefraction, 3)->rays, 96u * 96);  // more than one per pixel
  for (const std::uint32_t threads : {2u, 4u, 7u}) {
    options.threads = threads;
    EXPECT_TRUE(test::same_bits(one.beauty, render(scene, options).beauty)) << threads;
  }
}

TEST(Frame, BouncesCountFromOne) {
  RenderOptions options = test::small_options();
  options.bounces = 2;
  const RenderResult result = render(builtin_scene("cornell"), options);
  for (const std::uint32_t bounce : {1u, 2u, 3u})
    EXPECT_NE(find_batch(result, RayKind::kShadow, bounce), nullptr) << bounce;
  EXPECT_NE(find_batch(result, RayKind::kReflection, 1), nullptr);
  EXPECT_NE(find_batch(result, RayKind::kReflection, 2), nullptr);
  EXPECT_EQ(find_batch(result, RayKind::kReflection, 3), nullptr);
  options.bounces = 0;
  EXPECT_EQ(render(builtin_scene("cornell"), options).statistics.batches.size(),
            2u);  // primary, shadow
}

TEST(Frame, SwitchesLeaveKindsOfRaysOut) {
  const SceneDescription scene = builtin_scene("office");
  RenderOptions options = test::small_options();
  options.shadows = options.reflections = options.refractions = false;
  const RenderResult result = render(scene, options);
  ASSERT_EQ(result.statistics.batches.size(), 1u);
  EXPECT_EQ(result.statistics.batches[0].kind, RayKind::kPrimary);
}

TEST(Frame, PixelTestsAddUpToTheTotal) {
  RenderOptions options = test::small_options(64);
  options.count_pixel_tests = true;
  for (const Method method : {Method::kBrute, Method::kDual}) {
    options.method = method;
    const RenderResult result = render(builtin_scene("cornell"), options);
    double sum = 0, expected = 0;
    for (const float tests : result.tests) sum += double{tests};
    for (const BatchStatistics& batch : result.statistics.batches)
      expected += static_cast<double>(batch.total_tests());
    EXPECT_NEAR(sum, expected, 1e-5 * expected) << to_string(method);
  }
}

TEST(Frame, RasterAndTraceSeeTheSame) {
  for (const std::string name : {"office", "cornell", "atrium"}) {
    const SceneDescription scene = builtin_scene(name);
    RenderOptions options = test::small_options(128);
    options.bounces = 0;
    options.shadows = false;
    const RenderResult traced = render(scene, options);
    options.primary = Primary::kRaster;
    RenderResult raster;
    try {
      raster = render(scene, options);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::kNoGraphics) GTEST_SKIP() << error.what();
      throw;
    }
    int different = 0;
    for (std::size_t i = 0; i < traced.ids.size(); ++i) {
      if (traced.ids[i].prim_id != raster.ids[i].prim_id ||
          traced.ids[i].inst_id != raster.ids[i].inst_id)
        ++different;
    }
    EXPECT_LE(different, 128 * 128 / 1000) << name;  // a tenth of a percent, at silhouettes
  }
}

TEST(Frame, CancelsWhereAsked) {
  RenderOptions options = test::small_options(64);
  int calls = 0;
  options.progress = [&](const Progress&) { return ++calls < 5; };
  try {
    (void)render(builtin_scene("office"), options);
    FAIL() << "was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
}

TEST(Frame, RefusesWhatCannotBeRendered) {
  const SceneDescription scene = test::ball_on_floor();
  const auto code_of = [&](const SceneDescription& s, const RenderOptions& o) {
    try {
      (void)render(s, o);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  RenderOptions options = test::small_options();
  options.width = 0;
  EXPECT_EQ(code_of(scene, options), ErrorCode::kInvalidArgument);
  options = test::small_options();
  options.branching = 1;
  EXPECT_EQ(code_of(scene, options), ErrorCode::kInvalidArgument);
  options = test::small_options();
  options.camera = "nobody";
  EXPECT_EQ(code_of(scene, options), ErrorCode::kNotFound);
  EXPECT_EQ(code_of({}, test::small_options()), ErrorCode::kInvalidData);
}

TEST(Frame, AScaledSceneGivesTheSamePicture) {
  const auto picture = [](float scale) {
    Material mirror = material(1, 0, 0);
    SceneDescription scene = test::ball_on_floor(mirror);
    for (Mesh& mesh : scene.meshes)
      for (Vec3& p : mesh.positions) p *= scale;
    scene.lights[0].position *= scale;
    scene.lights[0].intensity *= scale * scale;
    for (auto& row : scene.cameras[0].to_world.m) row[3] *= scale;
    scene.cameras[0].z_near *= scale;
    RenderOptions options = test::small_options();
    options.exposure = 1.0f;
    return tone_mapped(render(scene, options)).rgba;
  };
  const auto plain = picture(1);
  for (const float scale : {1e-3f, 1e3f}) {
    const auto other = picture(scale);
    int different = 0;
    for (std::size_t i = 0; i < plain.size(); ++i)
      different += std::abs(plain[i] - other[i]) > 2 ? 1 : 0;
    EXPECT_LE(different, 12) << scale;  // at most three pixels, at edges
  }
}

struct PaperScene {
  const char* file;
  std::uint64_t shadow_rays, tolerance, triangles;
  double relative;
};

class Paper : public testing::TestWithParam<PaperScene> {};

TEST_P(Paper, CountsAreThePapers) {
  const PaperScene expected = GetParam();
  RAYSHEAF_SCENE_OR_SKIP(path, std::string("paper/") + expected.file);
  const SceneDescription scene = load_scene(path);
  RenderOptions options;
  options.bounces = 2;
  options.method = Method::kCrsh;
  const RenderResult crsh = render(scene, options);
  options.method = Method::kRah;
  const RenderResult rah = render(scene, options);
  EXPECT_TRUE(test::same_bits(crsh.beauty, rah.beauty));
  const BatchStatistics& shadow = *find_batch(crsh, RayKind::kShadow, 1);
  EXPECT_NEAR(static_cast<double>(shadow.rays), static_cast<double>(expected.shadow_rays),
              static_cast<double>(expected.tolerance));
  for (const BatchStatistics& batch : crsh.statistics.batches)
    EXPECT_LE(batch.relative(), expected.relative);
  for (const BatchStatistics& batch : rah.statistics.batches) {
    const std::uint64_t leaves = (batch.rays + 7) / 8;
    EXPECT_EQ(batch.levels[0].tests, (leaves + 7) / 8 * expected.triangles);
  }
  if (std::string(expected.file) == "cornell.glb") {
    EXPECT_EQ(find_batch(crsh, RayKind::kReflection, 1)->rays, 262144u);
    EXPECT_EQ(find_batch(crsh, RayKind::kReflection, 2)->rays, 262144u);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Scenes, Paper,
    testing::Values(PaperScene{"office.glb", 251548, 20, 36308, 0.0186},
                    PaperScene{"cornell.glb", 242015, 20, 792, 0.0883},
                    PaperScene{"sponza.glb", 255788, 60, 66450, 0.0238}),
    [](const auto& test) {
      return std::string(test.param.file).substr(0, std::string(test.param.file).find('.'));
    });

}  // namespace
}  // namespace raysheaf
