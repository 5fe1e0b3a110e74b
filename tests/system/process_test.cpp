// Programs that are started, and what is known of this process and its machine.
#include "system/process.h"

#include <gtest/gtest.h>

#include "support/folder.h"
#include "system/child.h"

namespace raysheaf::test {
namespace {

using system::Child;

TEST(Process, KnowsItsMemoryAndItsProgram) {
  EXPECT_GT(system::peak_memory_bytes(), 100'000u);
  EXPECT_GT(system::memory_bytes(), system::peak_memory_bytes());
  EXPECT_TRUE(std::filesystem::exists(system::program_path()));
  EXPECT_FALSE(system::system_name().empty());
  EXPECT_FALSE(system::processor_name().empty());
}

TEST(Process, StartsPrograms) {
  const TemporaryFolder folder;
  const std::string said = folder.file("it said.txt");
  Child child({system::program_path(), "--gtest_list_tests", "--gtest_filter=Process.*:a \\\"b\\"},
              Child::Input::kNone, said);
  ASSERT_EQ(child.failure(), 0);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(child.wait(), -1);
  const std::string text = read_file(said);
  EXPECT_NE(text.find("StartsPrograms"), text.npos) << text;
  EXPECT_EQ(text.find("HaveAState"), text.npos) << text;
}

TEST(Process, SaysThatAProgramIsMissing) {
  EXPECT_EQ(system::find_program("no-such-program"), "");
  Child child({"no-such-program"}, Child::Input::kPipe);
  EXPECT_NE(child.failure(), 0);
  EXPECT_EQ(child.wait(), -1);
  std::string why;
  EXPECT_EQ(system::load_library("no-such-library", &why), nullptr);
  EXPECT_FALSE(why.empty());
}

}  // namespace
}  // namespace raysheaf::test
