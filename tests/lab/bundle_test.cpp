// The rays in bundles, and their bounds.
#include <gtest/gtest.h>

#include <cmath>

#include "geom/ray_end.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/lab.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kSide = 24;

/// Whether an interpolation of the two boxes, with the same factor on each axis, contains the
/// point.
bool in_hull(const BundleVolume& volume, Vec3 p, float slack) {
  double lo = 0, hi = 1;
  const auto clip = [&](double gap, double speed) {  // gap + slack >= s * speed
    gap += slack;
    if (speed > 0) hi = std::min(hi, gap / speed);
    if (speed < 0) lo = std::max(lo, gap / speed);
    if (speed == 0 && gap < 0) lo = 2;
  };
  for (int k = 0; k < 3; ++k) {
    const double at = component(p, k);
    const double o0 = component(volume.origins.min, k), o1 = component(volume.origins.max, k);
    clip(at - o0, component(volume.ends.min, k) - o0);
    clip(o1 - at, o1 - component(volume.ends.max, k));
    if (at + slack < component(volume.within.min, k)) return false;
    if (at - slack > component(volume.within.max, k)) return false;
  }
  return lo <= hi + 1e-4;
}

bool in_cone(const BundleVolume& volume, const Ray& ray, Vec3 p, float slack) {
  if (length(ray.origin - volume.center) > volume.radius + slack) return false;
  if (length(p - ray.origin) > volume.reach + slack) return false;
  const Vec3 d = normalized(ray.direction);
  return volume.sin_angle > 1 ||
         (dot(d, volume.axis) > 0 && length(cross(d, volume.axis)) <= volume.sin_angle + 1e-5f);
}

void expect_bounded(const RayBundle& bundle, const Box& scene) {
  const float slack = 1e-4f * length(scene.max - scene.min);
  for (const BundleVolume& volume : bundle.volumes) {
    ASSERT_TRUE(volume.has_hull || volume.has_cone);
    EXPECT_GE(volume.ray_count, bundle.rays.size());
    for (const Ray& ray : bundle.rays) {
      const Box end = end_of(ray, scene);
      const Vec3 to = (end.min + end.max) * 0.5f, from = ray.origin + ray.direction * ray.t_min;
      for (const float s : {0.0f, 0.5f, 1.0f}) {
        const Vec3 p = lerp(from, to, s);
        EXPECT_TRUE(!volume.has_hull || in_hull(volume, p, slack)) << bundle.what << " at " << s;
        EXPECT_TRUE(!volume.has_cone || in_cone(volume, ray, p, slack)) << bundle.what;
      }
    }
  }
}

std::vector<MethodSettings> settings_to_try() {
  std::vector<MethodSettings> all;
  for (const Method method : {Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual})
    all.push_back(method_settings(method));
  for (const BundleBound bound : {BundleBound::kFiniteCone, BundleBound::kShaft,
                                  BundleBound::kFrustum, BundleBound::kShaftAndCone}) {
    all.push_back(method_settings(Method::kCrsh));
    all.back().bound = bound;
    all.back().levels = 3;
    all.back().branching = 4;
  }
  return all;
}

bool is_of(const Ray& ray, const std::vector<Ray>& all) {
  for (const Ray& other : all) {
    if (ray.origin == other.origin && ray.direction == other.direction) return true;
  }
  return false;
}

TEST(Bundle, ItsVolumesHoldItsRays) {
  for (const std::string name : {"cornell", "office"}) {
    const SceneDescription scene = builtin_scene(name);
    Laboratory laboratory(scene, kSide, kSide);
    for (const LabRays rays : {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
                               LabRays::kAmbientOcclusion}) {
      const std::vector<Ray> all = laboratory.rays(rays);
      for (const MethodSettings& settings : settings_to_try()) {
        int bounded = 0;
        for (std::uint32_t pixel = 0; pixel < kSide; pixel += 5) {
          const auto bundle = laboratory.bundle(rays, settings, pixel, kSide - 1 - pixel);
          if (!bundle) continue;
          ASSERT_LT(bundle->ray, bundle->rays.size());
          for (const Ray& ray : bundle->rays) EXPECT_TRUE(is_of(ray, all));
          EXPECT_FALSE(bundle->what.empty());
          expect_bounded(*bundle, world_bounds(scene));
          bounded += bundle->volumes.empty() ? 0 : 1;
        }
        if (settings.traversal != Traversal::kDual) {
          EXPECT_GT(bounded, 0) << name;
        }
      }
    }
  }
}

TEST(Bundle, IsAsLargeAsItsSettingsSay) {
  Laboratory laboratory(builtin_scene("cornell"), kSide, kSide);
  MethodSettings settings = method_settings(Method::kCrsh);
  settings.levels = 3;
  settings.branching = 4;
  const auto bundle = laboratory.bundle(LabRays::kReflection1, settings, 9, 7);
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->rays.size(), 4u);
  ASSERT_EQ(bundle->volumes.size(), 3u);
  EXPECT_EQ(bundle->volumes[1].ray_count, 16u);
  EXPECT_EQ(bundle->volumes[2].ray_count, 64u);
  // Every surface of the closed box reflects: one ray per pixel, in raster order.
  const std::vector<Ray> all = laboratory.rays(LabRays::kReflection1);
  const Ray& asked = bundle->rays[bundle->ray];
  EXPECT_TRUE(is_of(asked, {all[7 * kSide + 9]}));
  const auto alone =
      laboratory.bundle(LabRays::kReflection1, method_settings(Method::kBrute), 9, 7);
  ASSERT_TRUE(alone);
  EXPECT_TRUE(is_of(asked, alone->rays));
  EXPECT_TRUE(alone->volumes.empty());
}

TEST(Bundle, WithDualAPointLightsBundleIsABeam) {
  Laboratory laboratory(builtin_scene("office"), 96, 96);
  const auto bundle = laboratory.bundle(LabRays::kShadow, method_settings(Method::kDual), 48, 60);
  ASSERT_TRUE(bundle);
  EXPECT_LE(bundle->rays.size(), 16u);
  EXPECT_NE(bundle->what.find("in its beam"), std::string::npos) << bundle->what;
  expect_bounded(*bundle, world_bounds(builtin_scene("office")));
}

TEST(Bundle, IsRefusedOutsideThePicture) {
  Laboratory laboratory(builtin_scene("cornell"), 8, 8);
  const MethodSettings settings = method_settings(Method::kCrsh);
  EXPECT_THROW((void)laboratory.bundle(LabRays::kShadow, settings, 8, 0), Error);
  EXPECT_THROW((void)laboratory.bundle(LabRays::kShadow, settings, 0, 8), Error);
}

}  // namespace
}  // namespace raysheaf
