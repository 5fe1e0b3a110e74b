// Frames of streamed scenes equal those of the scene in memory, bit for bit.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/stream.h"
#include "support/same_picture.h"
#include "support/scenes.h"

namespace raysheaf::test {
namespace {

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 72;
  options.height = 48;
  options.primary = Primary::kTrace;
  return options;
}

void expect_streamed_as_resident(SceneDescription scene, std::uint32_t triangles_a_block) {
  for (std::size_t m = 0; m < scene.meshes.size(); m += 2)  // every other mesh has colours
    for (const Vec3 p : scene.meshes[m].positions)
      scene.meshes[m].colors.push_back({std::fabs(std::sin(p.x)), std::fabs(std::cos(p.z)), 1});
  add_missing_camera_and_light(scene);
  RenderOptions options = small_picture();
  const RenderResult resident = render(scene, options);
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, triangles_a_block));
  StreamStatistics statistics;
  StreamOptions stream;
  stream.statistics = &statistics;
  options.threads = 2;
  options.count_pixel_tests = true;
  const RenderResult streamed = render(blocks, options, stream);
  expect_same_picture(resident, streamed);
  EXPECT_EQ(streamed.statistics.triangles, scene.triangle_count());
  EXPECT_EQ(statistics.blocks,
            statistics.culled_blocks + statistics.hidden_blocks + statistics.read_blocks);
  EXPECT_GT(statistics.shading_blocks, 0u);
  ASSERT_EQ(resident.statistics.batches.size(), streamed.statistics.batches.size());
  for (std::size_t i = 0; i < resident.statistics.batches.size(); ++i) {
    EXPECT_EQ(resident.statistics.batches[i].rays, streamed.statistics.batches[i].rays);
    EXPECT_EQ(resident.statistics.batches[i].hits, streamed.statistics.batches[i].hits);
  }
}

TEST(StreamedFrame, BuiltinScenesAreTheSame) {
  for (const std::string& name : builtin_scene_names()) {
    SCOPED_TRACE(name);
    const SceneDescription scene = builtin_scene(name);
    for (const std::uint32_t most : {300u, 5000u, kBlockTriangles})
      expect_streamed_as_resident(scene, most);
  }
}

TEST(StreamedFrame, CutOutsAreOpaque) {
  SceneDescription scene = builtin_scene("office");
  scene.materials[0].base_color.w = 0.25f;
  scene.materials[0].alpha_cutoff = 0.5f;
  scene.materials[0].alpha_blend = true;
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, 3000));
  const std::vector<std::string>& warnings = blocks.scene().warnings;
  ASSERT_EQ(warnings.size(), scene.warnings.size() + 1);
  EXPECT_NE(warnings.back().find("alpha"), std::string::npos);
  EXPECT_EQ(blocks.scene().materials[0].alpha_cutoff, 0);
  EXPECT_FALSE(blocks.scene().materials[0].alpha_blend);
  const RenderResult streamed = render(blocks, small_picture());
  scene.materials[0].alpha_cutoff = 0;
  expect_same_picture(render(scene, small_picture()), streamed);
}

TEST(StreamedFrame, AHallMadeInBlocksIsTheSame) {
  RenderOptions options = small_picture();
  BlockList blocks;
  blocks.set_scene(hall_in_blocks(300'000, &blocks, 2));
  expect_same_picture(render(hall_scene(300'000, 2), options), render(blocks, options));
}

TEST(StreamedFrame, AnotherSceneOverTheSameBlocksIsTheSame) {
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(builtin_scene("office"), &blocks, 3000));
  RenderOptions options = small_picture();
  options.samples = 2;
  const auto change = [](SceneDescription* scene) {
    scene->cameras.front().to_world.m[0][3] += 0.3f;
    scene->lights.resize(1);
    scene->lights.front().radius = 0.2f;
    scene->environment.width = 2;
    scene->environment.height = 1;
    scene->environment.radiance = {{0.2f, 0.3f, 0.5f}, {2, 1, 0.5f}};
  };
  SceneDescription whole = builtin_scene("office"), own = blocks.scene();
  change(&whole);
  change(&own);
  const BlocksInScene streamed(blocks, own);
  expect_same_picture(render(whole, options), render(streamed, options));
  const Box a = world_bounds(whole), b = world_bounds(streamed);
  EXPECT_EQ(std::memcmp(&a, &b, sizeof(Box)), 0);
}

TEST(StreamedFrame, ScenesOfOthersAreTheSame) {
  for (const char* name : {"paper/sponza.glb", "paper/office.glb", "bart_kitchen/static.obj"}) {
    SCOPED_TRACE(name);
    const std::filesystem::path path = scenes_directory() / name;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no scene " << path;
    expect_streamed_as_resident(load_scene(path.string()), 4000);
  }
}

/// A scene's blocks that refer to a material that the scene does not have.
class WrongMaterials : public BlockList {
 public:
  void read_shading(std::size_t block, BlockShading* out) const override {
    BlockList::read_shading(block, out);
    out->materials = {777};
  }
};

TEST(StreamedFrame, MaterialsAreTheScenes) {
  WrongMaterials blocks;
  blocks.set_scene(cut_into_blocks(builtin_scene("cornell"), &blocks));
  try {
    static_cast<void>(render(blocks, small_picture()));
    ADD_FAILURE() << "an invalid material index was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
    EXPECT_EQ(error.place(), "block 0");
    EXPECT_NE(error.sentence().find("material 777"), std::string::npos) << error.what();
  }
}

TEST(StreamedFrame, RefusesUnsupportedOptions) {
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(builtin_scene("cornell"), &blocks));
  const auto code = [&](const RenderOptions& options, const StreamOptions& stream = {}) {
    try {
      static_cast<void>(render(blocks, options, stream));
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  RenderOptions options = small_picture();
  options.primary = Primary::kRaster;
  EXPECT_EQ(code(options), ErrorCode::kUnsupported);
  options = small_picture();
  options.method = Method::kCrsh;
  EXPECT_EQ(code(options), ErrorCode::kUnsupported);
  options = small_picture();
  options.camera = "nowhere";
  EXPECT_EQ(code(options), ErrorCode::kNotFound);
  StreamOptions stream;
  stream.memory_bytes = 1 << 20;
  EXPECT_EQ(code(small_picture(), stream), ErrorCode::kOutOfMemory);
}

}  // namespace
}  // namespace raysheaf::test
