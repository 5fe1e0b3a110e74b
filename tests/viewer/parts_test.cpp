// Small parts of the viewer: adaptive resolution, latencies, layers, the preview's triangles,
// files, lines of bundles.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "bundle_lines.h"
#include "file_browser.h"
#include "file_watch.h"
#include "latency.h"
#include "picture.h"
#include "preview_mesh.h"
#include "projection.h"
#include "raysheaf/backdrop.h"
#include "raysheaf/builtin_scenes.h"
#include "resolution.h"
#include "tests/support/process.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr Size kWindow{1280, 800};

/// The size at which it settles on a machine that needs `fixed` ms per image and `pixel` ms per
/// pixel.
Size settled(double fixed, double pixel, double goal, Resolution resolution = {}) {
  Size size;
  for (int i = 0; i < 60; ++i) {
    size = resolution.size_for(kWindow, goal);
    resolution.took(size.pixels(), fixed + pixel * static_cast<double>(size.pixels()));
  }
  return size;
}

TEST(Resolution, MeetsItsGoalOnFastAndSlowMachines) {
  for (const double fixed : {0.0, 5.0, 20.0}) {
    for (const double pixel : {1e-5, 1e-4, 1e-3}) {
      const Size size = settled(fixed, pixel, 50);
      const double ms = fixed + pixel * static_cast<double>(size.pixels());
      const bool whole = size == kWindow, least = 4 * size.width == kWindow.width;
      EXPECT_TRUE(least || ms < 60) << fixed << " " << pixel << " " << ms;
      EXPECT_TRUE(whole || least || ms > 25) << fixed << " " << pixel << " " << ms;
      EXPECT_NEAR(static_cast<double>(size.width) / size.height, 1.6, 0.05);
    }
  }
  EXPECT_EQ(settled(0, 1e-6, 50), kWindow);
  // Never less than a quarter of each side.
  EXPECT_EQ(settled(1000, 1, 50), (Size{320, 200}));
}

TEST(PreviewResolution, ShrinksToAQuarterAndGrowsAgain) {
  PreviewResolution resolution;
  EXPECT_EQ(resolution.part(), 1);
  for (int i = 0; i < 100; ++i) resolution.took(45);
  EXPECT_EQ(resolution.part(), 0.25f);
  EXPECT_FALSE(resolution.too_slow());
  for (int i = 0; i < 200; ++i) resolution.took(2);
  EXPECT_EQ(resolution.part(), 1);
  // It settles where a frame takes long enough, and does not swing.
  std::vector<float> parts;
  for (int i = 0; i < 400; ++i) {
    const float part = resolution.part();
    resolution.took(3 + 30 * static_cast<double>(part * part));
    if (i > 100) parts.push_back(part);
  }
  for (const float part : parts) EXPECT_EQ(part, parts.front());
  for (int i = 0; i < 100; ++i) resolution.took(200);
  EXPECT_TRUE(resolution.too_slow());
}

bool holds(const Box& box, Vec3 p) {
  return p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z && p.x <= box.max.x &&
         p.y <= box.max.y && p.z <= box.max.z;
}

/// A box is left out only if the image shows no point of it, and most boxes outside the view are.
TEST(MayShow, KeepsWhatTheImageShows) {
  std::mt19937 random(5);
  const auto between = [&random](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const auto point = [&](float half) {
    return Vec3{between(-half, half), between(-half, half), between(-half, half)};
  };
  int left_out = 0;
  for (int round = 0; round < 3000; ++round) {
    Camera camera;
    camera.orthographic = round % 3 == 0;
    camera.y_mag = between(0.2f, 2);
    camera.to_world.m[0][3] = between(-2, 2);
    camera.to_world.m[2][3] = between(-2, 3);
    const auto transform = view_projection(camera, between(0.4f, 2.5f), 0.01f, 50);
    const Vec3 a = point(2), size = point(round % 2 == 0 ? 0.2f : 2);
    Box box{a, a};
    box.max = {a.x + std::fabs(size.x), a.y + std::fabs(size.y), a.z + std::fabs(size.z)};
    const bool kept = may_show(transform, box);
    left_out += kept ? 0 : 1;
    for (int i = 0; i < 50 && !kept; ++i) {
      const Vec3 p{between(box.min.x, box.max.x), between(box.min.y, box.max.y),
                   between(box.min.z, box.max.z)};
      const auto row = [&](std::size_t r) {
        return transform[r] * p.x + transform[4 + r] * p.y + transform[8 + r] * p.z +
               transform[12 + r];
      };
      const float w = row(3);
      ASSERT_FALSE(std::fabs(row(0)) < w && std::fabs(row(1)) < w && std::fabs(row(2)) < w);
    }
  }
  EXPECT_GT(left_out, 1000);
}

TEST(PreviewMesh, HoldsEveryTriangleInWorldSpace) {
  for (const char* name : {"cornell", "office"}) {
    const SceneDescription scene = builtin_scene(name);
    const PreviewMesh mesh = preview_mesh(scene);
    EXPECT_EQ(mesh.indices.size(), 3 * scene.triangle_count());
    std::uint32_t counted = 0;
    for (const PreviewDraw& draw : mesh.draws) {
      for (const PreviewGroup& group : draw.groups) {
        EXPECT_EQ(group.first, counted);
        EXPECT_LE(group.count, 3 * kPreviewGroup);
        for (std::uint32_t i = 0; i < group.count; ++i)
          EXPECT_TRUE(holds(group.box, mesh.vertices[mesh.indices[counted + i]].position));
        counted += group.count;
      }
      EXPECT_TRUE(draw.texture == kInvalidId || draw.texture < mesh.textures.size());
    }
    EXPECT_EQ(counted, mesh.indices.size());
    Box box{mesh.vertices[0].position, mesh.vertices[0].position};
    for (const std::uint32_t i : mesh.indices) {
      ASSERT_LT(i, mesh.vertices.size());
      const Vec3 p = mesh.vertices[i].position;
      box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
      box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
    }
    const Box bounds = world_bounds(scene);
    EXPECT_LT(length(box.min - bounds.min) + length(box.max - bounds.max), 1e-3f);
    for (const PreviewTexture& texture : mesh.textures) {
      EXPECT_LE(texture.image.width, kPreviewTextureSide);
      EXPECT_EQ(texture.image.rgba.size(), 4u * texture.image.width * texture.image.height);
    }
  }
}

/// A mirroring transform keeps the front where it is.
TEST(PreviewMesh, TurnsMirroredTriangles) {
  SceneDescription scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  Instance& instance = scene.instances.emplace_back();
  instance.to_world.m[0][0] = -1;
  const PreviewMesh made = preview_mesh(scene);
  const auto corner = [&made](std::size_t i) { return made.vertices[made.indices[i]].position; };
  EXPECT_GT(cross(corner(1) - corner(0), corner(2) - corner(0)).z, 0);
  EXPECT_EQ(made.vertices[0].normal[2], 127);
}

TEST(Layers, HaveABackgroundAndDepths) {
  SceneDescription scene = builtin_scene("cornell");
  scene.cameras.front().to_world.m[2][3] += 20;  // sees past the box
  RenderOptions options;
  options.width = 24;
  options.height = 16;
  options.primary = Primary::kTrace;
  options.samples = 2;
  Backdrop red({255, 0, 0, 255});
  red.watch(&options);
  const RenderResult result = render(scene, options);
  const Image image = layer_image(result, Layer::kBeauty, {}, result.exposure, &red);
  EXPECT_EQ(image.rgba, red.picture(result).rgba);
  const std::vector<float> depths = depths_of(result, scene.cameras.front());
  int seen = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const bool is_seen = result.ids[i].prim_id != kInvalidId;
    EXPECT_EQ(depths[i] > 0, is_seen);
    seen += is_seen ? 1 : 0;
  }
  EXPECT_GT(seen, 0);
  EXPECT_LT(seen, 24 * 16);
}

TEST(FileBrowser, ListsFoldersAndScenes) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "z");
  for (const char* name : {"b.GLB", "a.ply", "c.txt", ".hidden.obj", "seq.json"})
    test::write_file(folder.file(name), "x");
  FileBrowser browser(folder.path().string());
  std::vector<std::string> names;
  for (const FileBrowser::Entry& entry : browser.entries()) names.push_back(entry.name);
  EXPECT_EQ(names, (std::vector<std::string>{"..", "z", "a.ply", "b.GLB", "seq.json"}));
  browser.move(100);
  EXPECT_EQ(browser.selected(), 4u);
  EXPECT_EQ(browser.choose(2), folder.file("a.ply"));
  EXPECT_FALSE(browser.choose(1));
  EXPECT_EQ(browser.folder(), folder.file("z"));
  EXPECT_FALSE(browser.choose(0));
  EXPECT_EQ(browser.entries()[browser.selected()].name, "z");
  EXPECT_FALSE(browser.choose(99));
  // A folder that has gone is reported, and the list stays.
  std::filesystem::remove(folder.path() / "z");
  EXPECT_FALSE(browser.choose(1));
  EXPECT_NE(browser.sentence(), "");
  EXPECT_EQ(browser.folder(), folder.path().string());
  FileBrowser elsewhere("/nowhere/at/all");
  EXPECT_FALSE(elsewhere.entries().empty());
}

TEST(FileWatch, NoticesChangesThatAreOver) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("scene.obj");
  test::write_file(path, "1");
  FileWatch watch;
  EXPECT_FALSE(watch.changed(1));
  watch.watch({path, folder.file("missing.mtl")});
  EXPECT_FALSE(watch.changed(2));
  test::write_file(path, "22");
  EXPECT_FALSE(watch.changed(2.1));  // too soon
  EXPECT_FALSE(watch.changed(3));    // it may still be written
  test::write_file(path, "333");
  EXPECT_FALSE(watch.changed(4));
  EXPECT_TRUE(watch.changed(5));
  EXPECT_FALSE(watch.changed(6));
  std::filesystem::remove(path);
  EXPECT_FALSE(watch.changed(7));
  EXPECT_FALSE(watch.changed(8));
  test::write_file(path, "4444");
  EXPECT_FALSE(watch.changed(9));
  EXPECT_TRUE(watch.changed(10));
}

TEST(Resolution, FallsAtOnceAndRisesInSteps) {
  Resolution resolution;
  resolution.took(kWindow.pixels(), 10);
  Size before = resolution.size_for(kWindow, 50);
  for (int i = 0; i < 20; ++i) {
    resolution.took(before.pixels(), 1e-5 * static_cast<double>(before.pixels()));
    const Size now = resolution.size_for(kWindow, 50);
    EXPECT_LE(now.width, std::ceil(before.width * 1.3));
    before = now;
  }
  resolution.took(before.pixels(), 2000);
  EXPECT_LT(resolution.size_for(kWindow, 50).width, before.width / 2);
}

TEST(Resolution, SurvivesEverySize) {
  Resolution resolution;
  EXPECT_EQ(resolution.size_for({0, 0}, 50), (Size{1, 1}));
  resolution.took(0, 5);
  resolution.took(1, -1);
  resolution.took(1, std::nan(""));
  EXPECT_EQ(resolution.expected_ms(1000), 0);
  EXPECT_EQ(resolution.size_for({3, 2}, 50), (Size{3, 2}));
}

TEST(Latency, CountsAndClasses) {
  Latency latency;
  EXPECT_EQ(latency.percentile(0.5), 0);
  for (int i = 100; i >= 1; --i) latency.add(i);
  EXPECT_EQ(latency.percentile(0.5), 50);
  EXPECT_EQ(latency.percentile(0.99), 99);
  EXPECT_EQ(latency.largest(), 100);
  const std::string text = latency.histogram();
  EXPECT_NE(text.find("100 events, median 50.0 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("60 ms+"), std::string::npos) << text;
}

RenderResult small_result() {
  RenderOptions options;
  options.width = 24;
  options.height = 16;
  options.primary = Primary::kTrace;
  options.count_pixel_tests = true;
  return render(builtin_scene("cornell"), options);
}

TEST(Layers, AreAsLargeAsThePictureAndDiffer) {
  const RenderResult result = small_result();
  const TestScale scale = scale_of({&result.tests});
  std::vector<std::vector<std::uint8_t>> seen;
  for (int layer = 0; layer < 6; ++layer) {
    const Image image = layer_image(result, static_cast<Layer>(layer), scale, 1);
    EXPECT_EQ(image.width, 24u);
    EXPECT_EQ(image.rgba.size(), 24u * 16 * 4);
    for (const auto& other : seen) EXPECT_NE(image.rgba, other) << layer;
    seen.push_back(image.rgba);
  }
}

TEST(Layers, ScaleOfTestsHoldsThemAll) {
  const std::vector<float> few = {0, 5, 40}, many = {0, 3, 40000};
  const TestScale linear = scale_of({&few}), logarithmic = scale_of({&few, &many});
  EXPECT_FALSE(linear.logarithmic);
  EXPECT_EQ(linear.at(40), 1);
  EXPECT_TRUE(logarithmic.logarithmic);
  EXPECT_EQ(logarithmic.at(40000), 1);
  EXPECT_EQ(logarithmic.at(0), 0);
  EXPECT_LT(logarithmic.at(3), logarithmic.at(5));
  EXPECT_EQ(scale_of({}).high, 1);
}

TEST(Picking, NamesWhatThePixelShows) {
  SceneDescription scene = builtin_scene("cornell");
  const SceneFacts facts = facts_of(scene);
  RenderResult result = small_result();
  Picture picture;
  picture.request.camera = scene.cameras.front();
  picture.size = {24, 16};
  picture.ids = result.ids;
  picture.position = result.position;
  for (std::uint32_t x = 0; x < 24; ++x) {
    const auto picked = pick(picture, facts, (static_cast<float>(x) + 0.5f) / 24, 0.5f);
    const PixelIds ids = result.ids[8 * 24 + x];
    ASSERT_EQ(picked.has_value(), ids.prim_id != kInvalidId);
    if (!picked) continue;
    EXPECT_EQ(picked->ids.prim_id, ids.prim_id);
    EXPECT_FALSE(picked->mesh.empty());
    EXPECT_FALSE(picked->material.empty());
    const Vec3 eye = column(scene.cameras.front().to_world, 3);
    EXPECT_NEAR(picked->t, length(result.position[8 * 24 + x] - eye), 1e-4f);
  }
  for (const float outside : {-0.1f, 1.0f, std::nanf("")})
    EXPECT_FALSE(pick(picture, facts, outside, 0.5f));
  EXPECT_FALSE(pick(Picture(), facts, 0.5f, 0.5f));
}

TEST(BundleLines, DrawRaysAndBounds) {
  Laboratory laboratory(builtin_scene("cornell"), 24, 24);
  for (const Method method : {Method::kRah, Method::kGl10, Method::kDual}) {
    const auto bundle = laboratory.bundle(LabRays::kReflection1, method_settings(method), 12, 12);
    ASSERT_TRUE(bundle);
    const std::vector<WorldLine> lines = bundle_lines(*bundle, 10);
    int asked = 0, rays = 0, bounds = 0;
    for (const WorldLine& line : lines) {
      EXPECT_TRUE(is_finite(line.from) && is_finite(line.to));
      asked += line.kind == WorldLine::Kind::kAskedRay ? 1 : 0;
      rays += line.kind == WorldLine::Kind::kRay ? 1 : 0;
      bounds += line.kind == WorldLine::Kind::kHull || line.kind == WorldLine::Kind::kCone ? 1 : 0;
    }
    EXPECT_EQ(asked, 1);
    EXPECT_LT(rays, 64);
    EXPECT_EQ(bounds > 0, !bundle->volumes.empty());
  }
}

}  // namespace
}  // namespace raysheaf::viewer
