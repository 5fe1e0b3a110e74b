// Streamed batches that are stopped and resumed give the same bits, even if the checkpoint file was
// damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "raysheaf/block_file.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "tests/support/process.h"
#include "tests/support/random.h"

namespace raysheaf::test {
namespace {

class Checkpoint : public ::testing::Test {
 protected:
  Checkpoint() {
    blocks_.set_scene(cut_into_blocks(builtin_scene("office"), &blocks_, 60));
    Random random(3);
    rays_.resize(2000);
    for (Ray& ray : rays_) {
      ray.origin = random.in_box(1);
      ray.direction = random.direction();
    }
    expected_.resize(rays_.size());
    closest_hit(blocks_, rays_, expected_);
    occluded_.resize(rays_.size());
    any_hit(blocks_, rays_, occluded_);
  }

  /// Runs a batch that may stop after `calls` of its progress callback. Returns the number of bytes
  /// read; 0 if it was stopped.
  std::uint64_t run(int calls, const std::vector<Ray>& rays) {
    CheckpointFile file(folder_.file("kept"), "office", 0);
    StreamStatistics statistics;
    StreamOptions options;
    options.memory_bytes = 96u << 20;
    options.threads = 1;
    options.checkpoint = &file;
    options.statistics = &statistics;
    options.progress = [&calls](const Progress&) { return calls-- != 0; };
    std::vector<Hit> hits(rays.size());
    try {
      closest_hit(blocks_, rays, hits, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled) << error.what();
      return 0;
    }
    if (rays.data() == rays_.data()) {
      EXPECT_EQ(std::memcmp(hits.data(), expected_.data(), hits.size() * sizeof(Hit)), 0);
    }
    return statistics.read_bytes + 1;
  }

  BlockList blocks_;
  std::vector<Ray> rays_;
  std::vector<Hit> expected_;
  std::vector<std::uint8_t> occluded_;
  TemporaryFolder folder_;
};

TEST_F(Checkpoint, AStoppedBatchResumes) {
  const std::uint64_t all = run(-1, rays_);
  std::filesystem::remove(folder_.file("kept"));
  int stops = 0;
  std::uint64_t read = 0;
  for (int calls = 20; (read = run(calls, rays_)) == 0 && stops < 100; calls += 10) ++stops;
  EXPECT_GT(stops, 1);
  EXPECT_GT(read, 0u);
  EXPECT_LT(read, all);
  EXPECT_EQ(run(-1, rays_), 1u) << "a batch that is done reads nothing";
}

TEST_F(Checkpoint, AFolderThatIsMissingIsNamedAtOnce) {
  try {
    const CheckpointFile file(folder_.file("no/such/kept"), "a frame");
    ADD_FAILURE() << "no error was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kIo);
    EXPECT_EQ(error.place(), folder_.file("no/such/kept"));
  }
}

TEST_F(Checkpoint, AnInvalidFileIsIgnored) {
  const std::uint64_t all = run(-1, rays_);
  const std::string good = read_file(folder_.file("kept"));
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{50}, good.size() - 1}) {
    write_file(folder_.file("kept"), good.substr(0, size));
    EXPECT_EQ(run(-1, rays_), all) << size;
  }
  for (const std::size_t at : {std::size_t{3}, std::size_t{12}, std::size_t{60}, good.size() - 2}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 16);
    write_file(folder_.file("kept"), bad);
    EXPECT_EQ(run(-1, rays_), all) << at;
  }
  write_file(folder_.file("kept"), good);
  std::vector<Ray> others = rays_;
  others[7].t_min = 0.25f;
  EXPECT_GT(run(-1, others), 1u) << "other rays are another batch";
}

TEST_F(Checkpoint, PartsAndOcclusionResumeToo) {
  for (int time = 0; time < 2; ++time) {
    CheckpointFile file(folder_.file("kept"), "office", 0);
    StreamStatistics statistics;
    StreamOptions options;
    options.checkpoint = &file;
    options.statistics = &statistics;
    std::vector<std::uint8_t> occluded(rays_.size());
    any_hit(blocks_, rays_, occluded, options);
    EXPECT_EQ(occluded, occluded_);
    EXPECT_EQ(statistics.read_blocks == 0, time == 1);
    options.part = 1;
    options.parts = 2;
    statistics = {};
    any_hit(blocks_, rays_, occluded, options);
    EXPECT_EQ(statistics.read_blocks == 0, time == 1);
    EXPECT_NE(occluded, occluded_);
    if (time == 1) file.remove();
  }
  EXPECT_EQ(folder_.names().size(), 0u);
}

/// With `all_done`, restores every block as done.
struct Log : StreamCheckpoint {
  bool all_done = false;
  std::vector<bool> kept;  ///< for each call: whether the batch was complete

  bool restore(const StreamBatch& /*batch*/, std::span<std::byte> /*answers*/,
               std::span<std::uint8_t> done) override {
    if (all_done) std::ranges::fill(done, std::uint8_t{1});
    return all_done;
  }
  void keep(const StreamBatch& batch, std::span<const std::byte> answers,
            std::span<const std::uint8_t> done, bool whole) override {
    EXPECT_EQ(answers.size(), batch.rays.size() * sizeof(StreamHit));
    EXPECT_TRUE(!whole || std::ranges::count(done, 1) == std::ssize(batch.blocks));
    kept.push_back(whole);
  }
};

TEST_F(Checkpoint, EveryBatchIsStoredCompleteOnce) {
  std::vector<Ray> far = rays_;
  for (Ray& ray : far) ray.origin = {1e6f, 1e6f, 1e6f}, ray.t_max = 1;
  std::vector<Hit> hits(rays_.size());
  for (const bool all_done : {false, true}) {
    for (const std::vector<Ray>* rays : {&rays_, &far}) {
      Log log;
      log.all_done = all_done;
      StreamOptions options;
      options.checkpoint = &log;
      closest_hit(blocks_, *rays, hits, options);
      ASSERT_EQ(std::ranges::count(log.kept, true), 1);
      EXPECT_TRUE(log.kept.back());
      EXPECT_EQ(log.kept.size() == 1, all_done || rays == &far);
    }
  }
}

/// A batch with a partial record is stored when it completes, however long the interval: the next
/// record would overwrite the partial one.
TEST_F(Checkpoint, AResumedBatchIsStoredWhenItEnds) {
  constexpr double kLong = 1e6;
  const std::vector<BlockInfo> infos(3);
  StreamBatch batch{0, 0, 0, 1, rays_, infos};
  std::vector<std::byte> answers(rays_.size(), std::byte{7});
  std::vector<std::uint8_t> done{1, 1, 0};
  CheckpointFile(folder_.file("kept"), "office", 0).keep(batch, answers, done, false);
  {
    CheckpointFile file(folder_.file("kept"), "office", kLong);
    ASSERT_TRUE(file.restore(batch, answers, done));
    EXPECT_EQ(done[2], 0);
    done[2] = 1;
    file.keep(batch, answers, done, true);
  }
  {
    CheckpointFile file(folder_.file("kept"), "office", 0);
    batch.number = 1;
    file.keep(batch, answers, done, false);
  }
  CheckpointFile file(folder_.file("kept"), "office", kLong);
  batch.number = 0;
  done.assign(3, 0);
  EXPECT_TRUE(file.restore(batch, answers, done));
  EXPECT_EQ(done, std::vector<std::uint8_t>(3, 1));
}

/// A batch that finished too early to be stored may take longer the next time.
TEST_F(Checkpoint, TheRecordOfALaterBatchStays) {
  const std::vector<BlockInfo> infos(3);
  StreamBatch batch{1, 0, 0, 1, rays_, infos};
  std::vector<std::byte> answers(rays_.size(), std::byte{7});
  const std::vector<std::uint8_t> begun{1, 1, 0}, all(3, 1);
  CheckpointFile(folder_.file("kept"), "office", 0).keep(batch, answers, begun, false);
  const auto restored = [&](std::uint32_t number, const std::vector<std::byte>& expected) {
    CheckpointFile file(folder_.file("kept"), "office", 0);
    batch.number = number;
    std::vector<std::byte> found(rays_.size());
    std::vector<std::uint8_t> done(3, 0);
    if (file.restore(batch, found, done)) {
      EXPECT_EQ(found, expected);
    }
    return done;
  };
  for (const bool whole : {false, true}) {
    batch.number = 0;
    CheckpointFile(folder_.file("kept"), "office", 0).keep(batch, answers, all, whole);
    EXPECT_EQ(restored(1, answers), begun);
  }
  // The batch continues, and is then restored in its final state.
  std::vector<std::byte> more(rays_.size(), std::byte{9});
  {
    CheckpointFile file(folder_.file("kept"), "office", 0);
    std::vector<std::uint8_t> done(3, 0);
    batch.number = 1;
    ASSERT_TRUE(file.restore(batch, answers, done));
    file.keep(batch, more, all, true);
  }
  EXPECT_EQ(restored(1, more), all);
  EXPECT_EQ(restored(0, answers), all);
}

TEST_F(Checkpoint, ADamagedRecordIsStoredAgain) {
  const std::uint64_t read = run(-1, rays_);
  std::string bad = read_file(folder_.file("kept"));
  bad[bad.size() - 2] = static_cast<char>(bad[bad.size() - 2] ^ 16);
  write_file(folder_.file("kept"), bad);
  EXPECT_EQ(run(-1, rays_), read);
  EXPECT_EQ(run(-1, rays_), 1u) << "the second run has stored its results";
}

}  // namespace
}  // namespace raysheaf::test
