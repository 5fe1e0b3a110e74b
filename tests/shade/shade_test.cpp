#include "render/shade/shade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "raysheaf/backdrop.h"
#include "raysheaf/studio.h"
#include "render/rays/shadow_body.h"
#include "render/shade/shade_body.h"
#include "support/pictures.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

using test::Random;

Fragment matte(Vec3 normal, Vec3 incoming) {
  Fragment f;
  f.triangle = 0;
  f.incoming = normalized(incoming);
  f.surface.normal = f.surface.geometric_normal = normalized(normal);
  f.surface.diffuse = {1, 1, 1};
  f.surface.roughness = 1;
  return f;
}

TEST(Shade, LambertUnderAPointLightIsTheTextbookValue) {
  const Fragment f = matte({0, 1, 0}, {0, -1, 0});
  const Vec3 radiance =
      lit_by(f, sample_light(placed_light(test::point_light({0, 2, 0}, 12)), f.surface.position));
  EXPECT_NEAR(radiance.x, 12.0f / 4 / kPi, 1e-6f);
}

TEST(Shade, LightBehindTheSurfaceGivesNothing) {
  const Fragment f = matte({0, 1, 0}, {0, -1, 0});
  EXPECT_EQ(max_component(lit_by(f, sample_light(placed_light(test::point_light({0, -2, 0}, 12)),
                                                 f.surface.position))),
            0);
}

TEST(Shade, NoSurfaceReflectsMoreThanArrives) {
  // Monte Carlo integration over the hemisphere: the albedo is at most 1.
  Random random(2);
  for (const float roughness : {0.4f, 0.6f, 1.0f}) {
    for (const float f0 : {0.0f, 0.04f, 0.5f, 1.0f}) {
      for (const float cos_view : {1.0f, 0.5f, 0.1f}) {
        Fragment f = matte({0, 1, 0}, {std::sqrt(1 - cos_view * cos_view), -cos_view, 0});
        f.surface.roughness = roughness;
        f.surface.specular = f.surface.coat = {f0, f0, f0};
        f.surface.diffuse = Vec3{1, 1, 1} * (f0 > 0.5f ? 0.0f : 1.0f);
        double sum = 0;
        constexpr int kSamples = 40000;
        for (int i = 0; i < kSamples; ++i) {
          Vec3 d = random.direction();
          d.y = std::fabs(d.y);
          if (d.y > 0) sum += double{reflectance(f, d).x} * 2 * double{kPi};
        }
        EXPECT_LE(sum / kSamples, 1.03) << roughness << " " << f0 << " " << cos_view;
      }
    }
  }
}

TEST(Shade, EmissionAndSkyAddUp) {
  Fragment f = matte({0, 1, 0}, {0, -1, 0});
  f.surface.emission = {2, 0, 0};
  const Executor executor(1);
  const std::vector<Fragment> fragments{f, Fragment{}};
  const auto radiance = shade_glow(executor, fragments, {{0.5f, 0.5f, 0.5f}}, kAllBounces);
  EXPECT_NEAR(radiance[0].x, 2.5f, 1e-6f);
  EXPECT_NEAR(radiance[0].y, 0.5f, 1e-6f);
  EXPECT_EQ(radiance[1].x, 0.5f);  // the ray hit nothing
}

TEST(Shade, AutomaticSkyIsWhiteWhereNoLightFacesWhatIsSeen) {
  const Executor executor(1);
  const std::vector<Fragment> fragments{matte({0, 1, 0}, {0, -1, 0}), Fragment{}};
  const auto sky = [&](const std::vector<Light>& lights) {
    return sky_of_parts(sky_parts(executor, fragments, placed_lights(lights))).x;
  };
  const Light above = test::point_light({0, 2, 0}, 4), below = test::point_light({0, -2, 0}, 4);
  EXPECT_NEAR(sky({above}), 1 / (7 * kPi), 1e-6);
  EXPECT_EQ(sky({above, below}), sky({above}));
  EXPECT_EQ(sky({below}), 1);
  EXPECT_EQ(sky({}), 1);
  const std::vector<Fragment> nothing(2);
  EXPECT_EQ(sky_of_parts(sky_parts(executor, nothing, placed_lights(std::vector<Light>{above}))).x,
            0);
}

/// Surfaces of all kinds, some seen edge-on, some at the light's own place or facing away from it.
Fragments all_kinds_of_surfaces(std::size_t count, Vec3 light) {
  Random random(5);
  Fragments fragments(count);
  for (Fragment& f : fragments) {
    f = matte(random.direction(), random.direction());
    Surface& s = f.surface;
    s.position = random.below(20) == 0 ? light : random.in_box(2);
    if (random.below(20) == 0) f.incoming = normalized(light - s.position);
    if (random.below(20) == 0) s.position = s.position * 1e17f;
    s.diffuse = random.in_box(1) + Vec3{1, 1, 1};
    const float metal = random.unit();
    s.specular = random.below(3) == 0 ? Vec3{0, 0, 0} : Vec3{metal, 0.5f * metal, 0.04f};
    s.coat = random.below(3) == 0 ? s.specular : Vec3{0.04f, 0.04f, 0.04f};
    s.specular_edge = random.unit();
    s.coat_edge = random.unit();
    s.roughness = random.unit();
  }
  return fragments;
}

TEST(Shade, ManyFragmentsAtATimeAreAsOneByOneOnEverySimdTarget) {
  std::vector<Light> lights(4, test::point_light({0.5f, 2, -1}, 40));
  lights[1].type = Light::Type::kSpot;
  lights[1].direction = {0, -1, 0};
  lights[1].outer_angle = 1.2f, lights[1].range = 3;
  lights[2].type = Light::Type::kDirectional;
  lights[3].type = Light::Type::kRectangle;
  lights[3].width = lights[3].height = 1;
  const std::vector<PlacedLight> placed = placed_lights(lights);
  const Fragments fragments = all_kinds_of_surfaces(1777, lights[0].position);
  Random random(8);
  std::vector<Visibility> visibility(lights.size() * fragments.size());
  for (Visibility& v : visibility) v = static_cast<Visibility>(random.below(3));
  std::vector<Vec3> expected(fragments.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    for (std::uint32_t l = 0; l < lights.size(); ++l)
      if (visibility[l * fragments.size() + i] == Visibility::kVisible)
        expected[i] += lit_by(fragments[i], choose_on_light(fragments[i], placed[l], l, {}));
  }
  test::for_each_simd_target([&](const char* target) {
    std::vector<Vec3> radiance(fragments.size());
    shade_lights(Executor(3), fragments, {placed, 0, {}}, visibility, radiance);
    EXPECT_TRUE(test::same_bits(radiance, expected)) << target;
  });
}

/// Some are no surfaces, glass, mirrors, lamps or unlit; some have almost no weight.
Fragments all_kinds_of_glow(std::size_t count) {
  Random random(6);
  Fragments fragments = all_kinds_of_surfaces(count, {0.5f, 2, -1});
  for (Fragment& f : fragments) {
    Surface& s = f.surface;
    s.unlit = random.below(9) == 0;
    if (random.below(4) == 0) s.emission = random.in_box(1) + Vec3{1, 1, 1};
    if (random.below(3) == 0) s.roughness = 0.1f * random.unit();
    if (random.below(8) == 0) s.transmission = random.unit();
    if (random.below(3) == 0) f.weight = Vec3{1, 0.5f, 0.25f} * (0.004f * random.unit());
    if (random.below(9) == 0) f = {};
  }
  return fragments;
}

StudioRoom room_before(const Camera& camera) {
  const std::vector<Light> lights = studio_lights(SceneDescription{}, camera);
  return studio_room(lights);
}

TEST(Shade, TheRoomFollowsFromTheLightsOfTheStudio) {
  Random random(8);
  for (int round = 0; round < 50; ++round) {
    Camera camera;
    const Vec3 back = random.direction();
    const Vec3 right = normalized(cross(random.direction(), back)), up = cross(back, right);
    for (int row = 0; row < 3; ++row)
      camera.to_world.m[row] = {component(right, row), component(up, row), component(back, row), 0};
    const std::vector<Light> lights = studio_lights(SceneDescription{}, camera);
    const StudioRoom room = studio_room(lights);
    EXPECT_FLOAT_EQ(room.white, 1);
    EXPECT_GT(dot(room.up, column(camera.to_world, 1)), 0.9999f);
    EXPECT_GT(dot(room.back, column(camera.to_world, 2)), 0.9999f);
    // Each light comes out of a box, and rough surfaces blur it.
    for (const Light& light : lights) {
      const float sharp = studio_radiance(room, -light.direction, 0).x;
      EXPECT_GT(sharp, 2);
      EXPECT_LT(studio_radiance(room, -light.direction, 0.9f).x, 0.5f * sharp);
    }
    // Nothing is black.
    for (int i = 0; i < 100; ++i) {
      const Vec3 seen = studio_radiance(room, random.direction(), random.unit());
      EXPECT_GE(seen.x, 0.19f);
      EXPECT_LT(seen.x, 6);
    }
  }
  std::vector<Light> lights = studio_lights(SceneDescription{}, Camera{});
  for (Light& light : lights) light.intensity = light.intensity * 3;
  EXPECT_FLOAT_EQ(studio_room(lights).white, 3);
  lights[1].type = Light::Type::kPoint;
  EXPECT_EQ(studio_room(lights).white, 0);
  EXPECT_EQ(studio_room({}).white, 0);
}

TEST(Shade, TheRoomIsInReflectionsAndNotBehindTheSceneNorOnMatteSurfaces) {
  const Executor executor(1);
  const Vec3 sky{0.5f, 0.5f, 0.5f};
  const StudioRoom room = room_before(Camera{});
  Fragment dull = matte({0, 1, 0}, {0, -1, 0});
  dull.surface.specular_edge = dull.surface.coat_edge = 0;
  Fragment mirror = dull;
  mirror.surface.diffuse = {0, 0, 0};
  mirror.surface.specular = {1, 1, 1};
  mirror.surface.specular_edge = 1;
  mirror.surface.roughness = 0;
  Fragment lost;
  lost.incoming = normalized(Vec3{-0.6f, 0.8f, 0.8f});
  const std::vector<Fragment> fragments{dull, mirror, lost};
  const auto seen = shade_glow(executor, fragments, {sky, nullptr, room, true}, 0);
  EXPECT_EQ(seen[0].x, 0.5f);
  EXPECT_NEAR(seen[1].x, studio_radiance(room, {0, 1, 0}, 0).x, 1e-5f);
  EXPECT_EQ(seen[2].x, 0.5f);
  const auto reflected = shade_glow(executor, fragments, {sky, nullptr, room, false}, 0);
  EXPECT_EQ(reflected[2].x, studio_radiance(room, lost.incoming, 0).x);
  EXPECT_GT(reflected[2].x, 3);
}

TEST(Shade, GlowOfManyIsThatOfOneByOneOnEverySimdTarget) {
  const Vec3 sky{0.25f, 0.5f, 0.125f};
  const StudioRoom room = room_before(Camera{});
  for (const std::size_t size : {1u, 15u, 16u, 257u, 3001u}) {
    const Fragments fragments = all_kinds_of_glow(size);
    for (const std::uint8_t traced : {kAllBounces, kRefracts, std::uint8_t{0}}) {
      std::vector<Vec3> expected(size), in_room(size);
      std::vector<std::uint8_t> rays(size);
      for (std::size_t i = 0; i < size; ++i) {
        const Fragment& f = fragments[i];
        expected[i] = sky;
        in_room[i] = studio_radiance(room, f.incoming, 0);
        if (f.triangle == kInvalidId) continue;
        const Scattering s = scatter(f);
        rays[i] = static_cast<std::uint8_t>(rays_of(f, s) & traced);
        expected[i] = glow(f, s, sky, rays[i]);
        in_room[i] = expected[i] + room_glow(f, s, sky, room, rays[i]);
      }
      test::for_each_simd_target([&](const char* target) {
        std::vector<std::uint8_t> going_on(size, 0xff);
        const auto radiance = shade_glow(Executor(3), fragments, {sky}, traced, going_on);
        EXPECT_TRUE(test::same_bits({radiance.begin(), radiance.end()}, expected)) << target;
        EXPECT_EQ(going_on, rays) << target;
        const auto alone = shade_glow(Executor(1), fragments, {sky}, traced);
        EXPECT_TRUE(test::same_bits({alone.begin(), alone.end()}, expected)) << target;
        const auto shown = shade_glow(Executor(3), fragments, {sky, nullptr, room}, traced);
        EXPECT_TRUE(test::same_bits({shown.begin(), shown.end()}, in_room)) << target;
      });
    }
  }
}

TEST(Shade, AccumulationIsExactWhateverTheThreads) {
  Random random(4);
  std::vector<Fragment> fragments;
  std::vector<Vec3> radiance;
  std::vector<Vec3> expected(1000);
  for (std::uint32_t pixel = 0; pixel < 1000; ++pixel) {
    for (std::uint32_t i = random.below(4); i > 0; --i) {
      Fragment f;
      f.pixel = pixel;
      f.weight = random.in_box(1);
      fragments.push_back(f);
      radiance.push_back(random.in_box(5));
      expected[pixel] += f.weight * radiance.back();
    }
  }
  for (const std::uint32_t threads : {1u, 2u, 5u}) {
    std::vector<Vec3> pixels(1000);
    accumulate(Executor(threads), fragments, radiance, pixels);
    EXPECT_TRUE(test::same_bits(pixels, expected)) << threads;
  }
}

TEST(Shade, ExposureBringsTheLogarithmicMeanToMiddleGrey) {
  const std::vector<Vec3> pixels(100, {7, 7, 7});
  const std::vector<PixelIds> seen(100, {0, 0, 0});
  EXPECT_NEAR(automatic_exposure(pixels, seen) * 7, 0.18f, 1e-4f);
  EXPECT_EQ(automatic_exposure(pixels, std::vector<PixelIds>(100)), 1);
}

TEST(ToneMap, BlackStaysBlackGreyRisesAndNothingLeavesTheRange) {
  RenderResult result;
  result.width = 256;
  result.height = 1;
  for (int i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) * 0.05f;
    result.beauty.push_back({v, v, v});
  }
  const Image image = tone_mapped(result);
  EXPECT_EQ(image.rgba[0], 0);
  for (std::size_t i = 4; i < image.rgba.size(); i += 4)
    EXPECT_GE(image.rgba[i], image.rgba[i - 4]);
  EXPECT_GT(image.rgba[255 * 4], 240);
  EXPECT_EQ(image.rgba[3], 255);
}

TEST(ToneMap, CodesAreThoseOfTheFormula) {
  // The toe of the tone curve and the transfer function, tested at every 97th float.
  const auto code = [](float v) {
    const float c = v - (v < 0.08f ? v - v * v / 0.16f : 0.04f);
    const float x = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
    return static_cast<int>(x * 255 + 0.5f);
  };
  RenderResult result;
  for (std::uint32_t bits = float_bits(1e-4f); bits < float_bits(0.79f); bits += 97)
    result.beauty.push_back(Vec3{1, 1, 1} * bits_float(bits));
  result.width = static_cast<std::uint32_t>(result.beauty.size());
  result.height = 1;
  const Image image = tone_mapped(result);
  for (std::size_t i = 0; i < result.beauty.size(); ++i)
    ASSERT_EQ(image.rgba[4 * i], code(result.beauty[i].x)) << result.beauty[i].x;
}

TEST(ToneMap, NanIsBlackAndInfinityIsWhite) {
  RenderResult result;
  result.width = 3;
  result.height = 1;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  result.beauty = {{nan, nan, nan}, {-1, -2, -3}, {1e30f, 1e30f, 1e30f}};
  const Image image = tone_mapped(result);
  EXPECT_EQ(image.rgba[0], 0);
  EXPECT_EQ(image.rgba[4], 0);
  EXPECT_EQ(image.rgba[8], 255);
}

TEST(Backdrop, ShowsWhereSamplesSeeNothing) {
  RenderResult picture;
  picture.width = 4;
  picture.height = 1;
  picture.ambient = {0.25f, 0.25f, 0.25f};
  const Vec3 red{0.5f, 0, 0}, sky = picture.ambient, up{0, 1, 0}, none{0, 0, 0};
  // Pixels of four samples: all see the background, all see the scene, or one or three do.
  const std::array<std::vector<bool>, 4> seen{{{false, false, false, false},
                                               {true, true, true, true},
                                               {false, false, true, false},
                                               {true, false, true, true}}};
  const auto after = [&](std::uint32_t samples) {
    picture.samples = samples;
    picture.beauty.assign(4, {});
    picture.normal.assign(4, {});
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::uint32_t s = 0; s < samples; ++s) {
        picture.beauty[p] += (seen[p][s] ? red : sky) / static_cast<float>(samples);
        picture.normal[p] += (seen[p][s] ? up : none) / static_cast<float>(samples);
      }
    }
    return picture;
  };
  for (const Rgba color : {Rgba{255, 255, 255, 255}, Rgba{0, 0, 0, 0}, Rgba{12, 34, 56, 255}}) {
    Backdrop backdrop(color);
    RenderOptions options;
    backdrop.watch(&options);
    for (std::uint32_t s = 1; s < 4; ++s) EXPECT_TRUE(options.on_sample(after(s)));
    const RenderResult whole = after(4);
    const Image image = backdrop.picture(whole);
    const Image plain = tone_mapped(whole);
    EXPECT_TRUE(std::equal(color.begin(), color.end(), image.rgba.begin()));
    EXPECT_TRUE(std::equal(image.rgba.begin() + 4, image.rgba.begin() + 8, plain.rgba.begin() + 4));
    if (color[3] == 0) {
      EXPECT_EQ(image.rgba[11], 64);
      EXPECT_EQ(image.rgba[15], 191);
      // The colour is the scene's, without any of the sky.
      for (const std::size_t at : {8, 12})
        EXPECT_TRUE(std::equal(image.rgba.begin() + at, image.rgba.begin() + at + 3,
                               plain.rgba.begin() + 4));
    } else {
      EXPECT_EQ(image.rgba[11], 255);
      EXPECT_GT(image.rgba[8 + 1], image.rgba[12 + 1]);
    }
  }
}

TEST(Backdrop, IsDarkerWhereAShadowLiesOnAGround) {
  RenderResult picture;
  picture.width = 3;
  picture.height = 1;
  picture.samples = 1;
  picture.ambient = {0.25f, 0.25f, 0.25f};
  picture.ground = {0.5f, 0, 0};
  // A shadow, a surface, nothing.
  picture.beauty = {picture.ambient * 0.5f, {0.5f, 0, 0}, picture.ambient};
  picture.normal = {{0, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  const auto pixels = [&](const Rgba& color) {
    Backdrop backdrop(color);
    RenderOptions options;
    backdrop.watch(&options);
    return backdrop.picture(picture).rgba;
  };
  constexpr std::uint8_t half = 188;  // the code of 0.5
  const std::vector<std::uint8_t> white = pixels({255, 255, 255, 255});
  EXPECT_EQ(std::vector(white.begin(), white.begin() + 4),
            (std::vector<std::uint8_t>{half, half, half, 255}));
  EXPECT_EQ(std::vector(white.begin() + 8, white.end()), std::vector<std::uint8_t>(4, 255));
  const std::vector<std::uint8_t> clear = pixels({0, 0, 0, 0});
  EXPECT_EQ(std::vector(clear.begin(), clear.begin() + 4),
            (std::vector<std::uint8_t>{0, 0, 0, 128}));
  EXPECT_EQ(std::vector(clear.begin() + 8, clear.end()), std::vector<std::uint8_t>(4, 0));
  EXPECT_TRUE(std::equal(white.begin() + 4, white.begin() + 8, clear.begin() + 4));
}

}  // namespace
}  // namespace raysheaf
