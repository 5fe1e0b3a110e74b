// `mpirun -n N raysheaf render` writes the same files as a single process, and reports errors in
// one sentence. Skipped if the build has no MPI or mpirun is not installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/scenes.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Finished in_shell(const std::string& script, const TemporaryFolder& folder) {
  return run_program({"bash", "-c", script}, folder.path());
}

/// Starts processes on this machine, regardless of its number of cores and of the user.
const char* const kMpirun =
    "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe "
    "--bind-to none --mca btl_vader_single_copy_mechanism none ";

/// The possible outcomes of starting two processes.
enum class Here { kNoMpirun, kNoMpi, kAll };

class Mpi : public ::testing::Test {
 protected:
  Here here() {
    static const Here found = [this] {
      const Finished finished = render(2, {"builtin:cornell", "--size", "8x8", "-o", "a.png"});
      fs::remove(folder_.file("a.png"));
      if (contains(finished.err, "cannot share work among them")) return Here::kNoMpi;
      // The shell's exit code for a missing command.
      return finished.code == 127 ? Here::kNoMpirun : Here::kAll;
    }();
    return found;
  }
  /// `raysheaf render WORDS` in `ranks` processes of one thread each.
  Finished render(int ranks, const Words& words) {
    std::string script = ranks == 1 ? "" : kMpirun + ("-n " + std::to_string(ranks) + " ");
    script += "'" RAYSHEAF_APP "' render --threads 1";
    for (const std::string& word : words) script += " '" + word + "'";
    return in_shell(script, folder_);
  }
  /// The contents of the image; expects that the run writes no other file.
  std::string picture(int ranks, Words words) {
    words.insert(words.end(), {"-o", "a.png"});
    const Finished finished = render(ranks, words);
    EXPECT_EQ(finished.code, 0) << finished.err;
    const std::string file = read_file(folder_.file("a.png"));
    fs::remove(folder_.file("a.png"));
    return file;
  }
  /// The error message of a failing run, without mpirun's own output.
  std::string sentence(int ranks, const Words& words, int code = 1) {
    const Finished finished = render(ranks, words);
    EXPECT_EQ(finished.code, code) << finished.err;
    std::istringstream lines(finished.err);
    std::string sentence;
    int sentences = 0;
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("raysheaf: ")) continue;
      sentence = line;
      ++sentences;
    }
    EXPECT_EQ(sentences, 1) << finished.err;
    return sentence;
  }
  [[nodiscard]] std::size_t count_of(const std::string& part) const {
    const std::vector<std::string> names = folder_.names();
    return static_cast<std::size_t>(std::count_if(
        names.begin(), names.end(), [&](const std::string& name) { return contains(name, part); }));
  }

  TemporaryFolder folder_;
};

class Ranks : public Mpi {
 protected:
  void SetUp() override {
    if (here() != Here::kAll) GTEST_SKIP() << "there is no mpirun, or the build has no MPI";
  }
};

TEST_F(Mpi, ABuildWithoutItSaysSoOnce) {
  if (here() != Here::kNoMpi) GTEST_SKIP() << "there is no mpirun, or the build has MPI";
  EXPECT_EQ(sentence(2, {"builtin:cornell", "--size", "8x8", "-o", "a.png", "-q"}),
            "raysheaf: mpirun: 2 processes were started, but this build cannot share work among "
            "them: MPI was missing, or switched off, when it was built");
  EXPECT_EQ(count_of("a.png"), 0u);
}

TEST_F(Ranks, BuiltinPicturesAreTheSameFiles) {
  for (const std::string name : {"cornell", "office"}) {
    const std::string scene = "builtin:" + name;
    const Words traced{scene, "--size", "192x128", "--primary", "trace", "-q"};
    const std::string alone = picture(1, traced);
    EXPECT_EQ(picture(2, traced), alone) << name;
    EXPECT_EQ(picture(3, traced), alone) << name;
    const Words cut{scene, "--size", "192x128", "--share", "geometry", "-q"};
    EXPECT_EQ(picture(2, cut), alone) << name;
    ASSERT_EQ(
        raysheaf_app({"pack", scene, "-o", "a.rsb", "--block-triangles", "300", "-q"}, folder_)
            .code,
        0);
    const Words streamed{"a.rsb", "--size", "192x128", "--samples", "1", "-q"};
    for (const int ranks : {1, 2, 3}) EXPECT_EQ(picture(ranks, streamed), alone) << name << ranks;
  }
  const Words rastered{"builtin:cornell", "--size", "192x128", "-q"};
  EXPECT_EQ(picture(2, rastered), picture(1, rastered));
}

class LargerScenes : public Ranks, public ::testing::WithParamInterface<const char*> {};

TEST_P(LargerScenes, PicturesAreTheSameFiles) {
  RAYSHEAF_SCENE_OR_SKIP(file, GetParam());
  // The image is square, because blocks store the camera that frames a square image.
  const Words traced{file, "--size", "140x140", "--primary", "trace", "-q"};
  const std::string alone = picture(1, traced);
  EXPECT_EQ(picture(2, traced), alone);
  ASSERT_EQ(raysheaf_app({"pack", file, "-o", "a.rsb", "-q"}, folder_).code, 0);
  const Words streamed{"a.rsb", "--size", "140x140", "-q"};
  for (const int ranks : {1, 2, 3}) EXPECT_EQ(picture(ranks, streamed), alone) << ranks;
}

INSTANTIATE_TEST_SUITE_P(All, LargerScenes,
                         ::testing::Values("paper/sponza.glb", "paper/office.glb",
                                           "bart_kitchen/static.obj"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

TEST_F(Ranks, ReportSharedWorkAndSumCounts) {
  ASSERT_EQ(raysheaf_app({"pack", "builtin:office", "-o", "a.rsb", "-q"}, folder_).code, 0);
  const auto stats = [&](int ranks) {
    const Finished finished =
        render(ranks, {"a.rsb", "--size", "64x48", "--stats", "s.json", "--explain"});
    EXPECT_EQ(finished.code, 0) << finished.err;
    EXPECT_EQ(contains(finished.err, "shared among 2 ranks by geometry"), ranks == 2);
    return nlohmann::json::parse(read_file(folder_.file("s.json")));
  };
  const auto one = stats(1), two = stats(2);
  EXPECT_EQ(two["ranks"], 2);
  EXPECT_EQ(two["shared"], "geometry");
  EXPECT_EQ(two["stream"]["blocks"], one["stream"]["blocks"]);
  for (std::size_t i = 0; i < one["batches"].size(); ++i)
    EXPECT_EQ(two["batches"][i]["hits"], one["batches"][i]["hits"]);
  EXPECT_FALSE(one.contains("ranks"));
}

TEST_F(Ranks, MakeFramesAndResumeThem) {
  const Words turn{"builtin:cornell", "--turntable", "5", "--size", "32x24", "--primary", "trace"};
  const auto frames = [&](int ranks, const std::string& name, const Words& more) {
    Words words = turn;
    words.insert(words.end(), {"-o", name + "_%d.png"});
    words.insert(words.end(), more.begin(), more.end());
    const Finished finished = render(ranks, words);
    EXPECT_EQ(finished.code, 0) << finished.err;
    return finished.err;
  };
  frames(1, "one", {});
  EXPECT_TRUE(contains(frames(2, "two", {}), "shared among 2 ranks by frames"));
  EXPECT_TRUE(contains(frames(2, "rays", {"--share", "rays"}), "shared among 2 ranks by rays"));
  fs::remove(folder_.file("two_1.png"));
  fs::remove(folder_.file("two_2.png"));
  fs::remove(folder_.file("two_4.png"));
  EXPECT_TRUE(contains(frames(3, "two", {"--resume"}), "2 of 5 frames exist already"));
  EXPECT_EQ(count_of("two_"), 5u);
  for (const std::string i : {"0", "1", "2", "3", "4"}) {
    const std::string alone = read_file(folder_.file("one_" + i + ".png"));
    EXPECT_EQ(read_file(folder_.file("two_" + i + ".png")), alone) << i;
    EXPECT_EQ(read_file(folder_.file("rays_" + i + ".png")), alone) << i;
  }
  EXPECT_EQ(count_of(".part"), 0u);
}

TEST_F(Ranks, WarningsOfEveryFrameAreReportedOnce) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  constexpr int kFrames = 40;
  const auto name = [](int i) { return std::to_string(100 + i); };
  for (int i = 0; i < kFrames; ++i)
    write_file(folder_.file("f_" + name(i) + ".obj"), "usemtl m" + name(i) + "\n" + triangle);
  const Finished finished = render(3, {"f_*.obj", "-o", "p_%d.png", "--size", "8x8", "--primary",
                                       "trace", "--exposure", "1", "--ambient", "1"});
  EXPECT_EQ(finished.code, 0) << finished.err;
  for (int i = 0; i < kFrames; ++i) {
    const std::string warning = "warning: There is no material \"m" + name(i) + "\"";
    const std::size_t at = finished.err.find(warning);
    ASSERT_NE(at, std::string::npos) << i << "\n" << finished.err;
    EXPECT_EQ(finished.err.find(warning, at + 1), std::string::npos) << i;
  }
}

TEST_F(Ranks, OneFailureIsOneSentence) {
  ASSERT_EQ(
      raysheaf_app({"pack", "builtin:cornell", "-o", "a.rsb", "--block-triangles", "50"}, folder_)
          .code,
      0);
  const std::string good = read_file(folder_.file("a.rsb"));
  const auto number_at = [&good](std::uint64_t at) {
    std::uint64_t number = 0;
    std::memcpy(&number, good.data() + at, sizeof number);
    return number;
  };
  for (const std::uint64_t block : {0u, 1u}) {  // the first block of each rank
    const std::uint64_t list = number_at(40), geometry = number_at(list + 80 * block + 32);
    std::string bad = good;
    bad[geometry + 40] = static_cast<char>(bad[geometry + 40] ^ 4);
    write_file(folder_.file("bad.rsb"), bad);
    const std::string number = std::to_string(block);
    EXPECT_EQ(sentence(2, {"bad.rsb", "--size", "8x8", "-o", "p.png", "-q"}),
              "raysheaf: rank " + number + " of 2: bad.rsb: block " + number +
                  ": its bytes are damaged: the checksum does not match");
  }
  write_file(folder_.file("short.rsb"), good.substr(0, good.size() / 2));
  EXPECT_TRUE(contains(sentence(2, {"short.rsb", "-o", "p.png", "-q"}), "rank 0 of 2: short.rsb"));
  EXPECT_TRUE(contains(sentence(2, {"none.glb", "-o", "p.png", "-q"}), "none.glb: no such file"));
  EXPECT_TRUE(contains(sentence(2, {"a.rsb", "-o", "no/such/p.png", "-q"}),
                       "rank 0 of 2: no/such/p.png: cannot write here"));
  sentence(2, {"a.rsb", "--share", "rays", "-o", "p.png"}, 2);
  sentence(2, {"a.rsb", "--share", "everything", "-o", "p.png"}, 2);
  EXPECT_EQ(folder_.names().size(), 3u);
}

// Rank 1 runs in a folder in which each image's name is taken by a folder.
TEST_F(Ranks, AnyRankMayFail) {
  for (int i = 0; i < 8; ++i)
    fs::create_directories(folder_.path() / "other" / ("t_" + std::to_string(i) + ".png"));
  write_file(folder_.file("run.sh"),
             "[ \"$OMPI_COMM_WORLD_RANK\" = 1 ] && cd other\n"
             "exec '" RAYSHEAF_APP "' \"$@\"\n");
  const Words turn{"builtin:cornell", "--turntable", "8",  "--size", "64x48",
                   "--primary",       "trace",       "-q", "-o",     "t_%d.png"};
  std::string words;
  for (const std::string& word : turn) words += " '" + word + "'";
  const Finished finished =
      in_shell(std::string(kMpirun) + "-n 2 sh run.sh render --threads 1" + words, folder_);
  EXPECT_EQ(finished.code, 1) << finished.err;
  EXPECT_TRUE(contains(finished.err, "raysheaf: rank 1 of 2: t_")) << finished.err;
  EXPECT_TRUE(contains(finished.err, "cannot write here: it is a folder")) << finished.err;
  EXPECT_EQ(count_of(".part"), 0u);
  EXPECT_LT(count_of("t_"), 8u);
  Words resumed = turn;
  resumed.emplace_back("--resume");
  EXPECT_EQ(render(2, resumed).code, 0);
  EXPECT_EQ(count_of("t_"), 8u);
}

TEST_F(Ranks, AKilledRankLeavesWholeFramesAndTheRunGoesOn) {
  // Rank 1 kills itself with SIGKILL when the first frame exists, or after a minute.
  write_file(folder_.file("run.sh"),
             "#!/bin/bash\n"
             "wait_and_kill() {\n"
             "  for ((i = 0; i < 600; ++i)); do compgen -G 't_*.png' && break; sleep 0.1; done\n"
             "  kill -9 $$\n"
             "}\n"
             "[ \"$OMPI_COMM_WORLD_RANK\" = 1 ] && wait_and_kill >/dev/null 2>&1 &\n"
             "exec '" RAYSHEAF_APP "' \"$@\"\n");
  const Words turn{"builtin:cornell", "--turntable", "20000", "--size", "32x24",
                   "--primary",       "trace",       "-q",    "-o",     "t_%05d.png"};
  std::string words;
  for (const std::string& word : turn) words += " '" + word + "'";
  const Finished finished =
      in_shell(std::string(kMpirun) + "-n 2 bash run.sh render --threads 1" + words, folder_);
  EXPECT_NE(finished.code, 0) << finished.err;
  const std::size_t made = count_of("t_");
  ASSERT_GT(made, 0u);
  ASSERT_LT(made, 20000u);
  Words resumed = turn;
  const std::string last = std::to_string(made + 3);
  resumed.insert(resumed.end(), {"--resume", "--frames", ":" + last});
  EXPECT_EQ(render(2, resumed).code, 0);
  Words alone = turn;
  alone.back() = "u_%05d.png";
  alone.insert(alone.end(), {"--frames", ":" + last});
  EXPECT_EQ(render(1, alone).code, 0);
  for (std::size_t i = 0; i < made + 4; ++i) {
    std::string number = std::to_string(i);
    number = std::string(5 - number.size(), '0') + number + ".png";
    EXPECT_EQ(read_file(folder_.file("t_" + number)), read_file(folder_.file("u_" + number))) << i;
  }
}

TEST_F(Ranks, MayWorkIndependently) {
  const std::string script = std::string(kMpirun) +
                             "-n 2 sh -c '\"" RAYSHEAF_APP
                             "\" render builtin:cornell --size 8x8 --share none -q -o "
                             "p_$OMPI_COMM_WORLD_RANK.png'";
  EXPECT_EQ(in_shell(script, folder_).code, 0);
  EXPECT_EQ(read_file(folder_.file("p_0.png")), read_file(folder_.file("p_1.png")));
  const Finished other =
      in_shell(std::string(kMpirun) + "-n 2 '" RAYSHEAF_APP "' scene cornell -o c.glb", folder_);
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(contains(other.err, "several processes can share the work only of render"))
      << other.err;
  EXPECT_EQ(count_of("c.glb"), 0u);
}

}  // namespace
}  // namespace raysheaf::test
