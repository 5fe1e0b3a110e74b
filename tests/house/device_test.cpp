// No function that is marked for devices goes uncompiled for them.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RAYSHEAF_SOURCE_DIR;

/// The text of every header and CUDA source under a folder.
std::vector<std::string> texts_under(const std::string& folder) {
  std::vector<std::string> texts;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const fs::path ending = entry.path().extension();
    if (ending == ".h" || ending == ".cu") texts.push_back(read_file(entry.path()));
  }
  return texts;
}

TEST(Device, EveryMarkedFunctionIsCompiledInTestsCuda) {
  const std::vector<std::string> used = found_in(texts_under("tests/cuda"), R"((\w+)[(<])");
  const std::set<std::string> words(used.begin(), used.end());
  const std::vector<std::string> marked =
      found_in(texts_under("src"), R"(RAYSHEAF_HD\s[^({;#]*?(\w+)\()");
  EXPECT_GT(marked.size(), 80u);
  for (const std::string& name : marked) EXPECT_TRUE(words.contains(name)) << name;
}

}  // namespace
}  // namespace raysheaf::test
