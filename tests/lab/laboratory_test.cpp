// The laboratory: every method on every batch, and the properties of the rays that it makes.
#include "raysheaf/lab.h"

#include <gtest/gtest.h>

#include "lab/lab_rays.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "render/frame/primary.h"

namespace raysheaf {
namespace {

constexpr LabRays kAllRays[] = {LabRays::kShadow, LabRays::kReflection1, LabRays::kReflection2,
                                LabRays::kAmbientOcclusion};

std::vector<MethodSettings> laboratory_settings() {
  std::vector<MethodSettings> all;
  for (const Method method : {Method::kBrute, Method::kRah, Method::kCrsh, Method::kDual})
    all.push_back(method_settings(method));
  all.push_back(method_settings(Method::kCrsh));
  all.back().levels = 3;
  all.back().branching = 4;
  all.push_back(method_settings(Method::kRah));
  all.back().mesh_culling = true;
  return all;
}

TEST(Laboratory, EverySettingMeetsBruteForceOnEveryBatch) {
  for (const std::string name : {"cornell", "office"}) {
    Laboratory laboratory(builtin_scene(name), 24, 24);
    for (const LabRays rays : kAllRays) {
      for (const MethodSettings& settings : laboratory_settings()) {
        BatchStatistics s;
        ASSERT_NO_THROW(s = laboratory.measure(rays, settings));
        EXPECT_EQ(s.rays, laboratory.ray_count(rays));
        for (std::size_t l = 1; l < s.levels.size(); ++l)
          EXPECT_EQ(s.levels[l].tests, settings.branching * s.levels[l - 1].hits);
        if (settings.traversal == Traversal::kDual) {
          EXPECT_FALSE(s.plan.empty());
          EXPECT_LT(s.total_tests(), s.brute_force_tests());
        } else if (!s.levels.empty()) {
          EXPECT_EQ(s.final_tests, settings.branching * s.levels.back().hits);
        } else {
          EXPECT_EQ(s.total_tests(), s.brute_force_tests());
        }
      }
    }
  }
}

TEST(Laboratory, CountsDoNotDependOnThreadsNorOnRepetition) {
  Laboratory three(builtin_scene("office"), 32, 32, 3), one(builtin_scene("office"), 32, 32, 1);
  for (const LabRays rays : kAllRays) {
    for (const Method method : {Method::kCrsh, Method::kDual}) {
      const auto a = one.measure(rays, method_settings(method), false);
      const auto again = one.measure(rays, method_settings(method), false);
      const auto b = three.measure(rays, method_settings(method), false);
      EXPECT_EQ(a.total_tests(), b.total_tests()) << to_string(method);
      EXPECT_EQ(a.total_tests(), again.total_tests()) << to_string(method);
      EXPECT_EQ(a.hits, b.hits);
      EXPECT_EQ(a.plan, b.plan);
    }
  }
}

TEST(Laboratory, EverySurfaceOfAClosedBoxMirrors) {
  Laboratory laboratory(builtin_scene("cornell"), 20, 20);
  EXPECT_EQ(laboratory.ray_count(LabRays::kReflection1), 400u);
  EXPECT_EQ(laboratory.ray_count(LabRays::kReflection2), 400u);
  EXPECT_EQ(laboratory.ray_count(LabRays::kAmbientOcclusion), 1600u);
  EXPECT_EQ(laboratory.measure(LabRays::kReflection2, method_settings(Method::kRah)).bounce, 2u);
  EXPECT_EQ(laboratory.measure(LabRays::kAmbientOcclusion, method_settings(Method::kRah)).kind,
            RayKind::kAmbientOcclusion);
}

TEST(Laboratory, RefusesWhatCannotBeMeasured) {
  EXPECT_THROW(Laboratory({}, 8, 8), Error);
  EXPECT_THROW(Laboratory(builtin_scene("cornell"), 0, 8), Error);
  Laboratory laboratory(builtin_scene("cornell"), 8, 8);
  EXPECT_THROW((void)laboratory.measure_as_published(LabRays::kShadow, Method::kBrute, {}), Error);
  EXPECT_THROW((void)laboratory.measure_as_published(LabRays::kShadow, Method::kRah, {}, 0, 8),
               Error);
  EXPECT_THROW((void)laboratory.measure_as_published(LabRays::kShadow, Method::kRah, {}, 33, 8),
               Error);
  const auto refused = [&](auto change) {
    MethodSettings settings = method_settings(Method::kCrsh);
    change(settings);
    EXPECT_THROW((void)laboratory.measure(LabRays::kShadow, settings), Error);
    EXPECT_THROW((void)laboratory.bundle(LabRays::kShadow, settings, 4, 4), Error);
  };
  for (const std::uint32_t branching : {0u, 1u, 65u})
    refused([&](MethodSettings& s) { s.branching = branching; });
  for (const std::uint32_t levels : {0u, 9u})
    refused([&](MethodSettings& s) { s.levels = levels; });
  refused([](MethodSettings& s) { s.key_bits = 16; });
}

TEST(Laboratory, ASceneWithoutCameraAndLightGetsThem) {
  SceneDescription scene = builtin_scene("cornell");
  scene.cameras.clear();
  scene.lights.clear();
  Laboratory laboratory(scene, 16, 16);
  EXPECT_GT(laboratory.ray_count(LabRays::kReflection1), 0u);
}

class Rays : public testing::Test {
 protected:
  const SceneDescription description_ = builtin_scene("office");
  const Executor executor_{2};
  const FlatScene scene_ = flatten(executor_, description_, mesh_bounds(executor_, description_));
  const TextureSet textures_{description_};

  Fragments fragments() {
    ProgressMeter meter;
    BatchStatistics not_kept;
    const CameraFrame frame = make_camera_frame(description_.cameras.front(), 32, 32);
    return fetch_fragments(executor_, scene_, textures_, frame,
                           trace_primary(executor_, scene_, frame, method_settings(Method::kCrsh),
                                         &not_kept, {}, &meter));
  }
};

TEST_F(Rays, MirrorsTurnTheDirectionAboutANormal) {
  const Fragments all = fragments();
  const RayBatch batch = make_mirror_rays(executor_, all, scene_.bounds, 1);
  ASSERT_FALSE(batch.rays.empty());
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Fragment& f = all[batch.slots[i]];
    const Vec3 d = batch.rays[i].direction;
    EXPECT_GT(dot(d, f.surface.geometric_normal), 0);
    const auto turned_about = [&](Vec3 n) {
      return length(d - (f.incoming - n * (2 * dot(f.incoming, n)))) < 1e-4f;
    };
    EXPECT_TRUE(turned_about(f.surface.normal) || turned_about(f.surface.geometric_normal));
    EXPECT_EQ(batch.pixels[i], f.pixel);
  }
}

TEST_F(Rays, OcclusionRaysAreCosineDistributed) {
  const Fragments all = fragments();
  const RayBatch batch = make_occlusion_rays(executor_, all, scene_.bounds, 2.5f);
  ASSERT_EQ(batch.rays.size() % kOcclusionRays, 0u);
  double cosines = 0, squares = 0;
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Fragment& f = all[batch.slots[i] % all.size()];
    const Ray& ray = batch.rays[i];
    EXPECT_NEAR(length(ray.direction), 1, 1e-5);
    EXPECT_GE(dot(ray.direction, f.surface.geometric_normal), -1e-6f);
    EXPECT_EQ(ray.t_max, 2.5f);
    const auto cosine = static_cast<double>(dot(ray.direction, f.surface.normal));
    cosines += cosine;
    squares += cosine * cosine;
  }
  const auto n = static_cast<double>(batch.rays.size());
  EXPECT_NEAR(cosines / n, 2.0 / 3, 0.01);  // for the density cos / pi: the means of cos and cos^2
  EXPECT_NEAR(squares / n, 0.5, 0.01);
  EXPECT_EQ(make_occlusion_rays(Executor(1), all, scene_.bounds, 2.5f).keys, batch.keys);
}

}  // namespace
}  // namespace raysheaf
