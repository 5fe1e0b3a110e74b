// One renderer for many images: each image equals that of a new renderer, and the statistics say
// what was rebuilt.
#include "raysheaf/renderer.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "raysheaf/error.h"
#include "raysheaf/paper.h"
#include "render/frame/batch_tracer.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

SceneDescription mirrors() {
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  SceneDescription scene = test::ball_on_floor(mirror);
  test::add_mesh(&scene, test::ball(8, 0.4f, {1.6f, 0.6f, 0.5f}));
  return scene;
}

/// The next frame: the small sphere rolls, and the large one changes its size.
SceneChanges advance(SceneDescription& scene, int frame) {
  SceneChanges changes;
  scene.instances[2].to_world =
      compose(rotation({0, 1, 0}, 0.4f * static_cast<float>(frame)), Affine{});
  changes.moved = {2};
  if (frame % 2 == 1) {
    for (Vec3& p : scene.meshes[0].positions) p = p * 1.02f;
    changes.deformed = {0};
  }
  if (frame == 4) {
    scene.meshes.resize(2);
    scene.instances.resize(2);
    test::add_mesh(&scene, test::ball(11, 0.5f, {-1.5f, 0.5f, 0.5f}));
    changes = {};
    changes.other_meshes_from = changes.other_instances_from = 2;
  }
  return changes;
}

/// The scene as a new renderer sees it that knows which meshes have changed their shape: their
/// spheres differ from those of meshes that have always had it.
RenderResult rendered_anew(const SceneDescription& scene, std::vector<std::uint32_t> deformed,
                           const RenderOptions& options) {
  Renderer renderer;
  renderer.show(scene);
  SceneChanges changes;
  changes.deformed = std::move(deformed);
  renderer.show(scene, changes);
  return renderer.render(options);
}

class RendererMethods : public testing::TestWithParam<Method> {};

TEST_P(RendererMethods, EveryPictureIsThatOfAFreshOne) {
  SceneDescription scene = mirrors();
  RenderOptions options = test::small_options(32);
  options.method = GetParam();
  Renderer renderer;
  renderer.show(scene);
  for (int frame = 0; frame < 8; ++frame) {
    if (frame > 0) renderer.show(scene, advance(scene, frame));
    scene.cameras[0] = test::camera_at({0.1f * static_cast<float>(frame), 2.5f, 6}, {0, 0.8f, 0});
    options.threads = frame == 5 ? 1 : 0;
    const RenderResult kept = renderer.render(options);
    const RenderResult fresh = render(scene, options);
    EXPECT_TRUE(test::same_bits(kept.beauty, fresh.beauty)) << "frame " << frame;
    EXPECT_EQ(kept.shadow, fresh.shadow) << "frame " << frame;
    if (GetParam() == Method::kRah || GetParam() == Method::kCrsh) {
      const std::vector<BatchStatistics> anew =
          rendered_anew(scene, frame > 0 ? std::vector{0u} : std::vector<std::uint32_t>{}, options)
              .statistics.batches;
      ASSERT_EQ(kept.statistics.batches.size(), anew.size());
      for (std::size_t b = 0; b < anew.size(); ++b)
        EXPECT_EQ(kept.statistics.batches[b].total_tests(), anew[b].total_tests());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, RendererMethods,
                         testing::Values(Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10,
                                         Method::kDual),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(Renderer, StatisticsSayWhatWasRebuilt) {
  SceneDescription scene = mirrors();
  const std::uint64_t all = scene.triangle_count();
  RenderOptions options = test::small_options(32);
  Renderer renderer;
  renderer.show(scene);
  static_cast<void>(renderer.render(options));
  UpdateStatistics update = renderer.last_update();
  EXPECT_EQ(update.replaced_meshes, 3u);
  EXPECT_EQ(update.rebound_meshes, 3u);
  EXPECT_EQ(update.placed_triangles, all);
  EXPECT_EQ(update.tree, "rebuild");

  static_cast<void>(renderer.render(options));
  update = renderer.last_update();
  EXPECT_EQ(update.placed_triangles + update.rebound_meshes, 0u);
  EXPECT_EQ(update.tree, "kept");

  renderer.show(scene, advance(scene, 2));
  static_cast<void>(renderer.render(options));
  update = renderer.last_update();
  EXPECT_EQ(update.moved_instances, 1u);
  EXPECT_EQ(update.rebound_meshes, 0u);
  EXPECT_EQ(update.placed_triangles, scene.meshes[2].triangles.size());
  EXPECT_EQ(update.tree, "refit");

  renderer.show(scene, advance(scene, 3));
  static_cast<void>(renderer.render(options));
  update = renderer.last_update();
  EXPECT_EQ(update.deformed_meshes, 1u);
  EXPECT_EQ(update.rebound_meshes, 1u);

  renderer.show(scene, advance(scene, 4));
  static_cast<void>(renderer.render(options));
  update = renderer.last_update();
  EXPECT_EQ(update.replaced_meshes, 1u);
  EXPECT_EQ(update.rebound_meshes, 1u);
  EXPECT_EQ(update.tree, "rebuild");
}

TEST(Renderer, GoesOnAfterAnError) {
  SceneDescription scene = mirrors();
  const RenderOptions options = test::small_options(24);
  Renderer renderer;
  EXPECT_THROW(static_cast<void>(renderer.render(options)), Error);
  renderer.show(scene);
  const RenderResult before = renderer.render(options);
  scene.instances[2].to_world.m[0][3] = 1e30f;
  SceneChanges changes;
  changes.moved = {2};
  renderer.show(scene, changes);
  EXPECT_THROW(static_cast<void>(renderer.render(options)), Error);
  scene.instances[2].to_world = {};
  renderer.show(scene, changes);
  EXPECT_TRUE(test::same_bits(renderer.render(options).beauty, before.beauty));

  RenderOptions stopped = options;
  stopped.progress = [](const Progress&) { return false; };
  EXPECT_THROW(static_cast<void>(renderer.render(stopped)), Error);
  EXPECT_TRUE(test::same_bits(renderer.render(options).beauty, before.beauty));
}

TEST(Renderer, RefusesMethodsOfALibraryThatIsNotUsed) {
  const SceneDescription scene = mirrors();
  RenderOptions options = test::small_options(8);
  options.primary = Primary::kTrace;
  set_batch_tracers(nullptr);
  for (const Method method : {Method::kRah, Method::kCrsh, Method::kGl10}) {
    options.method = method;
    try {
      static_cast<void>(render(scene, options));
      ADD_FAILURE() << to_string(method);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
      EXPECT_NE(std::string(error.what()).find("raysheaf::paper"), std::string::npos);
    }
  }
  for (const Method method : {Method::kBrute, Method::kDual}) {
    options.method = method;
    EXPECT_NO_THROW(static_cast<void>(render(scene, options)));
  }
  use_paper_methods();
  options.method = Method::kCrsh;
  EXPECT_NO_THROW(static_cast<void>(render(scene, options)));
}

TEST(Renderer, ShowsFromAnyPointOfView) {
  const SceneDescription scene = mirrors();
  const RenderOptions options = test::small_options(24);
  Renderer renderer;
  renderer.show(scene);
  const Camera camera = test::camera_at({5, 1, 2}, {0, 1, 0});
  SceneDescription other = scene;
  other.cameras = {camera};
  EXPECT_TRUE(
      test::same_bits(renderer.render(options, camera).beauty, render(other, options).beauty));
}

}  // namespace
}  // namespace raysheaf
