// If the program is killed or cannot write, either the complete old file or the complete new one
// exists.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

std::vector<std::string> small_render() {
  return {"render", "builtin:cornell", "-o", "a.png", "--size", "64x64", "--quiet"};
}

std::string small_picture() {
  const TemporaryFolder folder;
  EXPECT_EQ(raysheaf_app(small_render(), folder).code, 0);
  return read_file(folder.path() / "a.png");
}

TEST(Stopped, InterruptLeavesTheOldPictureOrTheNewOne) {
  const std::string whole = small_picture();
  int old_ones = 0, new_ones = 0;
  // Delays that reach from before the program begins until after it ends, on any machine.
  for (int milliseconds = 1; new_ones < 3 && milliseconds < 20000;
       milliseconds += 1 + milliseconds / 4) {
    const TemporaryFolder folder;
    write_file(folder.file("a.png"), "old");
    const Finished finished =
        raysheaf_app(small_render(), folder, std::chrono::milliseconds(milliseconds));
    const std::string left = read_file(folder.path() / "a.png");
    EXPECT_EQ(folder.names().size(), 1u) << "after " << milliseconds << " ms";
    EXPECT_TRUE(finished.code == 0 || finished.code == 130) << finished.code << finished.err;
    if (finished.code == 0) {
      EXPECT_EQ(left, whole) << "after " << milliseconds << " ms";
    } else {
      EXPECT_TRUE(left == "old" || left == whole) << "after " << milliseconds << " ms";
    }
    ++(left == "old" ? old_ones : new_ones);
  }
  EXPECT_GE(old_ones, 1);
  EXPECT_GE(new_ones, 3);
}

// Runs `arguments`, which take seconds, and sends the signal after 0.3 s. Like `timeout`, it sends
// it to the program and to its group, twice.
Finished stopped_by(const std::string& signal, const std::string& arguments,
                    const TemporaryFolder& folder) {
  return run_program(
      {"bash", "-c",
       "TMPDIR=. timeout --preserve-status -s " + signal + " 0.3 '" RAYSHEAF_APP "' " + arguments},
      folder.path());
}

TEST(Stopped, StoppedWritersLeaveNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(raysheaf_app({"scene", "hall", "--triangles", "3M", "-o", "h.glb"}, folder).code, 0);
  const std::pair<const char*, int> signals[] = {{"INT", 130}, {"TERM", 143}, {"HUP", 129}};
  for (const auto& [signal, code] : signals) {
    for (const char* arguments :
         {"pack h.glb -o s.rsb", "pack h.glb --compress -o s.rsb -q",
          "scene hall --triangles 60M --threads 1 -o s.rsb",
          "render h.glb --stream --memory 64M -o s.png", "bench scale --measured 16M -q"}) {
      const Finished finished = stopped_by(signal, arguments, folder);
      EXPECT_EQ(finished.code, code) << signal << ": " << arguments;
      // On a busy machine, the program may not have started: then it prints nothing.
      if (!finished.err.empty()) {
        EXPECT_EQ(finished.err, "raysheaf: interrupted\n") << signal << ": " << arguments;
      }
      EXPECT_EQ(folder.names(), std::vector<std::string>{"h.glb"}) << signal << ": " << arguments;
    }
  }
}

TEST(Stopped, AKilledProgramLeavesNothing) {
  const TemporaryFolder folder;
  const int unnamed = ::open(folder.path().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed < 0) GTEST_SKIP() << "the file system has no files without names";
  ::close(unnamed);
  const Finished finished =
      stopped_by("KILL", "scene hall --triangles 60M --threads 1 -o s.rsb", folder);
  EXPECT_EQ(finished.code, 137);
  EXPECT_TRUE(folder.names().empty());
}

TEST(Stopped, NohupGoesOn) {
  const TemporaryFolder folder;
  const Finished finished = run_program(
      {"bash", "-c",
       "trap '' HUP; '" RAYSHEAF_APP "' scene hall --triangles 8M --threads 1 -o s.rsb & "
       "sleep 0.1; kill -HUP $!; wait $!"},
      folder.path());
  EXPECT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(folder.names(), std::vector<std::string>{"s.rsb"});
}

TEST(Stopped, ALimitOnFilesLeavesTheOldPicture) {
  const TemporaryFolder folder;
  write_file(folder.file("a.png"), "old");
  const std::string app = RAYSHEAF_APP;
  const Finished finished = run_program(
      {"bash", "-c",
       "ulimit -f 1; '" + app + "' render builtin:cornell -o a.png --size 256x256 --quiet"},
      folder.path());
  // Standard error is a small file.
  EXPECT_EQ(finished.code, 1);
  EXPECT_TRUE(finished.err.starts_with("raysheaf: a.png: cannot be written: ")) << finished.err;
  EXPECT_EQ(read_file(folder.path() / "a.png"), "old");
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(Stopped, ClosedStreamsDoNotReachThePicture) {
  const std::string whole = small_picture();
  const TemporaryFolder folder;
  const std::string app = RAYSHEAF_APP;
  const Finished finished = run_program(
      {"bash", "-c", "'" + app + "' render builtin:cornell -o a.png --size 64x64 <&- >&- 2>&-"},
      folder.path());
  EXPECT_EQ(finished.code, 0);
  EXPECT_EQ(read_file(folder.path() / "a.png"), whole);
}

}  // namespace
}  // namespace raysheaf::test
