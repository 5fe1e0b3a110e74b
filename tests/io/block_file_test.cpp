// Block files: written files read back the same, and any change is detected.
#include "raysheaf/block_file.h"

#include <fcntl.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <optional>

#include "io/block_format.h"
#include "io_support.h"
#include "raysheaf/builtin_scenes.h"
#include "support/random.h"

namespace raysheaf::test {
namespace {

/// A block with all optional parts.
TriangleBlock some_block(Random& random, std::uint32_t vertices, std::uint32_t triangles) {
  TriangleBlock block;
  for (std::uint32_t i = 0; i < vertices; ++i) block.positions.push_back(random.in_box(7));
  std::uint32_t id = 0;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    if (i % 50 == 0) {
      block.parts.push_back({i / 100, i / 50, i, 0});
      id = random.below(1000);
    }
    ++block.parts.back().count;
    block.triangles.push_back(
        {random.below(vertices), random.below(vertices), random.below(vertices)});
    block.prim_ids.push_back(id);
    id += 1 + (random.below(3) == 0 ? random.below(5) : 0);
    block.sides.push_back(static_cast<std::uint8_t>(random.below(4)));
  }
  if (random.below(2) == 0) block.sides.resize(random.below(2));
  return block;
}

BlockShading shading_of(const TriangleBlock& block, Random& random) {
  BlockShading shading;
  const bool normals = random.below(3) != 0, uvs = random.below(3) != 0;
  const bool colors = random.below(2) != 0;
  for (std::size_t i = 0; i < block.positions.size(); ++i) {
    if (normals) shading.normals.push_back(random.in_box(1));
    if (uvs) shading.uvs.push_back({random.between(0, 1), random.between(-4, 4)});
    if (colors) shading.colors.push_back({random.unit(), 0, random.unit()});
  }
  for (std::size_t i = 0; i < block.triangles.size(); ++i)
    shading.materials.push_back(random.below(3));
  if (random.below(2) == 0) shading.materials.resize(1);
  for (std::size_t i = 0; i < block.parts.size(); ++i) {
    shading.has_normals.push_back(normals && random.below(2) == 0 ? 1 : 0);
    shading.has_uvs.push_back(uvs && random.below(2) == 0 ? 1 : 0);
    if (colors) shading.has_colors.push_back(random.below(2) == 0 ? 1 : 0);
  }
  return shading;
}

void expect_same(const TriangleBlock& a, const TriangleBlock& b) {
  EXPECT_EQ(io::encode_geometry(a), io::encode_geometry(b));
  EXPECT_EQ(a.prim_ids, b.prim_ids);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.sides, b.sides);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  EXPECT_EQ(std::memcmp(a.positions.data(), b.positions.data(), 12 * a.positions.size()), 0);
}

void expect_same(const BlockShading& a, const BlockShading& b) {
  EXPECT_EQ(io::encode_shading(a), io::encode_shading(b));
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.has_normals, b.has_normals);
  EXPECT_EQ(a.has_uvs, b.has_uvs);
  EXPECT_EQ(a.has_colors, b.has_colors);
  EXPECT_EQ(a.colors.size(), b.colors.size());
}

/// A scene with everything that it may have in addition to triangles.
SceneDescription furnished() {
  SceneDescription scene = builtin_scene("office");
  for (Mesh& mesh : scene.meshes) {
    const std::string name = mesh.name;
    mesh = {};
    mesh.name = name;
  }
  scene.name = "with \"quotes\" and a line\nfeed";
  scene.lights[0].range = 12.1f;
  scene.instances[0].to_world.m[0][3] = 0.1f;
  scene.images.push_back({"a picture", 2, 1, {1, 2, 3, 255, 4, 5, 6, 7}});
  scene.textures.push_back(
      {static_cast<std::uint32_t>(scene.images.size() - 1), Wrap::kClampToEdge});
  scene.materials[0].base_color_texture = {
      static_cast<std::uint32_t>(scene.textures.size() - 1), {0.3f, 0.7f}, {2, 3}, 0.1f};
  scene.materials[1].normal_texture = scene.materials[0].base_color_texture;
  scene.materials[1].normal_scale = 0.1f;
  scene.materials[2].thin = true;
  return scene;
}

class BlockFileTest : public IoTest {
 protected:
  /// Writes a file of a few blocks.
  void write_blocks(const std::string& name, bool compress, std::uint32_t triangles = 60) {
    Random random(3);
    BlockFileWriter file(path(name), {compress});
    for (int i = 0; i < 3; ++i) {
      const TriangleBlock block =
          some_block(random, 20 + 5 * static_cast<std::uint32_t>(i), triangles);
      file.add(block, shading_of(block, random));
    }
    SceneDescription scene;
    scene.meshes.resize(1);
    scene.materials.resize(3);
    scene.cameras.emplace_back();
    file.finish(scene);
  }
};

/// Opens a file and reads every block of it. Returns the error, if any.
std::optional<Error> error_of_reading(const std::string& path) {
  try {
    const BlockFile file(path);
    TriangleBlock block;
    BlockShading shading;
    for (std::size_t i = 0; i < file.blocks().size(); ++i) {
      file.read(i, &block);
      file.read_shading(i, &shading);
    }
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

TEST_F(BlockFileTest, MaterialsAreTheScenes) {
  Random random(5);
  const TriangleBlock block = some_block(random, 20, 10);
  BlockShading shading = shading_of(block, random);
  shading.materials = {2};
  SceneDescription scene;
  scene.meshes.resize(1);
  scene.materials.resize(2);
  BlockFileWriter file(path("a.rsb"));
  file.add(block, shading);
  try {
    file.finish(scene);
    ADD_FAILURE() << "an invalid material index was written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
    EXPECT_EQ(error.sentence(), "a block names material 2, but the scene has 2");
  }
}

TEST_F(BlockFileTest, WhatIsWrittenIsRead) {
  for (const bool compress : {false, true}) {
    if (compress && !can_compress_blocks()) continue;
    Random random(11);
    std::vector<TriangleBlock> blocks;
    std::vector<BlockShading> shading;
    for (const std::uint32_t triangles : {1u, 2u, 300u, 7000u, kBlockTriangles}) {
      const std::uint32_t vertices = std::min(3 * triangles, kBlockVertices);
      blocks.push_back(some_block(random, vertices, triangles));
      shading.push_back(shading_of(blocks.back(), random));
    }
    const SceneDescription scene = furnished();
    BlockFileWriter writer(path("a.rsb"), {compress});
    for (std::size_t i = 0; i < blocks.size(); ++i) writer.add(blocks[i], shading[i]);
    writer.finish(scene);
    EXPECT_EQ(file_count(), 1u);

    const BlockFile file(path("a.rsb"));
    EXPECT_EQ(file.file_bytes(), read("a.rsb").size());
    EXPECT_EQ(file.compressed(), compress);
    EXPECT_EQ(file.triangle_count(), writer.triangle_count());
    EXPECT_EQ(io::encode_scene(file.scene()), io::encode_scene(scene));
    EXPECT_EQ(file.scene().images.back().rgba, scene.images.back().rgba);
    EXPECT_EQ(file.scene().lights[0].range, 12.1f);
    ASSERT_EQ(file.blocks().size(), blocks.size());
    for (std::size_t i = blocks.size(); i-- > 0;) {
      TriangleBlock block;
      BlockShading look;
      file.read(i, &block);
      file.read_shading(i, &look);
      expect_same(blocks[i], block);
      expect_same(shading[i], look);
      EXPECT_EQ(file.blocks()[i].triangles, blocks[i].triangles.size());
    }
  }
}

TEST_F(BlockFileTest, EveryChangedByteIsNoticed) {
  for (const bool compress : {false, true}) {
    if (compress && !can_compress_blocks()) continue;
    write_blocks("a.rsb", compress);
    const std::string good = read("a.rsb");
    ASSERT_FALSE(error_of_reading(path("a.rsb")));
    Random random(5);
    for (std::size_t i = 0; i < good.size(); i += 1 + random.below(60)) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ (1 << random.below(8)));
      const auto error = error_of_reading(write("bad.rsb", bad));
      ASSERT_TRUE(error) << "byte " << i;
      EXPECT_TRUE(error->place().starts_with(path("bad.rsb"))) << error->what();
    }
  }
}

TEST_F(BlockFileTest, AFileThatEndsTooEarlyIsRefused) {
  write_blocks("a.rsb", false);
  const std::string good = read("a.rsb");
  for (std::size_t size = 0; size < good.size(); size += 1 + size / 40) {
    const auto error = error_of_reading(write("bad.rsb", good.substr(0, size)));
    ASSERT_TRUE(error) << size;
    EXPECT_EQ(error->code(), ErrorCode::kInvalidData);
  }
  EXPECT_TRUE(error_of_reading(write("bad.rsb", good + "x")));
}

TEST_F(BlockFileTest, ErrorsNameTheBlock) {
  write_blocks("a.rsb", false);
  const BlockFile file(path("a.rsb"));
  TriangleBlock block;
  std::filesystem::resize_file(path("a.rsb"), 3000);
  file.read(0, &block);
  try {
    file.read(2, &block);
    FAIL() << "the block does not exist";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kIo);
    EXPECT_EQ(error.place(), path("a.rsb") + ": block 2");
    EXPECT_EQ(error.sentence(), "the file became shorter while it was read");
  }
}

/// A file as another version may write it: its checksums are right.
TEST_F(BlockFileTest, ErrorsOfTheSceneNameTheFile) {
  {
    BlockFileWriter file(path("a.rsb"));
    file.finish(cut_into_blocks(builtin_scene("cornell"), &file));
  }
  std::string text = read("a.rsb");
  io::FileHead head;
  std::memcpy(&head, text.data(), sizeof head);
  const std::string light = R"("type":")";
  const std::size_t at = text.find(light, head.scene_offset);
  ASSERT_NE(at, text.npos);
  text[at + light.size()] = 'X';
  const auto scene = io::as_bytes(text).subspan(head.scene_offset, head.scene_bytes);
  head.scene_checksum = io::checksum(scene);
  head.head_checksum =
      io::checksum(io::bytes_of(head).first(sizeof head - sizeof head.head_checksum));
  std::memcpy(text.data(), &head, sizeof head);
  const auto error = error_of_reading(write("b.rsb", text));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kInvalidData);
  EXPECT_EQ(error->place(), path("b.rsb"));
}

TEST_F(BlockFileTest, OtherFilesAreRefused) {
  EXPECT_EQ(error_of_reading(path("none.rsb"))->code(), ErrorCode::kNotFound);
  EXPECT_EQ(error_of_reading(folder_.string())->code(), ErrorCode::kIo);
  EXPECT_EQ(error_of_reading(write("b.rsb", std::string(500, 'x')))->code(),
            ErrorCode::kInvalidData);
  write_blocks("a.rsb", false);
  std::string newer = read("a.rsb");
  newer[8] = 2;
  EXPECT_EQ(error_of_reading(write("c.rsb", newer))->code(), ErrorCode::kUnsupported);
  std::string turned = read("a.rsb");
  std::reverse(turned.begin() + 12, turned.begin() + 16);
  EXPECT_NE(error_of_reading(write("d.rsb", turned))->sentence().find("byte order"),
            std::string::npos);
}

TEST_F(BlockFileTest, NothingIsLeftHalfWritten) {
  write("old.rsb", "old");
  {
    Random random(1);
    BlockFileWriter file(path("old.rsb"));
    const TriangleBlock block = some_block(random, 9, 4);
    file.add(block, shading_of(block, random));
    TriangleBlock wrong = block;
    wrong.triangles[3][0] = 9;
    EXPECT_THROW(file.add(wrong, shading_of(wrong, random)), Error);
  }
  EXPECT_EQ(file_count(), 1u);
  EXPECT_EQ(read("old.rsb"), "old");
  EXPECT_THROW(BlockFileWriter(path("no/such/folder.rsb")), Error);
}

TEST_F(BlockFileTest, HasNoNameBeforeItIsWhole) {
  const int nameless = ::open(path("").c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (nameless < 0) GTEST_SKIP() << "this file system has no files without a name";
  ::close(nameless);
  Random random(1);
  BlockFileWriter file(path("a.rsb"));
  const TriangleBlock block = some_block(random, 9, 4);
  file.add(block, shading_of(block, random));
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(BlockFileTest, AFullDiskIsReported) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{20000, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::optional<Error> found;
  try {
    write_blocks("a.rsb", false, 4000);
  } catch (const Error& error) {
    found = error;
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, before);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->code(), ErrorCode::kIo);
  EXPECT_EQ(found->place(), path("a.rsb"));
  EXPECT_EQ(file_count(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
