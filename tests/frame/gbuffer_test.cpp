// The paper's four targets: the picture does not change, and they show what rays meet. On the CPU
// and on the CPU as a device.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "frame/device_scenes.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "raysheaf/renderer.h"
#include "render/raster/gbuffer_body.h"
#include "render/raster/rasterizer.h"
#include "support/guarded_memory.h"

namespace raysheaf {
namespace {

class GbufferFrames : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      const Rasterizer rasterizer;
    } catch (const Error&) {
      GTEST_SKIP() << "no OpenGL 4.5 context here";
    }
  }
  const Executor executor_{2};
  test::GuardedMemory memory_;
  const Context device_ =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor_, memory_));
};

RenderOptions drawn(std::uint32_t size) {
  RenderOptions options = test::small_options(size);
  options.primary = Primary::kRaster;
  options.gbuffer = true;
  return options;
}

RenderOptions without(RenderOptions options) {
  options.gbuffer = false;
  return options;
}

bool same_texels(const std::vector<Vec4>& a, const std::vector<Vec4>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

void expect_same_targets(const Gbuffer& a, const Gbuffer& b) {
  EXPECT_TRUE(same_texels(a.position, b.position));
  EXPECT_TRUE(same_texels(a.normal, b.normal));
  EXPECT_TRUE(same_texels(a.diffuse, b.diffuse));
  EXPECT_TRUE(same_texels(a.specular, b.specular));
}

bool same_triangle(const PixelIds& a, const PixelIds& b) {
  return a.inst_id == b.inst_id && a.geom_id == b.geom_id && a.prim_id == b.prim_id;
}

Vec3 xyz(const Vec4& a) {
  return {a.x, a.y, a.z};
}

/// Whether the colours of a triangle are its corners', and what lies between them.
bool is_untextured(const SceneDescription& scene, const PixelIds& ids) {
  const Mesh& mesh = scene.meshes[ids.geom_id];
  if (mesh.materials.empty()) return true;
  const Material& m = scene.materials[mesh.materials[mesh.materials.size() == 1 ? 0 : ids.prim_id]];
  return m.base_color_texture.texture == kInvalidId &&
         m.metallic_roughness_texture.texture == kInvalidId;
}

/// Away from edges, where OpenGL's grid decides, the targets must have the values that the pixel's
/// ray meets. Returns how many pixels that were.
int expect_traced_hits(const SceneDescription& scene, const RenderResult& r) {
  int compared = 0;
  const std::size_t width = r.width;
  for (std::size_t y = 1; y + 1 < r.height; ++y) {
    for (std::size_t x = 1; x + 1 < width; ++x) {
      const std::size_t i = y * width + x;
      float step = 0;  // to the next pixel's point, on the same triangle
      bool inside = true;
      for (const std::size_t j : {i - 1, i + 1, i - width, i + width, i - width - 1, i - width + 1,
                                  i + width - 1, i + width + 1}) {
        inside = inside && same_triangle(r.ids[i], r.ids[j]);
        step = std::max(step, length(r.position[j] - r.position[i]));
      }
      if (!inside) continue;
      const bool seen = r.ids[i].prim_id != kInvalidId;
      EXPECT_EQ(r.gbuffer.position[i].w >= 0, seen) << i;
      EXPECT_EQ(r.gbuffer.diffuse[i].w, seen ? 1 : 0) << i;
      if (!seen) continue;
      ++compared;
      EXPECT_LE(length(xyz(r.gbuffer.position[i]) - r.position[i]), 0.05f * step) << i;
      EXPECT_NEAR(length(xyz(r.gbuffer.normal[i])), 1, 1e-5f) << i;
      EXPECT_GT(dot(xyz(r.gbuffer.normal[i]), r.normal[i]), 0.999f) << i;
      if (!is_untextured(scene, r.ids[i])) continue;
      EXPECT_LE(max_component(abs(xyz(r.gbuffer.specular[i]) - r.specular[i])), 1e-4f) << i;
      EXPECT_LE(
          max_component(abs(xyz(r.gbuffer.diffuse[i]) + xyz(r.gbuffer.specular[i]) - r.albedo[i])),
          1e-4f)
          << i;
    }
  }
  return compared;
}

TEST_F(GbufferFrames, OfBuiltinScenesShowWhatRaysMeet) {
  for (const std::string& name : builtin_scene_names()) {
    SCOPED_TRACE(name);
    const SceneDescription scene = builtin_scene(name);
    const RenderOptions options = drawn(160);
    const RenderResult here = render(scene, options);
    test::expect_same_picture(here, render(scene, without(options)));
    EXPECT_GT(expect_traced_hits(scene, here), 3000);
    EXPECT_NE(here.statistics.primary.find("four RGBA32F targets"), std::string::npos);
    const RenderResult there = render(device_, scene, options);
    test::expect_same_picture(there, here);
    expect_same_targets(there.gbuffer, here.gbuffer);
  }
}

/// With textures, bumps and colours in the corners, several samples, and methods.
TEST_F(GbufferFrames, ChangeNoPicture) {
  for (const Method method : {Method::kDual, Method::kCrsh, Method::kGl10, Method::kBrute}) {
    SCOPED_TRACE(to_string(method));
    RenderOptions options = drawn(24);
    options.method = method;
    options.samples = 2;
    const SceneDescription scene = motley(60, true);
    const RenderResult here = render(scene, options);
    test::expect_same_picture(here, render(scene, without(options)));
    EXPECT_EQ(here.gbuffer.position.size(), 24u * 24u);
    EXPECT_TRUE(render(scene, without(options)).gbuffer.position.empty());
    const RenderResult there = render(device_, scene, options);
    test::expect_same_picture(there, here);
    expect_same_targets(there.gbuffer, here.gbuffer);
    setenv("RAYSHEAF_NO_INTEROP", "1", 1);
    const RenderResult copied = render(device_, scene, options);
    unsetenv("RAYSHEAF_NO_INTEROP");
    test::expect_same_picture(copied, here);
    expect_same_targets(copied.gbuffer, here.gbuffer);
    options.samples = 1;
    expect_same_targets(render(scene, options).gbuffer, here.gbuffer);  // the first sample's
  }
}

TEST_F(GbufferFrames, TakeTurnsWithOthers) {
  Renderer here, there(device_);
  const SceneDescription scene = motley(61);
  here.show(scene);
  there.show(scene);
  for (const bool gbuffer : {false, true, true, false, true}) {
    for (const std::uint32_t size : {20u, 33u}) {
      RenderOptions options = drawn(size);
      options.gbuffer = gbuffer;
      const RenderResult a = here.render(options), b = there.render(options);
      test::expect_same_picture(a, b);
      EXPECT_EQ(a.gbuffer.normal.size(), gbuffer ? size * size : 0);
      expect_same_targets(a.gbuffer, b.gbuffer);
    }
  }
}

TEST_F(GbufferFrames, AreOpenGlsAlone) {
  const SceneDescription scene = test::ball_on_floor();
  const auto code_of = [&](const RenderOptions& options) {
    try {
      static_cast<void>(render(scene, options));
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), "gbuffer");
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  RenderOptions options = drawn(16);
  options.primary = Primary::kTrace;
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  options = drawn(16);
  options.aperture = 0.1f;
  EXPECT_EQ(code_of(options), ErrorCode::kUnsupported);
}

TEST_F(GbufferFrames, ShowNothingWhereNothingIs) {
  SceneDescription scene = test::ball_on_floor();
  scene.cameras = {test::camera_at({0, 0, 50}, {0, 0, 100})};
  const RenderResult result = render(scene, drawn(8));
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(result.gbuffer.position[i].w, -1);
    EXPECT_EQ(result.gbuffer.diffuse[i].w, 0);
  }
}

TEST(GbufferBody, NamesSlotsByNumbersThatBinary32Has) {
  for (const std::uint32_t slot : {0u, 1u, 0xffffffu, 0x1000000u, 0x7fffffbfu}) {
    const auto low = static_cast<float>(slot & 0xffffffu), high = static_cast<float>(slot >> 24);
    EXPECT_EQ(slot_of_texels(low, high), slot);
  }
  EXPECT_EQ(slot_of_texels(-1, 0), kInvalidId);
}

}  // namespace
}  // namespace raysheaf
