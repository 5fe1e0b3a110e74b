// Every allocation of a load, of changes and of queries fails once: an Error (kOutOfMemory) each
// time, nothing leaks, and the same scene, or another load, works afterwards.
#include <gtest/gtest.h>

#include <functional>

#include "api/api_support.h"
#include "faults/allocator.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"
#include "support/process.h"

namespace raysheaf::test {
namespace {

/// Runs `body` with its first allocation failing, its second, and so on until it has no more of
/// them. After each failure, `afterwards` looks whether all is well. Gives the number of failures.
int fail_each_allocation(const std::function<void()>& body, const std::function<void()>& afterwards,
                         std::size_t least_bytes = 0) {
  for (int index = 0;; ++index) {
    bool failed = false;
    try {
      const FailingAllocation failing(index, least_bytes);
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
                                              // Threads keep what they once took.
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

INSTANTIATE_TEST_SUITE_P(Threads, Faults, ::testing::Values(1u, 2u));

class LoadFaults : public ::testing::TestWithParam<const char*> {};

TEST_P(LoadFaults, EveryAllocation) {
  const std::string path = std::string(RAYSHEAF_SOURCE_DIR) + "/tests/fuzz/seeds/" + GetParam();
  const SceneDescription right = load_scene(path);
  static_cast<void>(load_scene(path));
  const std::int64_t before = live_allocations();
  const int failures = fail_each_allocation(
      [&] {
        // What comes back although something failed must be whole.
        const SceneDescription scene = load_scene(path);
        ASSERT_EQ(scene.triangle_count(), right.triangle_count());
        ASSERT_EQ(scene.meshes.size(), right.meshes.size());
        ASSERT_EQ(scene.materials.size(), right.materials.size());
        ASSERT_EQ(scene.images.size(), right.images.size());
      },
      [&] { EXPECT_EQ(live_allocations(), before); });
  EXPECT_GT(failures, 3);
}

INSTANTIATE_TEST_SUITE_P(Files, LoadFaults,
                         ::testing::Values("obj/square.obj", "obj/polygon.obj", "ply/ascii.ply",
                                           "ply/big.ply", "stl/ascii.stl", "stl/binary.stl"));

/// nlohmann-json allocates in destructors: where a small allocation fails there, the program ends.
/// Those of data are not among them.
TEST(LoadFaults, LargeAllocationsOfGltf) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cornell.glb");
  const SceneDescription right = builtin_scene("cornell");
  save_glb(right, path);
  static_cast<void>(load_scene(path));
  const std::int64_t before = live_allocations();
  const int failures = fail_each_allocation(
      [&] { ASSERT_EQ(load_scene(path).triangle_count(), right.triangle_count()); },
      [&] { EXPECT_EQ(live_allocations(), before); }, 4096);
  EXPECT_GT(failures, 10);
}

/// Memory that a scene holds after very many updates and queries is what it held after a few.
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
