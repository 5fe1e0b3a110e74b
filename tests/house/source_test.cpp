// The house rules that a program can see: sizes of files, arrows between rooms, one place for the
// version and for the packages.
#include <gtest/gtest.h>

#include <algorithm>

#include "raysheaf/version.h"
#include "tests/support/markdown.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RAYSHEAF_SOURCE_DIR;

std::vector<fs::path> sources_under(const std::string& folder) {
  std::vector<fs::path> all;
  if (!fs::is_directory(kRoot / folder)) return all;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const fs::path ending = entry.path().extension();
    if (ending == ".h" || ending == ".cpp" || ending == ".cu") all.push_back(entry.path());
  }
  return all;
}

std::vector<std::string> included_by(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return found_in(lines, R"(^#include \"([^\"]+)\")");
}

TEST(Source, FilesStaySmall) {
  for (const std::string folder : {"include", "src", "io", "apps", "python"}) {
    for (const fs::path& file : sources_under(folder)) {
      const std::string text = read_file(file);
      const auto lines = std::count(text.begin(), text.end(), '\n');
      EXPECT_LE(lines, file.extension() == ".h" ? 300 : 400) << file;
    }
  }
}

// base <- geom <- exec <- the stages <- frame <- api. A stage may use the stages before it.
TEST(Source, ArrowsPointOneWay) {
  const std::vector<std::string> rooms = {
      "base",  "geom",      "exec",   "ranks",    "scene",     "animation", "raster", "raygen",
      "order", "hierarchy", "object", "traverse", "intersect", "packet",    "fan",    "dual",
      "shade", "engine",    "stream", "frame",    "lab",       "api",       "verify"};
  const auto rank = [&rooms](const std::string& room) {
    return std::find(rooms.begin(), rooms.end(), room) - rooms.begin();
  };
  const auto tier = [&](const std::string& room) {
    const auto first = rank("scene"), last = rank("shade"), at = rank(room);
    return at < first ? at : at <= last ? first : at;
  };
  for (const std::string& room : rooms) {
    for (const fs::path& file : sources_under("src/" + room)) {
      for (const std::string& header : included_by(file)) {
        const std::string other = header.substr(0, header.find('/'));
        if (std::find(rooms.begin(), rooms.end(), other) == rooms.end()) continue;
        EXPECT_LE(tier(other), tier(room)) << file << " includes " << header;
      }
    }
  }
}

TEST(Source, OutsideSeesTheFrontDoorAlone) {
  for (const std::string folder : {"io", "apps", "python"}) {
    for (const fs::path& file : sources_under(folder)) {
      for (const std::string& header : included_by(file)) {
        EXPECT_FALSE(fs::exists(kRoot / "src" / header)) << file << " includes " << header;
      }
    }
  }
  for (const fs::path& file : sources_under("include")) {
    for (const std::string& header : included_by(file)) {
      EXPECT_TRUE(header.starts_with("raysheaf/")) << file << " includes " << header;
    }
  }
}

TEST(Source, NothingBelowTheAppsPrintsOrExits) {
  static const std::regex kForbidden(
      R"((^|[^\w:.])(std::)?(printf|puts|exit|abort|_exit|quick_exit|terminate)\(|std::(cout|cerr|clog)\b)");
  for (const std::string folder : {"include", "src", "io", "python"}) {
    for (const fs::path& file : sources_under(folder)) {
      std::ifstream stream(file);
      int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        const std::string code = line.substr(0, line.find("//"));
        EXPECT_FALSE(std::regex_search(code, kForbidden)) << file << ":" << number << ": " << line;
      }
    }
  }
}

TEST(Source, PackagesHaveTheProjectsVersion) {
  const std::string version = RAYSHEAF_VERSION;
  const std::pair<const char*, std::string> places[] = {
      {"packaging/vcpkg/raysheaf/vcpkg.json", "\"version\": \"" + version + "\""},
      {"packaging/conan/conanfile.py", "version = \"" + version + "\""},
      {"CHANGELOG.md", "\n## " + version}};
  for (const auto& [file, sentence] : places)
    EXPECT_NE(read_file(kRoot / file).find(sentence), std::string::npos)
        << file << " lacks " << sentence;
}

TEST(Source, HeadersAreIncludedOnce) {
  for (const std::string folder : {"include", "src", "io", "apps", "python", "tests"}) {
    for (const fs::path& file : sources_under(folder)) {
      const std::string name = file.filename().string();
      if (file.extension() != ".h" || name.ends_with("-inl.h")) continue;
      EXPECT_NE(read_file(file).find("#pragma once\n"), std::string::npos) << file;
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
