// The house rules that a program can check: the dependencies between rooms, the way of a ray, and a
// single place for the version.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

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

// The rooms, each after those that it may include. No two stand at one place, so there is no circle.
const std::vector<std::string> kRooms = {
    "src/base",
    "src/geom",
    "src/exec",
    "src/ranks",
    "src/intersect",
    "src/scene",
    "src/surface",
    "src/animation",
    "src/rays/order",
    "src/rays",
    "src/object_tree",
    "src/methods/dual",
    "src/methods/fan",
    "src/queries",
    "src/device",
    "src/methods/ray_hierarchy",
    "src/methods/packets",
    "src/out_of_core",
    "src/render/raster",
    "src/render/shade",
    "src/render/device",
    "src/render/picture",
    "src/render/frame",
    "src/render/geometry",
    "src/backends",
    "src/api",
    "emulated",
    "scenes",
    "lab",
    "lab/verify",
};

/// The room of a file, or of a header as it is included: the longest that its path begins with.
std::string room_of(const std::string& path) {
  std::string best;
  for (const std::string& room : kRooms)
    for (const std::string& seen : {room, room.starts_with("src/") ? room.substr(4) : room})
      if (path.starts_with(seen + "/") && room.size() > best.size()) best = room;
  return best;
}

TEST(Source, ArrowsPointOneWay) {
  const auto rank = [](const std::string& room) {
    return std::find(kRooms.begin(), kRooms.end(), room) - kRooms.begin();
  };
  for (const std::string folder : {"src", "emulated", "scenes", "lab"}) {
    for (const fs::path& file : sources_under(folder)) {
      const std::string room = room_of(fs::relative(file, kRoot).string());
      ASSERT_FALSE(room.empty()) << file << " is in no room of this test's list";
      for (const std::string& header : included_by(file)) {
        const std::string other = room_of(header);
        if (!other.empty())
          EXPECT_LE(rank(other), rank(room)) << file << " includes " << header;
      }
    }
  }
}

TEST(Source, RoomsAreSeenAtOneGlance) {
  std::map<std::string, int> sizes;
  for (const fs::path& file : sources_under("src"))
    ++sizes[fs::relative(file, kRoot).parent_path().string()];
  for (const auto& [room, files] : sizes) EXPECT_LE(files, 30) << room;
}

TEST(Source, OutsideIncludesOnlyPublicHeaders) {
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
