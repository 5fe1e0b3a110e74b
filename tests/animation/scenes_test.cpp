// Animated sample scenes: every method gives brute force's images, with renderers that follow the
// animation from frame to frame.
#include <gtest/gtest.h>

#include "raysheaf/animation.h"
#include "raysheaf/renderer.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

struct Moving {
  const char* name;
  const char* path;
  std::uint64_t frames;  ///< at 24 frames per second; 0: any
};

void PrintTo(const Moving& moving, std::ostream* out) {
  *out << moving.path;
}

class MovingScenes : public testing::TestWithParam<Moving> {};

TEST_P(MovingScenes, EveryMethodEqualsBruteForce) {
  const Moving& moving = GetParam();
  if (std::string(moving.path).find('*') == std::string::npos) {
    RAYSHEAF_SCENE_OR_SKIP(there, moving.path);
  } else if (test::scenes_directory().empty()) {
    GTEST_SKIP() << "no scenes (set RAYSHEAF_SCENES)";
  }
  const std::string path = (test::scenes_directory() / moving.path).string();
  const auto animation = load_animation(path);
  add_missing_camera_and_light(*animation);
  const std::uint64_t count = frame_count(*animation, 24);
  if (moving.frames != 0) {
    EXPECT_EQ(count, moving.frames);
  }
  ASSERT_GT(count, 1u);
  constexpr Method kMethods[] = {Method::kBrute, Method::kRah, Method::kCrsh, Method::kGl10,
                                 Method::kDual};
  Renderer renderers[std::size(kMethods)];
  std::vector<std::vector<Vec3>> pictures;
  for (Renderer& renderer : renderers) renderer.show(animation->scene());
  for (const std::uint64_t frame : {std::uint64_t{0}, count / 3, count - 1}) {
    const SceneChanges changes = animation->seek(frame_time(*animation, frame, 24));
    RenderOptions options = test::small_options(12);
    std::vector<Vec3> brute;
    for (std::size_t m = 0; m < std::size(kMethods); ++m) {
      options.method = kMethods[m];
      renderers[m].show(animation->scene(), changes);
      const RenderResult picture = renderers[m].render(options);
      if (m == 0) brute = picture.beauty;
      EXPECT_TRUE(test::same_bits(picture.beauty, brute))
          << to_string(kMethods[m]) << ", frame " << frame;
    }
    pictures.push_back(brute);
  }
  EXPECT_FALSE(test::same_bits(pictures[0], pictures[1]) &&
               test::same_bits(pictures[0], pictures[2]))
      << "nothing moved";
}

constexpr Moving kScenes[] = {
    {"AnimatedCube", "gltf_animated/AnimatedCube/AnimatedCube.gltf", 0},
    {"AnimatedMorphCube", "gltf_animated/AnimatedMorphCube.glb", 0},
    {"AnimatedMorphSphere", "gltf_animated/AnimatedMorphSphere.glb", 0},
    {"CesiumMan", "gltf_animated/CesiumMan.glb", 0},
    {"Fox", "gltf_animated/Fox.glb", 0},
    {"MorphStressTest", "gltf_animated/MorphStressTest.glb", 0},
    {"SimpleMorph", "gltf_animated/SimpleMorph/SimpleMorph.gltf", 0},
    {"SimpleSkin", "gltf_animated/simple_skin/simple_skin.gltf", 0},
    {"BartKitchen", "bart_kitchen/scene.json", 11},
    {"BartMuseum", "bart_museum/scene.json", 25},
    {"ClothBall", "cloth_ball/cloth_ball9*.ply", 2},
};

INSTANTIATE_TEST_SUITE_P(Animated, MovingScenes, testing::ValuesIn(kScenes),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace raysheaf
