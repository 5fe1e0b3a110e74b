// Every function that is marked for devices is compiled for them.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

const fs::path kDeviceRoot = RAYSHEAF_SOURCE_DIR;

/// The text of every header and CUDA source under a folder.
std::vector<std::string> texts_under(const std::string& folder) {
  std::vector<std::string> texts;
  for (const auto& entry : fs::recursive_directory_iterator(kDeviceRoot / folder)) {
    const fs::path ending = entry.path().extension();
    if (ending == ".h" || ending == ".cu") texts.push_back(read_file(entry.path()));
  }
  return texts;
}

/// Texts of the libraries.
std::vector<std::string> library_texts() {
  std::vector<std::string> texts = texts_under("src");
  for (const char* folder : {"render", "paper", "lab"})
    for (std::string& text : texts_under(folder)) texts.push_back(std::move(text));
  return texts;
}

/// Texts whose calls are compiled for devices: the test cases, and the loops that run on devices.
std::vector<std::string> compiled_texts() {
  std::vector<std::string> texts = texts_under("tests/cuda");
  texts.push_back(read_file(kDeviceRoot / "tests/exec/device_properties.h"));
  for (std::string& text : library_texts())
    if (text.find("device.for_each(") != std::string::npos) texts.push_back(std::move(text));
  return texts;
}

TEST(Device, EveryMarkedFunctionIsCompiledForDevices) {
  const std::vector<std::string> used = found_in(compiled_texts(), R"((\w+)[(<])");
  const std::set<std::string> words(used.begin(), used.end());
  const std::vector<std::string> marked =
      found_in(library_texts(), R"(RAYSHEAF_HD\s[^({;#]*?(\w+)\()");
  EXPECT_GT(marked.size(), 80u);
  for (const std::string& name : marked) EXPECT_TRUE(words.contains(name)) << name;
}

/// base/host_device.h gives the reason.
TEST(Device, BodiesOfLoopsAreMarkedOnlyForDevices) {
  std::vector<std::string> texts = library_texts();
  for (std::string& text : texts_under("tests")) texts.push_back(std::move(text));
  const std::vector<std::string> bodies = found_in(texts, R"((\[[=&]?\] RAYSHEAF_\w+)\()");
  EXPECT_GT(bodies.size(), 80u);
  for (const std::string& body : bodies) EXPECT_TRUE(body.ends_with("RAYSHEAF_DEVICE")) << body;
}

/// nvcc makes constants of them (base/bits.h), which tests without a device cannot detect.
TEST(Device, NoMarkedFunctionCountsZerosByTheLibrary) {
  for (const std::string& text : library_texts()) {
    if (text.find("RAYSHEAF_HD ") == std::string::npos ||
        text.find("leading_zeros(std") != std::string::npos)  // base/bits.h itself
      continue;
    EXPECT_TRUE(text.find("std::countl_zero") == std::string::npos &&
                text.find("std::countr_zero") == std::string::npos)
        << text.substr(0, 80);
  }
}

}  // namespace
}  // namespace raysheaf::test
