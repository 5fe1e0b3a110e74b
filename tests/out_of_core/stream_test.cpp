// Streamed answers equal those in memory, whatever the blocks, their order and their number.
#include "raysheaf/stream.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <system_error>
#include <thread>

#include "base/vec.h"
#include "out_of_core/stream_support.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/render.h"
#include "support/random.h"
#include "support/soups.h"

namespace raysheaf::test {
namespace {

/// Adds several instances of each mesh, rotated and mirrored.
SceneDescription with_instances(SceneDescription scene, Random& random) {
  const auto meshes = static_cast<std::uint32_t>(scene.meshes.size());
  for (std::uint32_t i = 0; i < meshes; ++i) {
    Instance more;
    more.mesh = random.below(meshes);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c)
        more.to_world.m[r][c] = (r == c ? 1.0f : 0.0f) * (random.below(2) == 0 ? 1.0f : -1.0f) +
                                random.between(-0.2f, 0.2f);
    }
    scene.instances.insert(scene.instances.begin() +
                               random.below(static_cast<std::uint32_t>(scene.instances.size() + 1)),
                           more);
  }
  return scene;
}

/// The blocks of another source in a random order.
class Shuffled : public GeometrySource {
 public:
  Shuffled(const GeometrySource& of, Random& random) : of_(of), order_(of.blocks().size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (std::size_t i = order_.size(); i > 1; --i)
      std::swap(order_[i - 1], order_[random.below(static_cast<std::uint32_t>(i))]);
    for (const std::size_t i : order_) infos_.push_back(of.blocks()[i]);
  }
  [[nodiscard]] std::span<const BlockInfo> blocks() const override { return infos_; }
  void read(std::size_t block, TriangleBlock* out) const override { of_.read(order_[block], out); }
  void read_shading(std::size_t block, BlockShading* out) const override {
    of_.read_shading(order_[block], out);
  }
  [[nodiscard]] const SceneDescription& scene() const override { return of_.scene(); }

 private:
  const GeometrySource& of_;
  std::vector<std::size_t> order_;
  std::vector<BlockInfo> infos_;
};

bool same_bits(const std::vector<Hit>& a, const std::vector<Hit>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Hit)) == 0;
}

TEST(Stream, AnswersAreThoseInMemory) {
  for (const SoupKind kind : soup_kinds()) {
    Random random(static_cast<std::uint64_t>(kind) + 17);
    for (const std::uint32_t size : {1u, 40u, 700u}) {
      const SceneDescription scene = with_instances(soup(kind, size, size), random);
      const Scene memory = resident(scene);
      const std::vector<Ray> rays = rays_at(scene, 600, size + 3);
      const std::vector<Hit> expected = closest_hit(memory, rays);
      const std::vector<std::uint8_t> blocked = any_hit(memory, rays);
      for (const std::uint32_t most : {1u, 7u, 100u, kBlockTriangles}) {
        if (size / most > 200) continue;
        SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(kind) << ", " << size
                                        << " triangles, " << most << " a block");
        BlockList blocks;
        blocks.set_scene(cut_into_blocks(scene, &blocks, most));
        const Shuffled shuffled(blocks, random);
        for (const bool front_to_back : {true, false}) {
          StreamOptions options;
          options.threads = 1 + random.below(3);
          options.front_to_back = front_to_back;
          options.memory_bytes = std::uint64_t{64 + random.below(500)} << 20;
          std::vector<Hit> hits(rays.size());
          closest_hit(shuffled, rays, hits, options);
          EXPECT_TRUE(same_bits(hits, expected));
          std::vector<std::uint8_t> occluded(rays.size());
          any_hit(shuffled, rays, occluded, options);
          EXPECT_EQ(occluded, blocked);
        }
      }
    }
  }
}

TEST(Stream, PartsCombine) {
  const SceneDescription scene = builtin_scene("cornell");
  const Scene memory = resident(scene);
  const std::vector<Ray> rays = rays_at(scene, 3000, 5);
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, 40));
  Gathered all;
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  StreamStatistics statistics;
  for (std::uint32_t part = 0; part < 3; ++part) {
    StreamOptions options;
    options.part = part;
    options.parts = 3;
    options.exchange = &all;
    options.statistics = &statistics;
    closest_hit(blocks, rays, hits, options);
    any_hit(blocks, rays, occluded, options);
  }
  EXPECT_TRUE(same_bits(hits, closest_hit(memory, rays)));
  EXPECT_EQ(occluded, any_hit(memory, rays));
  EXPECT_EQ(statistics.blocks, 2 * blocks.blocks().size());
  EXPECT_EQ(statistics.blocks,
            statistics.culled_blocks + statistics.hidden_blocks + statistics.read_blocks);
}

TEST(Stream, BlocksThatNoRayMeetsAreNotRead) {
  const SceneDescription hall = hall_scene(60000, 1);
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(hall, &blocks, 1000));
  // A thin bundle along the hall, and rays from behind a wall of hits.
  std::vector<Ray> rays;
  for (int i = 0; i < 400; ++i)
    rays.push_back(
        {{-18, 2, 0},
         0,
         {1, 0.0001f * static_cast<float>(i % 20), 0.0002f * static_cast<float>(i) / 20}});
  const auto counts = [&](bool front_to_back, std::uint32_t threads) {
    StreamStatistics statistics;
    StreamOptions options;
    options.statistics = &statistics;
    options.front_to_back = front_to_back;
    options.threads = threads;
    options.memory_bytes = 64 << 20;
    std::vector<Hit> hits(rays.size());
    closest_hit(blocks, rays, hits, options);
    EXPECT_TRUE(same_bits(hits, closest_hit(resident(hall), rays)));
    return statistics;
  };
  const StreamStatistics ordered = counts(true, 1), any_order = counts(false, 1);
  EXPECT_EQ(ordered.culled_blocks, any_order.culled_blocks);
  EXPECT_GT(ordered.culled_blocks, ordered.blocks / 2);
  EXPECT_LE(ordered.read_blocks, any_order.read_blocks);
  EXPECT_LT(ordered.read_blocks, 10u);
  const StreamStatistics again = counts(true, 2);
  EXPECT_EQ(again.read_blocks, ordered.read_blocks);
  EXPECT_EQ(again.read_bytes, ordered.read_bytes);
  EXPECT_EQ(again.hidden_blocks, ordered.hidden_blocks);
}

TEST(Stream, AHallInBlocksIsTheHall) {
  for (const std::uint64_t size : {4000u, 41000u, 700000u}) {
    SCOPED_TRACE(size);
    const SceneDescription hall = hall_scene(size, 2);
    BlockList blocks;
    blocks.set_scene(hall_in_blocks(size, &blocks, 2));
    ASSERT_EQ(blocks.scene().meshes.size(), hall.meshes.size());
    EXPECT_EQ(blocks.scene().cameras.size(), 1u);
    std::vector<std::vector<int>> seen(hall.meshes.size());
    for (std::size_t m = 0; m < seen.size(); ++m) seen[m].resize(hall.meshes[m].triangles.size());
    TriangleBlock block;
    BlockShading shading;
    std::uint64_t differing = 0, total = 0;
    for (std::size_t b = 0; b < blocks.blocks().size(); ++b) {
      blocks.read(b, &block);
      blocks.read_shading(b, &shading);
      const Mesh& mesh = hall.meshes[block.parts[0].geom_id];
      total += block.triangles.size();
      for (std::size_t t = 0; t < block.triangles.size(); ++t) {
        ASSERT_LT(block.prim_ids[t], mesh.triangles.size());
        ++seen[block.parts[0].geom_id][block.prim_ids[t]];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t here = block.triangles[t][k];
          const std::uint32_t there = mesh.triangles[block.prim_ids[t]][k];
          const bool same = block.positions[here] == mesh.positions[there] &&
                            shading.normals[here] == mesh.normals[there];
          differing += same ? 0 : 1;
        }
      }
    }
    EXPECT_EQ(differing, 0u);
    EXPECT_EQ(total, hall.triangle_count());
    for (const std::vector<int>& mesh : seen)
      EXPECT_EQ(std::count(mesh.begin(), mesh.end(), 1), static_cast<std::ptrdiff_t>(mesh.size()));
  }
}

// --- sources with errors

template <class Call>
Error error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorCode::kInternal, "nothing was thrown"};
}

/// A source with one triangle, which a test changes.
class Wrong : public BlockList {
 public:
  Wrong() {
    block.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    block.triangles = {{0, 1, 2}};
    block.prim_ids = {0};
    block.parts = {{0, 0, 0, 1}};
    BlockShading shading;
    shading.has_normals = shading.has_uvs = {0};
    add(block, shading);
  }
  void read(std::size_t /*block*/, TriangleBlock* out) const override { *out = block; }
  [[nodiscard]] std::string place(std::size_t number) const override {
    return "wrong: block " + std::to_string(number);
  }
  TriangleBlock block;
};

TEST(Stream, BlocksAreValidated) {
  const auto ask = [](const auto& change) {
    Wrong source;
    change(source.block);
    const std::vector<Ray> rays{{{0.2f, 0.2f, 1}, 0, {0, 0, -1}}};
    std::vector<Hit> hits(1);
    const Error error = error_of([&] { closest_hit(source, rays, hits); });
    EXPECT_EQ(error.place(), "wrong: block 0");
    EXPECT_EQ(error.code(), ErrorCode::kInvalidData) << error.what();
    return error.sentence();
  };
  EXPECT_NE(ask([](auto& b) { b.triangles[0][1] = 3; }).find("triangles[0]"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.positions[2].y = NAN; }).find("positions[2]"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.positions[2].y = 2; }).find("bounds"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.parts[0].count = 2; }).find("parts[0]"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.parts.clear(); }).find("parts"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.prim_ids.clear(); }).find("prim_ids"), std::string::npos);
  EXPECT_NE(ask([](auto& b) { b.triangles.clear(); }).find("triangles"), std::string::npos);
  EXPECT_NE(ask([](auto& b) {
              b.triangles.push_back({0, 1, 2});
              b.prim_ids.push_back(0);
              b.parts[0].count = 2;
            }).find("prim_ids[1]"),
            std::string::npos);
}

/// A source whose block has empty bounds.
class Nowhere : public Wrong {
 public:
  Nowhere() : infos_(Wrong::blocks().begin(), Wrong::blocks().end()) { infos_[0].bounds = {}; }
  [[nodiscard]] std::span<const BlockInfo> blocks() const override { return infos_; }

 private:
  std::vector<BlockInfo> infos_;
};

TEST(Stream, BoundsAreValidated) {
  const Nowhere source;
  const std::vector<Ray> rays{{{0.2f, 0.2f, 1}, 0, {0, 0, -1}}};
  std::vector<Hit> hits(1);
  const Error error = error_of([&] { closest_hit(source, rays, hits); });
  EXPECT_EQ(error.code(), ErrorCode::kInvalidData) << error.what();
  EXPECT_EQ(error.place(), "wrong: block 0");
}

TEST(Stream, QueriesAreValidated) {
  const Wrong source;
  const std::vector<Ray> rays{{{0.2f, 0.2f, 1}, 0, {0, 0, -1}}};
  std::vector<Hit> hits(1);
  StreamOptions options;
  options.memory_bytes = 1 << 20;
  EXPECT_EQ(error_of([&] { closest_hit(source, rays, hits, options); }).code(),
            ErrorCode::kOutOfMemory);
  options = {};
  options.part = 2;
  options.parts = 2;
  EXPECT_EQ(error_of([&] { closest_hit(source, rays, hits, options); }).code(),
            ErrorCode::kInvalidArgument);
  options = {};
  options.progress = [](const Progress&) { return false; };
  const Error stopped = error_of([&] { closest_hit(source, rays, hits, options); });
  EXPECT_EQ(stopped.code(), ErrorCode::kCancelled);
  EXPECT_EQ(stopped.sentence(), "the caller asked to stop");
  std::vector<Hit> two(2);
  EXPECT_EQ(error_of([&] { closest_hit(source, rays, two); }).code(), ErrorCode::kInvalidArgument);
  const std::vector<Ray> bad{{{0, 0, 0}, 0, {0, 0, 0}}};
  EXPECT_EQ(error_of([&] { closest_hit(source, bad, hits); }).code(), ErrorCode::kInvalidData);
  closest_hit(source, rays, hits);
  EXPECT_EQ(hits[0].prim_id, 0u);
  closest_hit(source, {}, {});
}

/// A source with blocks too large for the memory.
class Endless : public Shuffled {
 public:
  using Shuffled::Shuffled;
  void read(std::size_t /*block*/, TriangleBlock* out) const override {
    out->triangles.resize(out->triangles.max_size() + 1);
  }
};

TEST(Stream, MoreThanAnyVectorHoldsIsALackOfMemory) {
  Random random(1);
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(builtin_scene("cornell"), &blocks, 100));
  const Endless endless(blocks, random);
  const std::vector<Ray> rays{{{0, 0, 0}, 0, {0.1f, 0.2f, 1}}};
  std::vector<Hit> hits(1);
  EXPECT_EQ(error_of([&] { closest_hit(endless, rays, hits); }).code(), ErrorCode::kOutOfMemory);
  RenderOptions options;
  options.primary = Primary::kTrace;
  options.width = options.height = 32;
  EXPECT_EQ(error_of([&] { static_cast<void>(render(endless, options)); }).code(),
            ErrorCode::kOutOfMemory);
}

/// The exit code of a process that runs a query but cannot start threads.
int ask_without_threads(const GeometrySource& source) {
  constexpr uid_t kNobody = 65534;
  const rlimit none{0, 0};
  // The limit does not apply to root.
  if (::getuid() == 0 && ::setuid(kNobody) != 0) return 77;
  if (::setrlimit(RLIMIT_NPROC, &none) != 0) return 77;
  try {
    std::thread([] {}).join();
    return 77;
  } catch (const std::system_error&) {
  }
  try {
    std::vector<Ray> rays(1);
    rays[0].direction = {0.1f, 0.2f, 1};
    std::vector<Hit> hits(1);
    StreamOptions options;
    options.threads = 1;
    closest_hit(source, rays, hits, options);
    return hits[0].prim_id != kInvalidId ? 0 : 1;
  } catch (...) {
    return 2;
  }
}

TEST(Stream, BlocksAreReadWhereNoThreadStarts) {
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(builtin_scene("cornell"), &blocks, 10));
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(ask_without_threads(blocks));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "this system starts threads whatever the limit";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace raysheaf::test
