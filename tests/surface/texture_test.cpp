#include "render/surface/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/scene/support.h"

namespace raysheaf {
namespace {

/// Two by two texels: black, red above; green, blue below.
SceneDescription four_pixels(Wrap wrap, Filter filter) {
  SceneDescription scene;
  scene.images.push_back({"", 2, 2, {0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 0}});
  scene.textures.push_back({0, wrap, wrap, filter});
  return scene;
}

Vec4 at(const SceneDescription& scene, Vec2 uv, TextureSlot slot = {}) {
  slot.texture = 0;
  return TextureSet(scene).numbers(slot, uv);
}

void expect_color(Vec4 c, float r, float g, float b) {
  EXPECT_NEAR(c.x, r, 1e-5);
  EXPECT_NEAR(c.y, g, 1e-5);
  EXPECT_NEAR(c.z, b, 1e-5);
}

TEST(Texture, NearestTakesTheTexel) {
  const SceneDescription scene = four_pixels(Wrap::kRepeat, Filter::kNearest);
  expect_color(at(scene, {0.1f, 0.1f}), 0, 0, 0);
  expect_color(at(scene, {0.9f, 0.1f}), 1, 0, 0);
  expect_color(at(scene, {0.1f, 0.9f}), 0, 1, 0);
  expect_color(at(scene, {0.9f, 0.9f}), 0, 0, 1);
  EXPECT_EQ(at(scene, {0.9f, 0.9f}).w, 0);
}

TEST(Texture, BilinearMeetsTexelCentresAndMixesBetween) {
  const SceneDescription scene = four_pixels(Wrap::kClampToEdge, Filter::kLinear);
  expect_color(at(scene, {0.25f, 0.25f}), 0, 0, 0);
  expect_color(at(scene, {0.75f, 0.25f}), 1, 0, 0);
  expect_color(at(scene, {0.5f, 0.5f}), 0.25f, 0.25f, 0.25f);
  expect_color(at(scene, {0.375f, 0.25f}), 0.25f, 0, 0);
}

TEST(Texture, WrapsAsItSays) {
  for (const Filter filter : {Filter::kLinear, Filter::kNearest}) {
    expect_color(at(four_pixels(Wrap::kRepeat, filter), {1.75f, -0.75f}), 1, 0, 0);
    expect_color(at(four_pixels(Wrap::kRepeat, filter), {-0.25f, 0.25f}), 1, 0, 0);
    expect_color(at(four_pixels(Wrap::kMirroredRepeat, filter), {1.75f, 0.25f}), 0, 0, 0);
    expect_color(at(four_pixels(Wrap::kMirroredRepeat, filter), {-0.25f, 2.25f}), 0, 0, 0);
    expect_color(at(four_pixels(Wrap::kMirroredRepeat, filter), {1.25f, 0.25f}), 1, 0, 0);
    expect_color(at(four_pixels(Wrap::kClampToEdge, filter), {9, -9}), 1, 0, 0);
  }
  // The filter reaches across the seam only if the texture repeats.
  expect_color(at(four_pixels(Wrap::kRepeat, Filter::kLinear), {0, 0.25f}), 0.5f, 0, 0);
  expect_color(at(four_pixels(Wrap::kClampToEdge, Filter::kLinear), {0, 0.25f}), 0, 0, 0);
  expect_color(at(four_pixels(Wrap::kMirroredRepeat, Filter::kLinear), {1, 0.25f}), 1, 0, 0);
}

TEST(Texture, NoCoordinateLeavesTheImage) {
  test::Random random(1);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirroredRepeat, Wrap::kClampToEdge}) {
    for (const Filter filter : {Filter::kLinear, Filter::kNearest}) {
      const SceneDescription scene = four_pixels(wrap, filter);
      for (const float odd :
           {-1e-9f, -1e-45f, 1.0f, 2.0f, 3e38f, -3e38f, kInf, -kInf, std::nanf("")}) {
        const Vec4 c = at(scene, {odd, -odd});
        EXPECT_TRUE(c.x >= 0 && c.x <= 1);
      }
      for (int i = 0; i < 500; ++i) {
        const float scale = std::pow(10.0f, test::uniform(random, -10, 10));
        const Vec4 c =
            at(scene, {test::uniform(random, -scale, scale), test::uniform(random, -1, 2)});
        EXPECT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1 && c.w >= 0 && c.w <= 1);
      }
    }
  }
}

TEST(Texture, SrgbIsMadeLinearBeforeItIsMixed) {
  SceneDescription scene = four_pixels(Wrap::kClampToEdge, Filter::kLinear);
  TextureSlot slot;
  slot.texture = 0;
  expect_color(TextureSet(scene).color(slot, {0.5f, 0.25f}), 0.5f, 0, 0);
  scene.images[0].rgba[0] = 188;  // almost one half
  EXPECT_NEAR(TextureSet(scene).color(slot, {0, 0}).x, 0.5, 5e-3);
  scene.images[0].rgba[0] = 5;  // on the linear part of the curve
  EXPECT_NEAR(TextureSet(scene).color(slot, {0, 0}).x, 5 / 255.0 / 12.92, 1e-7);
}

TEST(Texture, AnEmptySlotIsWhite) {
  const Vec4 c = TextureSet(SceneDescription{}).color({}, {0.3f, 0.4f});
  expect_color(c, 1, 1, 1);
  EXPECT_EQ(c.w, 1);
}

TEST(Texture, SlotsScaleThenRotateThenMove) {
  TextureSlot slot;
  slot.scale = {2, 3};
  Vec2 uv = transform_uv(placed_texture(slot), {0.1f, 0.2f});
  EXPECT_FLOAT_EQ(uv.x, 0.2f);
  EXPECT_FLOAT_EQ(uv.y, 0.6f);
  slot.rotation = std::numbers::pi_v<float> / 2;  // +u goes up, which is -v
  slot.offset = {10, 20};
  uv = transform_uv(placed_texture(slot), {1, 0});
  EXPECT_NEAR(uv.x, 10, 1e-5);
  EXPECT_NEAR(uv.y, 18, 1e-5);
  uv = transform_uv(placed_texture(slot), {0, 1});
  EXPECT_NEAR(uv.x, 13, 1e-5);
  EXPECT_NEAR(uv.y, 20, 1e-5);
}

TEST(Texture, RotatesTheSameWayAsKhronosAsset) {
  // TextureTransformTest: the marker of the correct position, in uv, where the arrow's tip appears.
  TextureSlot slot;
  slot.rotation = 0.39269908f;
  const Vec2 uv = transform_uv(placed_texture(slot), {0.5f - 0.0790482f, 0.5f + 0.5162675f});
  EXPECT_NEAR(uv.x, 0.5 + 0.2778175, 1e-5);
  EXPECT_NEAR(uv.y, 0.5 + 0.2778175, 1e-5);
}

}  // namespace
}  // namespace raysheaf
