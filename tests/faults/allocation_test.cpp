// Each allocation of a load, of changes and of queries fails once: every time there is an Error
// (kOutOfMemory), nothing leaks, and the same scene, or another load, works afterwards.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "api/api_support.h"
#include "faults/allocator.h"
#include "raysheaf/animation.h"
#include "raysheaf/block_file.h"
#include "raysheaf/cameras.h"
#include "raysheaf/io.h"
#include "support/process.h"

namespace raysheaf::test {
namespace {

/// Runs `body` with its first allocation failing, then its second, and so on until it makes no
/// more. After each failure, `afterwards` checks the state. Returns the number of failures.
int fail_each_allocation(const std::function<void()>& body,
                         const std::function<void()>& afterwards) {
  for (int index = 0;; ++index) {
    bool failed = false;
    try {
      const FailingAllocation failing(index);
      body();
      failed = failing.has_failed();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << index << ": " << error.what();
      failed = true;
    } catch (const std::exception& error) {
      ADD_FAILURE() << index << ": not an Error: " << error.what();
      return index;
    }
    if (!failed) return index;
    afterwards();
    if (testing::Test::HasFailure()) {
      ADD_FAILURE() << "when allocation " << index << " had failed";
      return index;
    }
  }
}

std::vector<Vec3> corners(std::uint64_t seed, std::size_t triangles) {
  Random random(seed);
  std::vector<Vec3> all;
  while (all.size() < 3 * triangles) {
    const Vec3 p = random.in_box(10);
    all.insert(all.end(), {p, p + random.in_box(2), p + random.in_box(2)});
  }
  return all;
}

std::vector<Ray> rays(std::uint64_t seed, std::size_t count, bool fan) {
  Random random(seed);
  std::vector<Ray> all;
  const Vec3 origin = random.in_box(12);
  while (all.size() < count)
    all.push_back({fan ? origin : random.in_box(12), 0, random.direction(), kInfinity});
  return all;
}

struct Answers {
  std::vector<Hit> closest;
  std::vector<std::uint8_t> any, fan;
  HitRows all;
  std::vector<std::uint32_t> counts;
};

const std::vector<Ray>& mixed_rays() {
  static const std::vector<Ray> all = rays(3, 300, false);
  return all;
}
const std::vector<Ray>& fan_rays() {
  static const std::vector<Ray> all = rays(4, 2000, true);
  return all;
}

Answers ask(const Scene& scene) {
  return {closest_hit(scene, mixed_rays()), any_hit(scene, mixed_rays()),
          any_hit(scene, fan_rays()), all_hits(scene, mixed_rays()),
          hit_counts(scene, mixed_rays())};
}

void expect_same(const Answers& a, const Answers& b) {
  EXPECT_TRUE(std::equal(a.closest.begin(), a.closest.end(), b.closest.begin(), same));
  EXPECT_EQ(a.any, b.any);
  EXPECT_EQ(a.fan, b.fan);
  EXPECT_EQ(a.all.offsets, b.all.offsets);
  EXPECT_TRUE(std::equal(a.all.hits.begin(), a.all.hits.end(), b.all.hits.begin(), same));
  EXPECT_EQ(a.counts, b.counts);
}

class Faults : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  [[nodiscard]] static Context context() { return Context({.threads = GetParam()}); }
};

TEST_P(Faults, QueriesOfANewScene) {
  const Context shared = context();
  const std::vector<Vec3> a = corners(1, 400), b = corners(2, 700);
  const auto whole = [&] {
    Scene scene(shared);
    scene.add_soup(a);
    scene.add_soup(b, {.transform = {{{{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 1}}}}});
    scene.commit();
    return ask(scene);
  };
  const Answers right = whole();
  std::int64_t before = live_allocations();
  const int failures = fail_each_allocation([&] { static_cast<void>(whole()); },
                                            [&] {
                                              // Threads keep memory that they have allocated.
                                              if (GetParam() == 1) {
                                                EXPECT_EQ(live_allocations(), before);
                                              }
                                            });
  EXPECT_GT(failures, 20);
  expect_same(whole(), right);
}

TEST_P(Faults, TheSameSceneWorksAfterwards) {
  const std::vector<Vec3> a = corners(1, 400), b = corners(2, 700), moved = corners(5, 700);
  Scene scene(context());
  const MeshId first = scene.add_soup(a), second = scene.add_soup(b);
  scene.commit();
  const Answers right = ask(scene);
  scene.update(second, moved);
  scene.commit();
  const Answers right_moved = ask(scene);
  scene.replace_soup(first, b);
  scene.update(second, b);
  scene.commit();
  const Answers right_replaced = ask(scene);
  const auto back = [&] {
    scene.replace_soup(first, a);
    scene.update(second, b);
    scene.commit();
    expect_same(ask(scene), right);
  };
  back();
  const int failures = fail_each_allocation(
      [&] {
        scene.update(second, moved);
        scene.commit();
        expect_same(ask(scene), right_moved);
        scene.replace_soup(first, b);
        scene.update(second, b);
        scene.commit();
        expect_same(ask(scene), right_replaced);
        scene.replace_soup(first, a);
        const InstanceId copy = scene.instance(first, {});
        scene.commit();
        static_cast<void>(ask(scene));
        scene.remove_instance(copy);
        scene.commit();
      },
      [&] {
        for (const InstanceId i : scene.instances(first))
          if (i != scene.instances(first).front()) scene.remove_instance(i);
        back();
      });
  EXPECT_GT(failures, 20);
}

TEST_P(Faults, QueriesSpeakOfTheirRays) {
  Scene scene(context());
  scene.add_soup(corners(1, 400));
  scene.commit();
  const std::vector<Ray>& asked = mixed_rays();
  const auto query = [&] {
    try {
      static_cast<void>(all_hits(scene, asked));
    } catch (const Error& error) {
      EXPECT_EQ(error.place(), "rays") << error.what();
      throw;
    }
  };
  EXPECT_GT(fail_each_allocation(query, [] {}), 3);
}

TEST_P(Faults, OneRayAllocatesNothing) {
  Scene scene(context());
  scene.add_soup(corners(1, 400));
  scene.commit();
  static_cast<void>(closest_hit(scene, mixed_rays()[0]));
  const FailingAllocation first(0);
  for (const Ray& ray : mixed_rays()) {
    static_cast<void>(closest_hit(scene, ray));
    static_cast<void>(any_hit(scene, ray));
  }
  EXPECT_FALSE(first.has_failed());
}

INSTANTIATE_TEST_SUITE_P(Threads, Faults, ::testing::Values(1u, 2u));

/// A loaded scene in numbers: a load that returns despite a failure must be complete.
using Counts = std::array<std::size_t, 5>;

Counts counts_of(const SceneDescription& scene) {
  return {scene.triangle_count(), scene.meshes.size(), scene.materials.size(), scene.images.size(),
          scene.warnings.size()};
}

Counts load_and_pose(const std::string& path) {
  const std::unique_ptr<Animation> animation = load_animation(path);
  const double time = animation->end() / 3;
  try {
    animation->seek(time);
  } catch (const Error&) {
    // If a `seek` fails, the next one reports all of its changes.
    EXPECT_TRUE(animation->seek(time).everything);
    EXPECT_FALSE(animation->seek(0).everything);
    throw;
  }
  return counts_of(animation->scene());
}

Counts load_blocks(const std::string& path) {
  const BlockFile file(path);
  TriangleBlock block;
  BlockShading shading;
  for (std::size_t i = 0; i < file.blocks().size(); ++i) {
    file.read(i, &block);
    file.read_shading(i, &shading);
  }
  return counts_of(file.scene());
}

Counts load_keys(const std::string& path) {
  return {load_camera_path(path).keys.size()};
}

void expect_errors(Counts (*load)(const std::string& path), const std::string& path) {
  const Counts right = load(path);
  load(path);
  const std::function<void()> body = [&] { ASSERT_EQ(load(path), right); };
  const std::int64_t before = live_allocations();
  const int failures = fail_each_allocation(body, [&] { EXPECT_EQ(live_allocations(), before); });
  EXPECT_GT(failures, 3);
}

class LoadFaults : public ::testing::TestWithParam<const char*> {};

TEST_P(LoadFaults, EveryAllocation) {
  const std::string path = std::string(RAYSHEAF_SOURCE_DIR) + "/tests/fuzz/seeds/" + GetParam();
  if (path.ends_with(".rsb")) return expect_errors(load_blocks, path);
  expect_errors([](const std::string& p) { return counts_of(load_scene(p)); }, path);
  expect_errors(load_and_pose, path);
}

INSTANTIATE_TEST_SUITE_P(Files, LoadFaults,
                         ::testing::Values("obj/square.obj", "obj/polygon.obj", "ply/ascii.ply",
                                           "ply/big.ply", "stl/ascii.stl", "stl/binary.stl",
                                           "gltf/small.gltf", "gltf/scene.gltf", "gltf/scene.glb",
                                           "gltf/moving.gltf", "blocks/tetrahedron.rsb",
                                           "blocks/two_blocks.rsb"));

TEST(LoadFaults, EveryAllocationOfASequence) {
  const TemporaryFolder folder;
  for (const char* name : {"a.obj", "b.obj"}) {
    std::filesystem::copy_file(
        std::string(RAYSHEAF_SOURCE_DIR) + "/tests/fuzz/seeds/obj/square.obj", folder.file(name));
  }
  write_file(folder.file("scene.json"),
             R"({"name":"two","frames":[{"file":"a.obj","time":0},{"file":"b.obj","time":3}],)"
             R"("lights":[{"position":[0,1,0],"color":[1,1,1]}],)"
             R"("camera_default":{"eye":[0,0,9],"target":[0,0,0],"hither":0.1}})");
  expect_errors(load_and_pose, folder.file("scene.json"));
}

TEST(LoadFaults, EveryAllocationOfACameraPath) {
  const TemporaryFolder folder;
  write_file(folder.file("path.json"),
             R"({"smooth":false,"keys":[{"time":0,"position":[0,0,9],"look_at":[0,0,0],"fov":40},)"
             R"({"time":1,"position":[0,1,9],"look_at":[0,0,0],"up":[0,1,0]}]})");
  expect_errors(load_keys, folder.file("path.json"));
}

/// After any failure, the file has its old or its complete new contents.
TEST(SaveFaults, EveryAllocation) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.glb");
  const SceneDescription scene =
      load_scene(std::string(RAYSHEAF_SOURCE_DIR) + "/tests/fuzz/seeds/gltf/scene.glb");
  save_glb(scene, path);
  const Counts right = counts_of(load_scene(path));
  std::int64_t before = 0;
  const std::function<void()> afterwards = [&] {
    EXPECT_EQ(live_allocations(), before);
    EXPECT_EQ(counts_of(load_scene(path)), right);
    EXPECT_EQ(folder.names().size(), 1u);
  };
  before = live_allocations();
  const int failures = fail_each_allocation([&] { save_glb(scene, path); }, afterwards);
  EXPECT_GT(failures, 20);
}

template <class T>
std::string raw(std::initializer_list<T> numbers) {
  return {reinterpret_cast<const char*>(numbers.begin()), numbers.size() * sizeof(T)};
}

/// Scenes that are packed without being held in memory.
void expect_errors_of_packing(const std::string& file, const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder.file(file);
  write_file(path, bytes);
  const PackOptions options{
      .triangles_a_block = 1, .triangles_at_once = 1, .beside = folder.file("a.rsb")};
  const std::uint64_t right = load_scene(path).triangle_count();
  ASSERT_GT(right, 2u);
  const std::function<void()> pack = [&] {
    BlockList blocks;
    ASSERT_TRUE(pack_file(path, &blocks, options).has_value());
    ASSERT_EQ(blocks.blocks().size(), right);
  };
  pack();
  const std::int64_t before = live_allocations();
  const int failures = fail_each_allocation(pack, [&] {
    EXPECT_EQ(live_allocations(), before);
    EXPECT_EQ(folder.names().size(), 1u);
  });
  EXPECT_GT(failures, 50);
}

TEST(PackFaults, EveryAllocationOfPly) {
  expect_errors_of_packing(
      "a.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\n"
      "property float y\nproperty float z\nelement face 2\n"
      "property list uchar uchar vertex_indices\nelement nothing 1\nproperty uchar "
      "x\nend_header\n" +
          raw<float>({0, 0, 0, 2, 0, 0, 3, 1, 0, 1, 3, 0, -1, 1, 0}) +
          raw<std::uint8_t>({5, 0, 1, 2, 3, 4, 3, 0, 2, 1, 0}));
}

TEST(PackFaults, EveryAllocationOfStl) {
  std::string bytes(80, ' ');
  bytes += raw<std::uint32_t>({3});
  for (const float x : {0.0f, 2.0f, 5.0f})
    bytes += raw<float>({0, 0, 1, x, 0, 0, x, 1, 0, 0, x, 3}) + raw<std::uint16_t>({0});
  expect_errors_of_packing("a.stl", bytes);
}

TEST(PackFaults, EveryAllocationOfGlb) {
  const TemporaryFolder folder;
  SceneDescription scene;
  scene.materials.resize(2);
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}};
  mesh.normals.assign(4, {0, 0, 0});
  mesh.uvs.assign(4, {0.5f, 0.25f});
  mesh.colors.assign(4, {0.5f, 0.25f, 1});
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {3, 1, 0}};
  mesh.materials = {0, 1, 1};
  scene.meshes.push_back(mesh);
  scene.meshes[1].normals.clear();
  for (const std::uint32_t m : {1u, 0u, 1u}) scene.instances.push_back({"", m, {}});
  save_glb(scene, folder.file("a.glb"));
  expect_errors_of_packing("a.glb", read_file(folder.file("a.glb")));
}

TEST(SaveFaults, EveryAllocationOfBlocks) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.rsb");
  const BlockFile source(std::string(RAYSHEAF_SOURCE_DIR) +
                         "/tests/fuzz/seeds/blocks/two_blocks.rsb");
  TriangleBlock block;
  BlockShading shading;
  source.read(0, &block);
  source.read_shading(0, &shading);
  const std::function<void()> write = [&] {
    BlockFileWriter writer(path);
    writer.add(block, shading);
    writer.finish(source.scene());
  };
  write();
  const std::int64_t before = live_allocations();
  const int failures = fail_each_allocation(write, [&] {
    EXPECT_EQ(live_allocations(), before);
    EXPECT_EQ(BlockFile(path).triangle_count(), 1u);
  });
  EXPECT_GT(failures, 20);
}

/// After very many updates and queries a scene uses as much memory as after a few.
TEST(Growth, NoneOverManyFrames) {
  const std::vector<Vec3> a = corners(1, 50), b = corners(2, 50);
  const std::vector<Ray> few = rays(6, 40, false);
  Scene scene(Context({.threads = 1}));
  const MeshId mesh = scene.add_soup(a);
  std::vector<Hit> hits(few.size());
  std::int64_t allocations = 0;
  std::size_t bytes = 0;
  for (int frame = 0; frame < 10000; ++frame) {
    if (frame % 7 == 3)
      scene.replace_soup(mesh, frame % 2 == 0 ? a : b);
    else
      scene.update(mesh, frame % 2 == 0 ? a : b);
    const InstanceId copy = scene.instance(mesh, {});
    scene.commit();
    closest_hit(scene, few, hits);
    scene.remove_instance(copy);
    scene.commit();
    closest_hit(scene, few, hits);
    if (frame == 100) allocations = live_allocations(), bytes = scene.memory_bytes();
  }
  EXPECT_LE(live_allocations(), allocations + 2);
  EXPECT_LE(scene.memory_bytes(), bytes + 4096);
}

}  // namespace
}  // namespace raysheaf::test
